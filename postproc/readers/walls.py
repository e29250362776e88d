"""What readers of every code need about walls."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from postproc.snapshot import Columns


def box_from_walls(
    walls: Columns | None, dimension: int, periodic: Sequence[float] | None = None
) -> np.ndarray | None:
    """Return the box (dim, 2) that axis-aligned walls and periodic axes enclose, None when a side is open.

    A wall bounds axis a from below when its normal (towards the particles) is +e_a, from above when
    it is -e_a, exactly. Several walls on one side: the innermost bounds. A wall of any other
    orientation bounds nothing, nor does a ring. periodic: the length of each axis in m, 0 for one that is not
    periodic; a periodic axis spans 0 to its length.
    """
    lengths = np.zeros(dimension) if periodic is None else np.asarray(periodic, dtype=float)
    axes = "xyz"[:dimension]
    points, normals = np.empty((2, 0, dimension))
    if walls is not None and "nx" in walls:
        points, normals = (walls.vector(*(letter + a for a in axes)) for letter in "pn")
    unit = np.eye(dimension)
    box = np.empty((dimension, 2))
    for a in range(dimension):
        lower = points[(normals == unit[a]).all(axis=1), a]
        upper = points[(normals == -unit[a]).all(axis=1), a]
        if lengths[a] > 0:
            box[a] = 0.0, lengths[a]
        elif lower.size and upper.size:
            box[a] = lower.max(), upper.min()
        else:
            return None
    return box
