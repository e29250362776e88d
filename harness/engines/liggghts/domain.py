"""The domain: where LIGGGHTS keeps its atoms and mesh centres, which is not where the walls are.

Faces are fixed (`f`) or periodic (`p`). A particle that leaves through a fixed face is lost and the
run stops ("unstable"), so behind a wall, or a ring around all, there is little room, and on an open
side there is as much as the particles can need: their greatest speed, from the whole energy in one of
them, times the time.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from harness.engines.facts import is_periodic, rotates, walls_across
from harness.engines.glued import enclosing, glued
from harness.engines.glued import reach as reach_of_rings
from harness.engines.liggghts.planes import anchor, is_still, mesh_velocity, meshes, reach
from harness.scene.contact import HertzNormal, LinearNormal, NormalLaw
from harness.scene.system import INERTIA_FACTOR, Constant, Cosine, Loaded, System, Wall

ROOM_IN_RADII = 4.0
"""Distance of a face from the wall before it, in largest radii."""


@dataclass(frozen=True, kw_only=True)
class Domain:
    """bounds (3, 2) in m; styles: the words of `boundary`; discs: LIGGGHTS' own 2D mode, I = m r^2 / 2."""

    bounds: np.ndarray
    styles: str
    discs: bool


def domain_of(system: System) -> Domain:
    """Return the domain of a system.

    A 2D system runs in LIGGGHTS' 2D mode, unless its particles turn with the inertia of spheres:
    then it is a 3D one that stays at z = 0, exactly.
    """
    dimension = system.dimension
    bounds = np.array([_bounds(system, a) for a in range(dimension)])
    styles = ["p" if is_periodic(system, a) else "f" for a in range(dimension)]
    discs = runs_as_discs(system)
    if dimension == 2:
        room = ROOM_IN_RADII * float(system.particles.radius.max())
        half = 2.0 * reach(bounds, dimension) + room if discs else room
        bounds = np.vstack([bounds, [-half, half]])
        styles.append("p" if discs else "f")
    return Domain(bounds=bounds, styles=" ".join(styles), discs=discs)


def runs_as_discs(system: System) -> bool:
    """Does a system run in LIGGGHTS' own 2D mode?"""
    sphere = bool(np.all(system.particles.inertia_factor == INERTIA_FACTOR["sphere"]))
    return system.dimension == 2 and not (rotates(system) and sphere)


def _bounds(system: System, axis: int) -> tuple[float, float]:
    if is_periodic(system, axis):
        return 0.0, system.periodic[axis]
    p = system.particles
    room = ROOM_IN_RADII * float(p.radius.max())
    ends = [float((p.x[:, axis] - p.radius).min()), float((p.x[:, axis] + p.radius).max())]
    ends += [w.point[axis] for side in (1.0, -1.0) for w in walls_across(system, axis, side)]
    ends += reach_of_rings(system, axis)
    extent = max(ends) - min(ends)
    ends += [e for w in meshes(system) for e in _anchors(system, w, extent, axis)]
    low, high = min(ends) - room, max(ends) + room
    if enclosing(system) is not None:
        return low, high
    if not walls_across(system, axis, 1.0):
        low -= _flight(system, extent)
    if not walls_across(system, axis, -1.0):
        high += _flight(system, extent)
    return low, high


def _anchors(system: System, wall: Wall, extent: float, axis: int) -> list[float]:
    """Return where the centre of a mesh goes along an axis; a loaded wall gets the room it may need."""
    start, normal, time = anchor(system, wall)[axis], wall.normal[axis], system.steps * system.dt
    motion = wall.motion
    if isinstance(motion, Loaded):
        room = extent + _thrown(system, motion, extent)
        return [start - room * normal, start, start + room * normal]
    if isinstance(motion, Cosine):
        return [start, start + motion.travel * normal]
    if isinstance(motion, Constant) and not is_still(wall):
        return [start, start + mesh_velocity(system, wall)[axis] * time]
    return [start]


def _flight(system: System, extent: float) -> float:
    """Return how far a particle can fly: its own way, that of walls that push it, and free fall."""
    time = system.steps * system.dt
    gravity = 0.0 if system.gravity is None else math.hypot(*system.gravity)
    speed = math.sqrt(2.0 * _energy(system, extent) / float(system.particles.mass.min()))
    speed += 2.0 * sum(_wall_speed(w) for w in system.walls)
    speed += 2.0 * sum(abs(r.omega or 0.0) * (r.circle + float(r.radius.max())) for r in system.rings)
    return speed * time + 0.5 * gravity * time**2


def _thrown(system: System, motion: Loaded, extent: float) -> float:
    """Return how far a wall with mass can go with all energy in it, against its load if that holds it back."""
    time, energy = system.steps * system.dt, _energy(system, extent)
    load = motion.load + (motion.stress * extent if motion.span else 0.0)
    free = math.sqrt(2.0 * energy / motion.mass) * time + 0.5 * max(0.0, -load) / motion.mass * time**2
    return min(free, energy / load) if load > 0.0 else free


def _energy(system: System, extent: float) -> float:
    """Return the energy that could end in one body: motion, spin, overlaps, fall, work of loads, in J."""
    p = system.particles
    spin = float((p.inertia_factor * p.mass * p.radius**2 * (p.spin**2).sum(axis=1)).sum())
    kinetic = float((p.mass * (p.v**2).sum(axis=1)).sum())
    loads = sum(abs(w.motion.load) for w in system.walls if isinstance(w.motion, Loaded))
    fall = 0.0 if system.gravity is None else math.hypot(*system.gravity) * float(p.mass.sum()) * extent
    return 0.5 * (kinetic + spin) + _overlap_energy(system) + fall + loads * extent


def _overlap_energy(system: System) -> float:
    """Return the energy of all overlaps, between particles and with walls, in J."""
    from scipy.spatial import cKDTree

    p = system.particles
    i, j = cKDTree(p.x).query_pairs(2.0 * p.radius.max(), output_type="ndarray").T
    overlaps = [p.radius[i] + p.radius[j] - np.linalg.norm(p.x[i] - p.x[j], axis=1)]
    overlaps += [p.radius - (p.x - w.point) @ np.array(w.normal) for w in system.walls]
    if system.rings:
        discs = glued(system)
        overlaps.append(p.radius[:, None] + discs.radius - np.linalg.norm(p.x[:, None] - discs.x, axis=2))
    return sum(
        max(_stored(pair.normal, o.clip(min=0.0), float(p.radius.max())) for pair in system.of_pairs) for o in overlaps
    )


def _stored(normal: NormalLaw, overlap: np.ndarray, radius: float) -> float:
    """Return the energy of overlaps (M,), or more: of virgin loading, Hertz contacts all with the largest R*, in J."""
    if isinstance(normal, HertzNormal):
        stiffness = normal.youngs_modulus / (2.0 * (1.0 - normal.poisson_ratio**2)) * math.sqrt(radius)
        return 8.0 / 15.0 * stiffness * float((overlap**2.5).sum())
    stiffness = normal.normal_stiffness if isinstance(normal, LinearNormal) else normal.loading_stiffness
    return 0.5 * stiffness * float((overlap**2).sum())


def _wall_speed(wall: Wall) -> float:
    if isinstance(wall.motion, Constant):
        return math.hypot(*wall.motion.velocity)
    if isinstance(wall.motion, Cosine):
        return abs(wall.motion.travel) * math.pi / (2.0 * wall.motion.duration)
    return 0.0
