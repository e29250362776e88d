"""Which pairs can touch: a Verlet list with skin, rebuilt before any contact could be missed.

The list holds every pair whose gap was below the skin when it was built. It is checked in every
step, after positions moved and before forces are computed: as soon as two objects could have closed
a gap of one skin, it is rebuilt, so no contact is ever missed, whatever the speed. The
springs of contacts are carried over by the pair's key.
"""

from __future__ import annotations

import numpy as np

from reference.kernel.model import Model
from reference.kernel.vectors import dot


class CandidateList:
    """Pairs (i, j) of nodes that may touch, sorted by key, with one spring (dim, P) each if wanted."""

    def __init__(self, dimension: int, nodes: int, *, with_spring: bool):
        self.nodes = nodes
        self.i = np.empty(0, np.intp)
        self.j = np.empty(0, np.intp)
        self.spring = np.zeros((dimension, 0)) if with_spring else None

    def replace(self, i: np.ndarray, j: np.ndarray) -> None:
        """Take new pairs; springs follow the pairs that stay."""
        order = np.argsort(i * self.nodes + j)
        old_key, old_spring = self.i * self.nodes + self.j, self.spring
        self.i, self.j = i[order].astype(np.intp), j[order].astype(np.intp)
        if old_spring is not None:
            self.spring = _carried(old_key, old_spring, self.i * self.nodes + self.j)


def pairs_within(model: Model, x: np.ndarray, skin: float) -> tuple[np.ndarray, np.ndarray]:
    """Return i < j of all particle pairs with gap < skin, by a k-d tree, O(N log N).

    Periodic axes use scipy's `boxsize`; positions are wrapped into the box for the search only.
    """
    from scipy.spatial import cKDTree

    points, box = x.T, None
    if model.periodic is not None:
        box = np.array(model.periodic)
        points = _wrapped(points, box)
    reach = 2.0 * model.radius.max() + skin
    pairs = cKDTree(points, boxsize=box).query_pairs(reach, output_type="ndarray")
    i, j = pairs.min(axis=1), pairs.max(axis=1)
    branch = branch_vectors(model, x, i, j)
    near = np.sqrt(dot(branch, branch)) < model.radius[i] + model.radius[j] + skin
    return i[near], j[near]


def _wrapped(points: np.ndarray, box: np.ndarray) -> np.ndarray:
    """Positions (N, dim) brought into [0, box) on periodic axes; mod alone may round up to the box itself."""
    inside = np.mod(points, np.where(box > 0, box, 1.0))
    return np.where(box > 0, np.where(inside < box, inside, 0.0), points)


def branch_vectors(model: Model, x: np.ndarray, i: np.ndarray, j: np.ndarray) -> np.ndarray:
    """Return x_i - x_j, nearest image on periodic axes, shape (dim, P)."""
    branch = x.take(i, axis=1) - x.take(j, axis=1)
    if model.periodic is not None:
        for axis, length in enumerate(model.periodic):
            if length > 0:
                branch[axis] -= length * np.round(branch[axis] / length)
    return branch


def wall_pairs_within(
    model: Model, x: np.ndarray, normal: np.ndarray, walls: tuple[int, ...], skin: float
) -> tuple[np.ndarray, np.ndarray]:
    """Return particle numbers and wall nodes (N + k) with gap < skin, for the walls k in `walls`.

    x: (dim, N+W) node positions; normal: (dim, W).
    """
    count = model.particle_count
    chosen = np.array(walls)
    n = normal[:, chosen]
    height = sum(n[axis][:, None] * (x[axis, :count] - x[axis, count + chosen][:, None]) for axis in range(len(x)))
    wall, particle = np.nonzero(height - model.radius < skin)
    return particle, chosen[wall] + count


def _carried(old_key: np.ndarray, old_spring: np.ndarray, key: np.ndarray) -> np.ndarray:
    """Springs of `key`, taken from `old_key` where the pair was listed before, else zero."""
    spring = np.zeros((len(old_spring), len(key)))
    if len(old_key):
        place = np.minimum(np.searchsorted(old_key, key), len(old_key) - 1)
        known = old_key[place] == key
        spring[:, known] = old_spring[:, place[known]]
    return spring
