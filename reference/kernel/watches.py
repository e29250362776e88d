"""What looks at a run from time to time, and stops it with the reason: those that the model needs.

A watch has `next_look` (a step, None after the last), `look(simulation)`, which raises `KernelUnstable`, `warning()`
for the end of the run, and `kept()` and `take()` to go on in another process. To look changes nothing.
"""

from __future__ import annotations

import numpy as np

from reference.kernel.energy_watch import EnergyWatch, is_closed
from reference.kernel.late_springs import LateSprings, late_families
from reference.kernel.model import Model
from reference.kernel.simulation import Simulation

WATCHES = ((late_families, LateSprings), (is_closed, EnergyWatch))
"""Whether a model needs a watch, and the watch."""


class Watches:
    """All watches of a run."""

    def __init__(self, model: Model, steps: int):
        """steps: of the run."""
        self._all = [watch(model, steps) for needs, watch in WATCHES if needs(model)]

    @property
    def next_look(self) -> int | None:
        """The first step at which one of them looks; None when no one looks any more."""
        return min((w.next_look for w in self._all if w.next_look is not None), default=None)

    def look(self, simulation: Simulation) -> None:
        """Let those look whose step it is. Raises KernelUnstable."""
        now = self.next_look
        for watch in self._all:
            if watch.next_look == now:
                watch.look(simulation)

    def warning(self) -> str | None:
        """Return what a run that went to its end has to say, in one line; None if that is nothing."""
        return "; ".join(said for w in self._all if (said := w.warning()) is not None) or None

    def kept(self) -> dict[str, np.ndarray]:
        """Return what the coming looks depend on, as arrays by name, for `take`."""
        return {name: kept for w in self._all for name, kept in w.kept().items()}

    def take(self, kept: dict[str, np.ndarray]) -> None:
        """Go on from what `kept` returned."""
        for watch in self._all:
            watch.take(kept)
