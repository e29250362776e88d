"""The kernel as a timing session's child: ``python -m harness.engines.kernel.bench_child program|textbook CORE``."""

from __future__ import annotations

import gc
import json
import sys
import tracemalloc
from pathlib import Path

import numpy as np

from harness.engines.kernel.bench import SKIN
from harness.engines.rounds import core_of, serve
from reference.kernel.deck import read_deck
from reference.kernel.program.simulation import CHECK_EVERY, ProgramSimulation
from reference.kernel.simulation import Simulation

EVALUATIONS = {"program": ProgramSimulation, "textbook": Simulation}


class RunningKernel:
    """The deck in the current folder, built."""

    def __init__(self, evaluation: str):
        self.make = EVALUATIONS[evaluation]
        self.skin = json.loads(Path(SKIN).read_text())
        self.model, _ = read_deck(Path("."))
        self.simulation = self.make(self.model, skin=self.skin)

    def advance(self, steps: int) -> None:
        """Make steps."""
        self.simulation.advance(steps)

    def places(self) -> np.ndarray:
        """Return the positions, (N, dim)."""
        return self.simulation.state.x[:, : self.model.particle_count].T.copy()

    def facts(self) -> dict[str, int]:
        """Return the rebuilds so far, and what a second simulation of this deck allocates, its model included.

        By tracemalloc; held: after its first steps. peak: the most until then, with the set-up. What SciPy's search
        tree takes while pairs are looked for is not NumPy's and not counted.
        """
        rebuilds = self.simulation.rebuilds
        gc.collect()
        tracemalloc.start()
        try:
            model, _ = read_deck(Path("."))
            gc.collect()
            tracemalloc.reset_peak()  # reading text takes more than the run, but only once
            simulation = self.make(model, skin=self.skin)
            simulation.advance(CHECK_EVERY)
            held, peak = tracemalloc.get_traced_memory()
        finally:
            tracemalloc.stop()
        del simulation
        return {"rebuilds": rebuilds, "held": held, "peak": peak}


if __name__ == "__main__":
    sys.exit(serve(lambda: RunningKernel(sys.argv[1]), core_of(sys.argv)))
