"""A block of the pairs that may touch, and the buffers in which one step evaluates them."""

from __future__ import annotations

from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from reference.kernel.model import Model
from reference.kernel.program.buffers import Workspace, lined_up
from reference.kernel.program.components import Components
from reference.kernel.state import State

if TYPE_CHECKING:
    from reference.kernel.program.pairs import PairList
    from reference.kernel.program.plane.vectors import PlaneVectors


class Contacts:
    """P pairs (i, j) of nodes: views of a part of the list, and buffers that all blocks share.

    ends: (2, P), the nodes j and the nodes i; radius: (2, P), theirs. history: (rows, P) by family of laws, 0 where
    nothing touches. wall_slices: wall number -> slice of its pairs; smooth_pairs: those of walls without friction.
    overlap, f_n, a, b: (P,) of a step; overlap is 0 where nothing touches, a and b are free for work within a few
    operations. force: the force on i; couple: minus the couple on i, None without rolling and torsion. What has a
    direction is the dimension's own (`plane.contacts`, `space.contacts`).

    Made when the program is composed, by what writes them first: touching (P,), 1 where a pair touches, else 0
    (numbers are multiplied faster than truth values); base (P,) of all limits; v_t, slip velocity, and rolling =
    a* (omega_i - omega_j), both 0 where nothing touches and at smooth walls; shear: minus the tangential force on i.
    """

    normal: np.ndarray
    v_n: np.ndarray
    tangents: Components
    touching: np.ndarray
    base: np.ndarray
    v_t: np.ndarray
    mean_v_t: np.ndarray | None = None
    """Mean of v_t over the step, in schemes that know it."""
    rolling: np.ndarray
    shear: np.ndarray
    pull: np.ndarray | None = None
    """Minus the force on i along the normal by springs that lag in 2D, (P,)."""
    lagging_vectors: PlaneVectors | None = None
    """What such springs have as components; None in 3D, where all springs are vectors."""

    def __init__(
        self, model: Model, state: State, pairs: PairList, part: slice, i: np.ndarray, j: np.ndarray,
        workspace: Workspace,
    ):
        self.count = len(i)
        self.ends = np.stack([j, i])
        self.j, self.i = self.ends
        self.wall_slices = {k: _within(s, part) for k, s in pairs.wall_slices.items() if _overlap(s, part)}
        self.particle_pairs = slice(0, min([s.start for s in self.wall_slices.values()], default=self.count))
        self.smooth_pairs = _smooth(model, self.wall_slices, self.count)
        self.radius = lined_up(state.radius[self.ends])
        self.radius_sum = lined_up(self.radius[1] + self.radius[0])
        self.history = {family: kept[:, part] for family, kept in pairs.history.items()}
        self.force = pairs.force[..., part]
        self.couple = None if pairs.couple is None else pairs.couple[..., part]
        self.workspace = workspace
        self.overlap, self.f_n, self.a, self.b = (self.buffer(name) for name in ("overlap", "f_n", "a", "b"))
        self._mass = model.mass

    @staticmethod
    def new_forces(count: int) -> np.ndarray:
        """Return an array for the forces on i of that many pairs."""
        raise NotImplementedError

    @staticmethod
    def new_couples(count: int) -> np.ndarray:
        """Return an array for the couples on i of that many pairs."""
        raise NotImplementedError

    @staticmethod
    def vectors(force: np.ndarray) -> np.ndarray:
        """Return such forces as (dim, M)."""
        raise NotImplementedError

    def buffer(self, name: str, *rows: int, dtype: type = float) -> np.ndarray:
        """Return the buffer of that name, (*rows, P)."""
        return self.workspace.rows(name, *rows, self.count, dtype=dtype)

    def ends_buffer(self, name: str, dtype: type = float) -> np.ndarray:
        """Return the buffer of that name for a number at each of `ends`, (2, P) without a gap."""
        return self.workspace.ends(name, self.count, dtype=dtype)

    @cached_property
    def reduced_radius(self) -> np.ndarray:
        """a* = a_i a_j/(a_i + a_j), a_i at a wall, (P,)."""
        return self._reduced(self.radius[1], self.radius[0])

    @cached_property
    def reduced_mass(self) -> np.ndarray:
        """m*, likewise, and m_i at a glued disc, (P,)."""
        of_i, heavy = self._mass[self.i], self.j >= len(self._mass)
        reduced = self._reduced(of_i, self._mass[np.where(heavy, 0, self.j)])
        reduced[heavy] = of_i[heavy]
        return reduced

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

    def wall_parts(self, model: Model) -> list[tuple[tuple[float, ...], slice]]:
        """Return the pairs of walls with the walls' normals; walls across the same axis come as one if they can."""
        parts: list[tuple[tuple[float, ...], slice]] = []
        for k, pairs in self.wall_slices.items():
            normal = model.walls[k].normal
            if parts and axis_across(normal) == axis_across(parts[-1][0]) < model.dimension:
                normal, pairs = parts[-1][0], slice(parts.pop()[1].start, pairs.stop)
            parts.append((normal, pairs))
        return parts


def axis_across(normal: tuple[float, ...]) -> int:
    """Return the number of the axis that a normal is along, the number of axes if it is along none."""
    along = [axis for axis, component in enumerate(normal) if component != 0.0]
    return along[0] if len(along) == 1 else len(normal)


def _overlap(a: slice, b: slice) -> bool:
    return a.start < b.stop and b.start < a.stop


def _within(pairs: slice, part: slice) -> slice:
    """The common part of both, counted from the begin of `part`."""
    return slice(max(pairs.start, part.start) - part.start, min(pairs.stop, part.stop) - part.start)


def _smooth(model: Model, slices: dict[int, slice], count: int) -> slice:
    return slice(min((s.start for k, s in slices.items() if not model.walls[k].friction), default=count), count)
