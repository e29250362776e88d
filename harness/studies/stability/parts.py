"""What invariants are made of: sizes, parts of momenta, what is lost, closed forms of a meeting."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

from harness.scene.contact import HertzNormal, HystereticNormal, LinearNormal
from harness.scene.expect import Twin
from harness.scene.materials import by_law
from harness.studies.stability.seen import Frame, NotKnown, Seen, nearest_image
from reference.analytic.hysteretic_collision import ConstantUnloading
from reference.analytic.linear_collision import LinearCollision


def most(sizes: Iterable[float]) -> float:
    """Return the largest of sizes, 0 of none; NaN if any is NaN, which `max` may overlook."""
    return float(np.max([0.0, *sizes]))


def largest(values: np.ndarray, scale: np.ndarray) -> float:
    """Return max |values| over max |scale|; NaN where there is no scale and something to measure."""
    size, unit = float(np.abs(values).max()), float(np.abs(scale).max())
    if unit > 0 or np.isnan(unit):
        return size / unit
    return 0.0 if size == 0 else float("nan")


def behind_walls(frame: Frame) -> np.ndarray:
    """Return which centres are not in front of every plane, (N,)."""
    lost = np.zeros(len(frame.x), bool)
    walls, axes = frame.snapshot.walls, frame.snapshot.axes
    if walls is None or "nx" not in walls:
        return lost
    for point, normal in zip(*(walls.vector(*(f"{q}{a}" for a in axes)) for q in "pn"), strict=True):
        if np.isfinite(normal).all():
            lost |= (frame.x - point) @ normal <= 0
    return lost


def through_rings(seen: Seen, frame: Frame) -> np.ndarray:
    """Return which centres are on the other side of a ring than at the start, (N,)."""
    lost = np.zeros(len(frame.x), bool)
    for ring in seen.system.rings if len(frame.x) == len(seen.frames[0].x) else ():
        inside = [np.linalg.norm(f.x - ring.centre, axis=1) < ring.circle for f in (seen.frames[0], frame)]
        lost |= inside[0] != inside[1]
    return lost


def angular_parts(frame: Frame, centre: np.ndarray) -> tuple[np.ndarray, float]:
    """Return m (x - c) x v and I omega of every particle, (2 N, 1 or 3), and sum m |x - c| |v| + I |omega|."""
    arm = frame.x - centre
    if arm.shape[1] == 2:
        orbital = (frame.mass * (arm[:, 0] * frame.v[:, 1] - arm[:, 1] * frame.v[:, 0]))[:, None]
    else:
        orbital = frame.mass[:, None] * np.cross(arm, frame.v)
    size = frame.mass @ (np.linalg.norm(arm, axis=1) * np.linalg.norm(frame.v, axis=1))
    size += frame.inertia @ np.linalg.norm(frame.spin, axis=1)
    return np.concatenate([orbital, frame.inertia[:, None] * frame.spin]), float(size)


def parting_rate(seen: Seen, frame: Frame) -> float:
    """Rate at which the two part, m/s; negative while they approach."""
    first, walls = seen.frames[0], seen.system.walls
    if len(first.x) == 2 and not walls:
        line = first.x[1] - first.x[0]
        return float((frame.v[1] - frame.v[0]) @ line / np.linalg.norm(line))
    if len(first.x) == 1 and len(walls) == 1:
        return float(frame.v[0] @ np.array(walls[0].normal))
    raise NotKnown("neither two bodies alone nor one before one plane")


def exact_restitution(seen: Seen) -> float:
    """Return the closed form of the restitution of the two that meet. Raises NotKnown where there is none."""
    mass = seen.frames[0].mass
    ((met, _),) = by_law(seen.system, np.array([0]), np.array([1 if len(mass) == 2 else -1]))
    law = met.normal
    reduced = float(mass[0] if len(mass) == 1 else mass[0] * mass[1] / (mass[0] + mass[1]))
    if isinstance(law, LinearNormal):
        pair = LinearCollision(stiffness=law.normal_stiffness, damping=law.normal_damping, reduced_mass=reduced)
        return pair.restitution(law.attraction)
    if isinstance(law, HertzNormal):
        return law.restitution
    if isinstance(law, HystereticNormal) and not law.normal_damping:
        return _plastic(law, reduced)
    raise NotKnown("no closed form of the restitution of this law")


def _plastic(law: HystereticNormal, reduced: float) -> float:
    return ConstantUnloading(
        loading=law.loading_stiffness, unloading=law.unloading_stiffness, adhesion=law.adhesion_stiffness,
        reduced_mass=reduced,
    ).restitution


def places_apart(mine: Frame, theirs: Frame, twin: Twin, periodic: tuple[float, ...] | None) -> float:
    """Return the largest difference of a component of places from those of the scaled twin, in largest radii."""
    shift = np.zeros(mine.x.shape[1]) if twin.shift is None else np.array(twin.shift)
    apart = nearest_image(mine.x - (theirs.x * twin.length_scale + shift), periodic)
    return float(np.abs(apart).max() / mine.radius.max())


def rates_apart(mine: Frame, theirs: Frame, twin: Twin, speed: float) -> float:
    """Return the largest difference of velocities, and of spins times radius, from the scaled twin's over `speed`."""
    scale = twin.length_scale / twin.time_scale
    linear = np.abs(mine.v - scale * theirs.v).max()
    angular = (np.abs(mine.spin - theirs.spin / twin.time_scale) * mine.radius[:, None]).max()
    return float(max(linear, angular) / speed) if speed > 0 else float(max(linear, angular) > 0)
