"""The pairs that may touch, and the buffers in which one step evaluates them.

Particle pairs come first, sorted by (i, j); then the pairs with walls, wall by wall, so that what only concerns one
wall is a slice. History follows the pairs through a renewal by their keys.
"""

from __future__ import annotations

import numpy as np

from reference.kernel.model import Model
from reference.kernel.neighbours import pairs_within, wall_pairs_within
from reference.kernel.state import State


class Contacts:
    """P pairs (i, j) of nodes with a gap below the skin when they were found.

    overlap, f_n, distance, a, b: (P,) buffers of a step; a and b are free for work at the start of a law.
    history: (rows, P) arrays by family of laws, 0 where nothing touches. wall_slices: wall number -> slice of its
    pairs, rough walls first; smooth_pairs: those of walls without friction. What has a direction is the dimension's
    own (`plane.contacts`, `space.contacts`).
    """

    def __init__(self, model: Model, x: np.ndarray, state: State, skin: float, history: dict[str, int]):
        """x: (dim, n) places of the nodes; `state` gives radii and wall normals, which stay."""
        self.i, self.j, self.wall_slices = _pairs(model, x, state.wall_normal, skin)
        self.count = p = len(self.i)
        self.radius_i, self.radius_j = state.radius[self.i], state.radius[self.j]
        self.radius_sum = self.radius_i + self.radius_j
        self.particle_pairs = slice(0, min([s.start for s in self.wall_slices.values()], default=p))
        self.smooth_pairs = _smooth(model, self.wall_slices, p)
        self.overlap, self.f_n, self.distance, self.a, self.b = (np.empty(p) for _ in range(5))
        self.touches = np.empty(p, bool)
        self.history = {family: np.zeros((rows, p)) for family, rows in history.items()}

    def keys(self, nodes: int) -> np.ndarray:
        """One number a pair, (P,)."""
        return self.i * nodes + self.j

    def inherit(self, old: Contacts, nodes: int) -> None:
        """Take the history of pairs that were listed before."""
        order = np.argsort(old.keys(nodes))
        known = old.keys(nodes)[order]
        if not len(known):
            return
        key = self.keys(nodes)
        place = np.minimum(np.searchsorted(known, key), len(known) - 1)
        same = known[place] == key
        for name, values in self.history.items():
            values[:, same] = old.history[name][:, order[place[same]]]


def _pairs(model: Model, x: np.ndarray, wall_normal: np.ndarray, skin: float):
    i, j = pairs_within(model, x[:, : model.particle_count], skin)
    order = np.lexsort((j, i))
    all_i, all_j, slices, start = [i[order]], [j[order]], {}, len(i)
    for k in sorted(range(len(model.walls)), key=lambda k: not model.walls[k].friction):
        particle, wall = wall_pairs_within(model, x, wall_normal, (k,), skin)
        if len(particle):
            order = np.argsort(particle)
            all_i.append(particle[order])
            all_j.append(wall[order])
            slices[k] = slice(start, start + len(particle))
            start += len(particle)
    return np.concatenate(all_i).astype(np.intp), np.concatenate(all_j).astype(np.intp), slices


def _smooth(model: Model, slices: dict[int, slice], count: int) -> slice:
    return slice(min((s.start for k, s in slices.items() if not model.walls[k].friction), default=count), count)
