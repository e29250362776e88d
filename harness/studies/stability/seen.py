"""What a run shows: its frames as arrays, who overlaps whom, and the energy that contacts hold.

Nothing here asks an engine or the kernel: overlaps come from places and radii, energies from overlaps and the laws'
potentials, so that a code that computes a force wrongly cannot also judge it.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Protocol

import numpy as np

from harness.scene.contact import (
    DmtNormal,
    HertzNormal,
    HystereticNormal,
    LinearNormal,
    NormalLaw,
    VariableHystereticNormal,
)
from harness.scene.materials import by_law, stiffness_of_contacts
from harness.scene.system import Constant, Cosine, Loaded, System
from postproc.snapshot import Snapshot
from postproc.trajectory import Trajectory

Potential = Callable[[NormalLaw, np.ndarray, np.ndarray], np.ndarray]
"""Energy of contacts (C,), J, from a law, overlaps > 0 (C,), m, and reduced radii (C,), m."""


class NotKnown(Exception):
    """A run does not show what an invariant asks for; the message says what is missing."""


@dataclass(frozen=True, kw_only=True)
class Touching:
    """Overlapping pairs of a frame: overlap > 0, the smaller radius and R* = a_i a_j/(a_i + a_j), all (C,), m.

    At a wall both are the particle's own radius. first, second: (C,) row numbers, second = -index of a wall or ring.
    """

    first: np.ndarray
    second: np.ndarray
    overlap: np.ndarray
    smaller: np.ndarray
    reduced: np.ndarray


@dataclass(frozen=True, kw_only=True, eq=False)
class Frame:
    """One frame as arrays: x, v (N, dim), spin (N, 1 or 3), radius, mass, inertia (N,), in SI units."""

    time: float
    step: int
    x: np.ndarray
    v: np.ndarray
    spin: np.ndarray
    radius: np.ndarray
    mass: np.ndarray
    inertia: np.ndarray
    snapshot: Snapshot

    @property
    def kinetic(self) -> float:
        """Translational and rotational energy, sum m v^2/2 + I omega^2/2, J."""
        moving, turning = self.mass @ (self.v**2), self.inertia @ (self.spin**2)
        return float(moving.sum() + turning.sum()) / 2


@dataclass(frozen=True, kw_only=True, eq=False)
class Seen:
    """A run of a system, as far as it is looked at."""

    system: System
    trajectory: Trajectory

    def up_to(self, time: float | None) -> Seen:
        """Return the run up to a time, s; all of it for None."""
        if time is None:
            return self
        t = self.trajectory
        kept = [k for k, frame in enumerate(t.frames) if frame.time <= time * (1 + 1e-9)]
        cut = replace(t, frames=tuple(t.frames[k] for k in kept), steps=tuple(t.steps[k] for k in kept))
        return replace(self, trajectory=cut)

    @cached_property
    def frames(self) -> tuple[Frame, ...]:
        """All frames."""
        pairs = zip(self.trajectory.frames, self.trajectory.steps, strict=True)
        return tuple(_frame(snapshot, step) for snapshot, step in pairs)

    @cached_property
    def touching(self) -> tuple[Touching, ...]:
        """Who overlaps whom in every frame."""
        return tuple(_touching(self.system, frame) for frame in self.frames)

    @cached_property
    def kinetic(self) -> np.ndarray:
        """Kinetic energy of particles and of walls with mass, (F,), J."""
        return np.array([f.kinetic for f in self.frames]) + self._of_walls(_kinetic_of_wall)

    @cached_property
    def elastic(self) -> np.ndarray:
        """Energy of the normal springs, (F,), J. Raises NotKnown for a law without potential."""
        potential = POTENTIALS.get(type(self.system.normal))
        if potential is None:
            raise NotKnown("the normal law has no potential")
        return self._held(potential)

    @cached_property
    def sheared(self) -> np.ndarray:
        """Energy of the tangential springs between particles, k_t u^2/2, (F,), J; zero without such a law.

        Raises NotKnown where frames have no contacts, or where walls rub, whose springs not every code tells.
        """
        if not hasattr(self.system.sliding, "shear_stiffness"):
            return np.zeros(len(self.frames))
        if not self.system.contacts or any(w.friction for w in self.system.walls):
            raise NotKnown("the tangential springs are not recorded")
        return np.array([sheared(self.system, f.snapshot) for f in self.frames])

    @cached_property
    def external(self) -> np.ndarray:
        """Potential of weights and of the loads on walls, (F,), J."""
        gravity = np.zeros(self.system.dimension) if self.system.gravity is None else np.array(self.system.gravity)
        weights = [-float((f.mass * (f.x @ gravity)).sum()) for f in self.frames]
        return np.array(weights) + self._of_walls(_load_of_wall)

    @property
    def at_start(self) -> float:
        """The most that the contacts of the first frame can give back, J: what they have on first loading."""
        law = self.system.normal
        return float(self._held(FIRST_LOADING.get(type(law)) or POTENTIALS[type(law)])[0])

    @cached_property
    def squared_forces(self) -> np.ndarray:
        """Sum F^2/m over particles of the linear springs among them, (F,), N^2/kg; raises NotKnown if more acts."""
        system = self.system
        if not isinstance(system.normal, LinearNormal) or system.walls or system.rings or system.gravity:
            raise NotKnown("other forces act than those of linear springs among particles")
        forces = [_spring_forces(system, f) for f in self.frames]
        found = [((force**2).sum(axis=1) / f.mass).sum() for force, f in zip(forces, self.frames, strict=True)]
        return np.array(found)

    def work(self) -> np.ndarray:
        """Work that driven walls have done by each frame, (F,), J: -sum of F.v dt by the trapezoidal rule."""
        driven = [w for w in self.system.walls if isinstance(w.motion, Constant | Cosine)]
        if not driven:
            return np.zeros(len(self.frames))
        series = self.series
        power = -sum(_power(series, wall, self.system.dimension) for wall in driven)
        steps = np.diff(series["time"])
        done = np.concatenate([[0.0], np.cumsum(steps * (power[1:] + power[:-1]) / 2)])
        return np.interp([f.time for f in self.frames], series["time"], done)

    @property
    def series(self):
        """The sampled wall columns. Raises NotKnown when there are none."""
        if self.trajectory.series is None:
            raise NotKnown("no series of walls was recorded")
        return self.trajectory.series

    def _held(self, potential: Potential) -> np.ndarray:
        return np.array([held(self.system, potential, t) for t in self.touching])

    def _of_walls(self, energy: Callable) -> np.ndarray:
        """Sum an energy over the walls with mass, (F,), from the samples at the frames' steps."""
        loaded = [w for w in self.system.walls if isinstance(w.motion, Loaded)]
        if not loaded:
            return np.zeros(len(self.frames))
        series = self.series
        rows = np.searchsorted(series["step"], [f.step for f in self.frames])
        return sum(energy(w.motion, series[f"{w.name}_d"][rows], series[f"{w.name}_v"][rows]) for w in loaded)


# --- energies of contacts ----------------------------------------------------------------------------


class Overlapping(Protocol):
    """Contacts as `Touching` has them."""

    first: np.ndarray
    second: np.ndarray
    overlap: np.ndarray
    reduced: np.ndarray


def held(system: System, potential: Potential, contacts: Overlapping) -> float:
    """Return the energy of contacts by a potential of their normal laws, J."""
    return sum(
        float(potential(pair.normal, contacts.overlap[which], contacts.reduced[which]).sum())
        for pair, which in by_law(system, contacts.first, contacts.second)
    )


def sheared(system: System, snapshot: Snapshot) -> float:
    """Return the energy of the recorded tangential springs, k_t u^2/2, J."""
    contacts = snapshot.contacts
    springs = contacts.vector(*(f"u{a}" for a in snapshot.axes))
    i, j = (contacts[name].astype(int) for name in "ij")
    pairs = by_law(system, i - 1, np.where(j > 0, j - 1, j))
    return sum(float(pair.sliding.shear_stiffness * (springs[which] ** 2).sum() / 2) for pair, which in pairs)


def _linear(law: LinearNormal, overlap: np.ndarray, reduced: np.ndarray) -> np.ndarray:  # noqa: ARG001
    return law.normal_stiffness * overlap**2 / 2


def _hertz(law: HertzNormal | DmtNormal, overlap: np.ndarray, reduced: np.ndarray) -> np.ndarray:
    modulus = law.youngs_modulus / (2 * (1 - law.poisson_ratio**2))
    return 8 / 15 * modulus * np.sqrt(reduced) * overlap**2.5


def _dmt(law: DmtNormal, overlap: np.ndarray, reduced: np.ndarray) -> np.ndarray:
    return _hertz(law, overlap, reduced) - 4 * math.pi * law.surface_energy * reduced * overlap


def _first_loading(law, overlap: np.ndarray, reduced: np.ndarray) -> np.ndarray:  # noqa: ARG001
    return law.loading_stiffness * overlap**2 / 2


POTENTIALS: dict[type, Potential] = {LinearNormal: _linear, HertzNormal: _hertz, DmtNormal: _dmt}
"""k d^2/2; 8/15 E* sqrt(R*) d^(5/2) (the integral of Hertz' force); the same less 4 pi w R* d."""

FIRST_LOADING: dict[type, Potential] = {
    HystereticNormal: _first_loading, VariableHystereticNormal: _first_loading,
}
"""Laws with memory have no potential; on first loading they hold k_1 d^2/2, of which they give back no more."""


def _kinetic_of_wall(motion: Loaded, d: np.ndarray, rate: np.ndarray) -> np.ndarray:  # noqa: ARG001
    return motion.mass * rate**2 / 2


def _load_of_wall(motion: Loaded, d: np.ndarray, rate: np.ndarray) -> np.ndarray:  # noqa: ARG001
    return -motion.load * d


def _power(series, wall, dimension: int) -> np.ndarray:
    """Power of the particles' force on a driven wall, F.v, (S,), W."""
    force = np.stack([series[f"{wall.name}_f{a}"] for a in "xyz"[:dimension]])
    if isinstance(wall.motion, Constant):
        return np.array(wall.motion.velocity) @ force
    return series[f"{wall.name}_v"] * (np.array(wall.normal) @ force)


# --- frames --------------------------------------------------------------------------------------------


def _frame(snapshot: Snapshot, step: int) -> Frame:
    p, axes = snapshot.particles, snapshot.axes
    spins = ("wz",) if snapshot.dimension == 2 else ("wx", "wy", "wz")
    return Frame(
        time=snapshot.time, step=step, x=p.vector(*axes), v=p.vector(*(f"v{a}" for a in axes)), spin=p.vector(*spins),
        radius=p["radius"], mass=p["mass"], inertia=p["inertia"], snapshot=snapshot,
    )


def _touching(system: System, frame: Frame) -> Touching:
    found = [_among_particles(system, frame), *_at_walls(frame), *_at_rings(system, frame)]
    first, second, overlap, smaller, reduced = (np.concatenate(columns) for columns in zip(*found, strict=True))
    return Touching(first=first, second=second, overlap=overlap, smaller=smaller, reduced=reduced)


def _among_particles(system: System, frame: Frame):
    i, j = np.triu_indices(len(frame.x), 1)
    apart = nearest_image(frame.x[j] - frame.x[i], system.periodic)
    return _contacts(i, j, np.sqrt((apart**2).sum(axis=1)), frame.radius[i], frame.radius[j])


def _spring_forces(system: System, frame: Frame) -> np.ndarray:
    """Return k d n summed over the neighbours of every particle, (N, dim), N."""
    apart = nearest_image(frame.x[:, None] - frame.x[None], system.periodic)
    distance = np.sqrt((apart**2).sum(axis=2))
    np.fill_diagonal(distance, np.inf)
    overlap = np.maximum(frame.radius[:, None] + frame.radius[None] - distance, 0.0)
    i, j = (rows.ravel() for rows in np.indices(distance.shape))
    stiffness = stiffness_of_contacts(system, i, j).reshape(*distance.shape, 1)
    return (stiffness * (overlap / distance)[..., None] * apart).sum(axis=1)


def _at_walls(frame: Frame):
    walls = frame.snapshot.walls
    if walls is None or "nx" not in walls:
        return
    points, normals = (walls.vector(*(f"{q}{a}" for a in frame.snapshot.axes)) for q in "pn")
    for index, (point, normal) in enumerate(zip(points, normals, strict=True), start=1):
        if np.isfinite(normal).all():
            overlap = frame.radius - (frame.x - point) @ normal
            on = np.flatnonzero(overlap > 0)
            yield on, np.full_like(on, -index), overlap[on], frame.radius[on], frame.radius[on]


def _at_rings(system: System, frame: Frame):
    for ring in system.rings:
        angle = (ring.omega or 0.0) * frame.time
        turn = np.array([[math.cos(angle), -math.sin(angle)], [math.sin(angle), math.cos(angle)]])
        glued = np.array(ring.centre) + (ring.x - np.array(ring.centre)) @ turn.T
        distance = np.linalg.norm(frame.x[:, None] - glued[None], axis=2)
        radius = np.broadcast_arrays(frame.radius[:, None], ring.radius[None])
        first = np.indices(distance.shape)[0].ravel()
        second = np.full_like(first, -ring.index)
        yield _contacts(first, second, distance.ravel(), radius[0].ravel(), radius[1].ravel())


def _contacts(first: np.ndarray, second: np.ndarray, distance: np.ndarray, a: np.ndarray, b: np.ndarray):
    overlap = a + b - distance
    on = overlap > 0
    a, b = a[on], b[on]
    return first[on], second[on], overlap[on], np.minimum(a, b), a * b / (a + b)


def nearest_image(apart: np.ndarray, periodic: tuple[float, ...] | None) -> np.ndarray:
    """Return distances (.., dim) to the nearest image along periodic axes."""
    for axis, length in enumerate(periodic or ()):
        if length:
            apart = apart.copy()
            apart[..., axis] -= length * np.round(apart[..., axis] / length)
    return apart
