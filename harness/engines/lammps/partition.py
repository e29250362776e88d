"""What a deck for several MPI processes says besides: how the box is cut, once, at the start.

The rest of what they need is in every deck: `newton off`, no sorting, and a pair's history kept by each of the two
processes that have one of its particles.
"""

from __future__ import annotations

import numpy as np

from harness.engines.lammps.box import Box
from harness.engines.ranks import cuts, grid, processor_lines
from harness.engines.text import number
from harness.scene.system import System

__all__ = ["balance_lines", "processor_lines"]


def balance_lines(system: System, box: Box, ranks: int) -> list[str]:
    """Return the cuts as fractions of the box, which reaches far beyond the grains where a side is open.

    Cuts that would coincide, as those of grains in one line, are left where even bricks have them.
    """
    axes = [_axis(system, box, axis, count) for axis, count in enumerate(grid(system, ranks)) if count > 1]
    words = [word for axis in axes for word in axis]
    return [f"balance 1.0 {' '.join(words)}"] if words else []


def _axis(system: System, box: Box, axis: int, count: int) -> list[str]:
    low, high = box.axes[axis].low, box.axes[axis].high
    fractions = (cuts(system, axis, count) - low) / (high - low)
    if not np.all(np.diff([0.0, *fractions, 1.0]) > 0.0):
        return []
    return ["xyz"[axis], *(number(f) for f in fractions)]
