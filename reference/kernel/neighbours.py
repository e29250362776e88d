"""Which pairs can touch: a Verlet list with skin, rebuilt before any contact could be missed.

The list holds every pair whose gap was below the skin when it was built. It is checked in every
step, after positions moved and before forces are computed: as soon as two objects could have closed
a gap of one skin, it is rebuilt, so no contact is ever missed, whatever the speed. The
memory of contacts is carried over by the pair's key.
"""

from __future__ import annotations

import numpy as np

from reference.kernel.model import Model
from reference.kernel.vectors import dot


class CandidateList:
    """Pairs (i, j) of nodes that may touch, sorted by key.

    memory: one array (rows, P) for every law with history, by its family; zero where nothing is remembered.
    """

    def __init__(self, nodes: int, rows: dict[str, int], precision: np.dtype | type = float):
        self.nodes = nodes
        self.i = np.empty(0, np.intp)
        self.j = np.empty(0, np.intp)
        self.memory = {family: np.zeros((count, 0), precision) for family, count in rows.items() if count}

    def replace(self, i: np.ndarray, j: np.ndarray) -> None:
        """Take new pairs; memory follows the pairs that stay."""
        order = np.argsort(i * self.nodes + j)
        old_key = self.i * self.nodes + self.j
        self.i, self.j = i[order].astype(np.intp), j[order].astype(np.intp)
        key = self.i * self.nodes + self.j
        self.memory = {family: _carried(old_key, old, key) for family, old in self.memory.items()}

    def recall(self, touching: np.ndarray) -> dict[str, np.ndarray]:
        """Return what the touching pairs remember, (rows, M) by family."""
        return {family: kept.take(touching, axis=1) for family, kept in self.memory.items()}

    def remember(self, touching: np.ndarray, memory: dict[str, np.ndarray]) -> None:
        """Keep the memory of the touching pairs, (rows, M) by family; all others forget."""
        for family, kept in self.memory.items():
            kept[:] = 0.0
            kept[:, touching] = memory[family]


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
    tree = cKDTree(points, boxsize=box, balanced_tree=False, compact_nodes=False)  # made fast: it is asked once
    found = tree.query_pairs(reach, output_type="ndarray")
    parts = [_nearer(model, x, *found[k : k + PART].T, skin) for k in range(0, max(len(found), 1), PART)]
    i, j = (np.concatenate(ends) for ends in zip(*parts, strict=True))
    return i, j


PART = 1 << 15
"""Pairs whose gap is computed at a time: many more are found than are near, if radii differ."""


def _nearer(model: Model, x: np.ndarray, i: np.ndarray, j: np.ndarray, skin: float) -> tuple[np.ndarray, np.ndarray]:
    """Return those of the pairs that have a gap below the skin."""
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


def ring_pairs_within(model: Model, x: np.ndarray, radius: np.ndarray, skin: float) -> tuple[np.ndarray, np.ndarray]:
    """Return particle numbers and nodes of glued discs with gap < skin.

    x: (2, n) and radius: (n,) of all nodes.
    """
    from scipy.spatial import cKDTree

    count, first = model.particle_count, model.wall_nodes.stop
    reach = radius[:count].max() + radius[first:].max() + skin
    particles, glued = (cKDTree(places.T) for places in (x[:, :count], x[:, first:]))
    found = particles.sparse_distance_matrix(glued, reach, output_type="ndarray")
    i, j = found["i"], found["j"] + first
    near = found["v"] < radius[i] + radius[j] + skin
    return i[near], j[near]


def _carried(old_key: np.ndarray, old: np.ndarray, key: np.ndarray) -> np.ndarray:
    """Memory of `key`, taken from `old_key` where the pair was listed before, else zero."""
    memory = np.zeros((len(old), len(key)), old.dtype)
    if len(old_key):
        place = np.minimum(np.searchsorted(old_key, key), len(old_key) - 1)
        known = old_key[place] == key
        memory[:, known] = old[:, place[known]]
    return memory
