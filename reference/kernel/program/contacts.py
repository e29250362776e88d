"""The pairs that may touch, and the buffers in which one step evaluates them.

Particle pairs come first, sorted by (i, j); then the pairs with walls, wall by wall, so that what only concerns one
wall is a slice. History follows the pairs through a renewal by their keys.
"""

from __future__ import annotations

from functools import cached_property

import numpy as np

from reference.kernel.model import Model
from reference.kernel.neighbours import pairs_within, wall_pairs_within
from reference.kernel.program.buffers import empty, filled, lined_up
from reference.kernel.program.components import Components
from reference.kernel.state import State


class Contacts:
    """P pairs (i, j) of nodes with a gap below the skin when they were found.

    radius: (2, P) of i and of j. overlap, f_n, a, b: (P,) of a step; overlap is 0 where nothing touches, a and b are
    free for work within a few operations. history: (rows, P) arrays by family of laws, 0 where nothing touches.
    wall_slices: wall number -> slice of its pairs, rough walls first; smooth_pairs: those of walls without friction.
    What has a direction is the dimension's own (`plane.contacts`, `space.contacts`).

    Made when the program is composed, by what writes them first: touching (P,), 1 where a pair touches, else 0
    (numbers are multiplied faster than truth values); base (P,) of all limits; spins of i and of j; v_t, slip velocity,
    and rolling = a* (omega_i - omega_j), both 0 where nothing touches and at smooth walls; shear and couple: minus the
    tangential force and minus the couple on i.
    """

    normal: np.ndarray
    v_n: np.ndarray
    tangents: Components
    touching: np.ndarray
    base: np.ndarray
    spins: np.ndarray
    v_t: np.ndarray
    mean_v_t: np.ndarray | None = None
    """Mean of v_t over the step, in schemes that know it."""
    rolling: np.ndarray
    shear: np.ndarray
    couple: np.ndarray

    def __init__(self, model: Model, x: np.ndarray, state: State, skin: float, history: dict[str, int]):
        """x: (dim, n) places of the nodes; `state` gives radii and wall normals, which stay."""
        self.i, self.j, self.wall_slices = _pairs(model, x, state.wall_normal, skin)
        self.count = p = len(self.i)
        self.particle_pairs = slice(0, min([s.start for s in self.wall_slices.values()], default=p))
        self.smooth_pairs = _smooth(model, self.wall_slices, p)
        self.radius = lined_up(np.stack([state.radius[self.i], state.radius[self.j]]))
        self.radius_sum = lined_up(self.radius[0] + self.radius[1])
        self.overlap, self.f_n, self.a, self.b = (empty(p) for _ in range(4))
        self.history = {family: filled(0.0, rows, p) for family, rows in history.items()}
        self._mass = model.mass
        self._buffers: dict[str, np.ndarray] = {}

    def buffer(self, name: str) -> np.ndarray:
        """Return the (P,) buffer of that name, made when first asked for."""
        if name not in self._buffers:
            self._buffers[name] = empty(self.count)
        return self._buffers[name]

    @cached_property
    def reduced_radius(self) -> np.ndarray:
        """a* = a_i a_j/(a_i + a_j), a_i at a wall, (P,)."""
        return self._reduced(*self.radius)

    @cached_property
    def reduced_mass(self) -> np.ndarray:
        """m*, likewise, (P,)."""
        wall = self.j >= len(self._mass)
        return self._reduced(self._mass[self.i], np.where(wall, 0.0, self._mass[np.where(wall, 0, self.j)]))

    @property
    def rough(self) -> np.ndarray:
        """1, and 0 at walls without friction, (P,)."""
        rough = np.ones(self.count)
        rough[self.smooth_pairs] = 0.0
        return rough

    def _reduced(self, of_i: np.ndarray, of_j: np.ndarray) -> np.ndarray:
        walls = slice(self.particle_pairs.stop, None)
        reduced = lined_up(of_i)
        reduced[self.particle_pairs] = (of_i * of_j / (of_i + of_j))[self.particle_pairs]
        reduced[walls] = of_i[walls]
        return reduced

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

    # --- the dimension's own ---------------------------------------------------------------------

    def force_on_i(self, rows: np.ndarray) -> np.ndarray:
        """Return the force on i in the last step, (dim, M)."""
        raise NotImplementedError

    def spring(self, rows: np.ndarray, tension: np.ndarray) -> np.ndarray:
        """Return vectors in the tangent plane, (dim, M), of amounts with the components of `tangents`."""
        raise NotImplementedError

    def tension(self, rows: np.ndarray, spring: np.ndarray) -> np.ndarray:
        """Return the amounts of vectors in the tangent plane, (dim, M): the inverse of `spring`."""
        raise NotImplementedError


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
