"""What readers of every code need about flat walls."""

from __future__ import annotations

import numpy as np

from postproc.snapshot import Columns


def box_from_walls(walls: Columns | None, dimension: int) -> np.ndarray | None:
    """Return the box (dim, 2) that axis-aligned walls enclose, or None when a side is open.

    A wall bounds axis a from below when its normal (towards the particles) is +e_a, from above when
    it is -e_a, exactly. Several walls on one side: the innermost bounds. A wall of any other
    orientation bounds nothing.
    """
    if walls is None or not walls.rows:
        return None
    axes = "xyz"[:dimension]
    points = walls.vector(*(f"p{a}" for a in axes))
    normals = walls.vector(*(f"n{a}" for a in axes))
    unit = np.eye(dimension)
    box = np.empty((dimension, 2))
    for a in range(dimension):
        lower = points[(normals == unit[a]).all(axis=1), a]
        upper = points[(normals == -unit[a]).all(axis=1), a]
        if not (lower.size and upper.size):
            return None
        box[a] = lower.max(), upper.min()
    return box
