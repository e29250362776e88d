"""The list of pairs that may touch, what they remember, and the blocks in which a step evaluates them.

Pairs of particles, with each other and with glued discs, come first, sorted by (i, j); then the pairs with walls, wall
by wall, so that what only concerns one wall is a slice. History follows the pairs through a renewal of the list by
their keys.

A step evaluates one block of pairs after the other in the same buffers, which stay in the cache. Sums to the nodes do
not depend on where blocks end: every node is first a j, then an i, in the order of the list.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from reference.kernel.model import Model, Wall
from reference.kernel.neighbours import branch_vectors, pairs_within, ring_pairs_within, wall_pairs_within
from reference.kernel.program.buffers import LINE, Workspace, filled
from reference.kernel.program.contacts import Contacts, axis_across
from reference.kernel.state import State
from reference.kernel.vectors import norm

BLOCK = 8192
"""Pairs of a block, about: the twenty buffers or so of a step are then as large as a core's second cache."""


@dataclass(frozen=True, kw_only=True)
class Remembered:
    """What pairs remember, by key: keys (P,) ascending, history (rows, P) by family; empty without history."""

    keys: np.ndarray
    history: dict[str, np.ndarray]


class PairList:
    """P pairs (i, j) of nodes with a gap below the skin when they were found, in `blocks`.

    history: (rows, P) arrays by family of laws, 0 where nothing touches. force, couple: on i in the last step, as the
    dimension has them (the couple with the opposite sign; None without rolling and torsion). wall_slices: wall number
    -> slice of its pairs, rough walls first; at_walls: i, j of them all.
    """

    def __init__(
        self, model: Model, x: np.ndarray, state: State, skin: float, *,
        history: dict[str, int], kind: type[Contacts], block: int | None = BLOCK,
    ):
        """x: (dim, n) places of the nodes; `state` gives radii and wall normals. block None: all pairs in one."""
        i, j, self.wall_slices = _find(model, x, state, skin)
        self.count = len(i)
        first = min((s.start for s in self.wall_slices.values()), default=self.count)
        self.at_walls = i[first:].copy(), j[first:].copy()
        self.history = {family: filled(0.0, rows, self.count) for family, rows in history.items()}
        self.force = kind.new_forces(self.count)
        self.couple = kind.new_couples(self.count) if model.rolling or model.torsion else None
        parts = _parts(self.count, block or self.count)
        workspace = Workspace(max(part.stop - part.start for part in parts))
        self.blocks = [kind(model, state, self, part, i[part], j[part], workspace) for part in parts]

    @property
    def i(self) -> np.ndarray:
        """First partners, (P,)."""
        return np.concatenate([c.i for c in self.blocks])

    @property
    def j(self) -> np.ndarray:
        """Second partners, (P,)."""
        return np.concatenate([c.j for c in self.blocks])

    def keys(self, nodes: int) -> np.ndarray:
        """One number a pair, (P,)."""
        return self.i * nodes + self.j

    def remembered(self, nodes: int) -> Remembered:
        """Return what a new list needs of this one, which can then go: its arrays are as many as the new one's."""
        if not self.history:
            return Remembered(keys=np.empty(0, np.intp), history={})
        keys = self.keys(nodes)
        order = np.argsort(keys)
        return Remembered(keys=keys[order], history={name: kept[:, order] for name, kept in self.history.items()})

    def inherit(self, old: Remembered, nodes: int) -> None:
        """Take the history of pairs that were listed before."""
        if not len(old.keys):
            return
        key = self.keys(nodes)
        place = np.minimum(np.searchsorted(old.keys, key), len(old.keys) - 1)
        same = old.keys[place] == key
        for name, values in self.history.items():
            values[:, same] = old.history[name][:, place[same]]


def normals(model: Model, state: State, i: np.ndarray, j: np.ndarray) -> np.ndarray:
    """Return the unit normals from j to i of pairs at the places of a state, (dim, M)."""
    n = branch_vectors(model, state.x, i, j)
    n /= norm(n)
    wall = (j >= model.particle_count) & (j < model.wall_nodes.stop)
    n[:, wall] = state.wall_normal[:, j[wall] - model.particle_count]
    return n


def _parts(count: int, block: int) -> list[slice]:
    """Slices of the same length, about that of a block, that begin on cache lines."""
    number = max(round(count / max(block, 1)), 1)
    numbers_a_line = LINE // 8
    length = max(math.ceil(count / number / numbers_a_line) * numbers_a_line, 1)
    return [slice(start, min(start + length, count)) for start in range(0, max(count, 1), length)]


def _rough_first_then_by_axis(wall: Wall) -> tuple[bool, int]:
    return not wall.friction, axis_across(wall.normal)


def _find(model: Model, x: np.ndarray, state: State, skin: float):
    i, j = pairs_within(model, x[:, : model.particle_count], skin)
    if model.rings:
        i, j = np.hstack([(i, j), ring_pairs_within(model, x, state.radius, skin)])
    i, j = np.divmod(np.sort(i * x.shape[1] + j), x.shape[1])
    all_i, all_j, slices, start = [i], [j], {}, len(i)
    for k in sorted(range(len(model.walls)), key=lambda k: _rough_first_then_by_axis(model.walls[k])):
        particle, wall = wall_pairs_within(model, x, state.wall_normal, (k,), skin)
        if len(particle):
            order = np.argsort(particle)
            all_i.append(particle[order])
            all_j.append(wall[order])
            slices[k] = slice(start, start + len(particle))
            start += len(particle)
    return np.concatenate(all_i, dtype=np.intp), np.concatenate(all_j, dtype=np.intp), slices
