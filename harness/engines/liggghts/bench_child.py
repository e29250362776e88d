"""LIGGGHTS as the child of a timing session: ``python -m harness.engines.liggghts.bench_child CORE``.

This process must not load LAMMPS: both bring an MPI of their own.
"""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np

from harness.engines.liggghts.bench import DIMENSION
from harness.engines.liggghts.deck import INPUT
from harness.engines.liggghts.prescribed import Instance
from harness.engines.rounds import core_of, serve


class RunningLiggghts:
    """The deck in the current folder, built, its first forces computed."""

    def __init__(self):
        self.dimension = int(Path(DIMENSION).read_text())
        self.instance = Instance()
        self.instance.read(INPUT)
        self.instance.command("run 0 post no")

    def advance(self, steps: int) -> None:
        """Make steps without a set-up."""
        self.instance.command(f"run {steps} pre no post no")

    def places(self) -> np.ndarray:
        """Return the positions, (N, dim); periodic images as they are."""
        return self.instance.vectors("x")[np.argsort(self.instance.ids()), : self.dimension].copy()

    def facts(self) -> dict[str, int]:
        """LIGGGHTS says nothing."""
        return {}


if __name__ == "__main__":
    sys.exit(serve(RunningLiggghts, core_of(sys.argv)))
