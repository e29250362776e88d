"""Rings of glued discs for the codes of the LAMMPS family: atoms of their own, led round by `fix move rotate`.

The atoms are ids N+1, N+2, ..., ring after ring. `fix move rotate` sets x, v and omega in the first half of a step to
those at its end, exactly: x = c + Q(omega t) (x_0 - c), v = omega x (x - c). So the forces of a step see the full-step
velocities of glued discs beside the half-step ones of particles. A ring that rests is not integrated; its atoms keep
the forces on them all the same.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from harness.engines.text import number, numbers
from harness.scene.system import Ring, System

if TYPE_CHECKING:
    from postproc.readers.rings import GluedRing

MASS = 2.0**100
"""Of a glued disc, kg: beside it m_i m_j/(m_i + m_j) is m_i, as at a disc of infinite mass; a power of two rounds
nothing."""

GROUP = "glued"
"""Of all glued discs; that of one ring is called ring_<name>."""


@dataclass(frozen=True, kw_only=True)
class Glued:
    """All glued discs at the start: id (M,); x, v (M, 2) in m, m/s; spin (M,) in rad/s; radius (M,) in m."""

    id: np.ndarray
    x: np.ndarray
    v: np.ndarray
    spin: np.ndarray
    radius: np.ndarray

    def __len__(self) -> int:
        return len(self.id)


def glued(system: System) -> Glued:
    """Return the glued discs of all rings, ring after ring; none without rings."""
    rings = system.rings
    x = np.concatenate([np.empty((0, 2)), *(ring.x for ring in rings)])
    return Glued(
        id=np.arange(len(x)) + len(system.particles) + 1, x=x,
        v=np.concatenate([np.empty((0, 2)), *(velocities(ring) for ring in rings)]),
        spin=np.concatenate([np.empty(0), *(np.full(len(ring.radius), ring.omega or 0.0) for ring in rings)]),
        radius=np.concatenate([np.empty(0), *(ring.radius for ring in rings)]),
    )


def velocities(ring: Ring) -> np.ndarray:
    """Return omega x (x - c) at the start, (M, 2)."""
    arm = ring.x - np.array(ring.centre)
    return (ring.omega or 0.0) * np.column_stack([-arm[:, 1], arm[:, 0]])


def enclosing(system: System) -> Ring | None:
    """Return the smallest ring that has all particles inside its circle: nothing of the system is farther out."""
    x = system.particles.x
    around = [r for r in system.rings if np.linalg.norm(x - r.centre, axis=1).max() < r.circle]
    return min(around, key=lambda r: r.circle, default=None)


def reach(system: System, axis: int) -> list[float]:
    """Return how far the rings reach along an axis in any position they turn to, m."""
    arms = [float((np.linalg.norm(r.x - r.centre, axis=1) + r.radius).max()) for r in system.rings]
    return [r.centre[axis] + side * arm for r, arm in zip(system.rings, arms, strict=True) for side in (-1.0, 1.0)]


def group_lines(system: System) -> list[str]:
    """Return the groups; glued discs never touch each other."""
    if not system.rings:
        return []
    first = len(system.particles) + 1
    lines, start = [], first
    for ring in system.rings:
        end = start + len(ring.radius) - 1
        lines.append(f"group {_group(ring)} id {start}:{end}")
        start = end + 1
    return [*lines, f"group {GROUP} id {first}:{start - 1}"]


def exclusion_lines(system: System) -> list[str]:
    """Return the words that keep glued discs from touching each other."""
    return [f"neigh_modify exclude group {GROUP} {GROUP}"] if system.rings else []


def motion_lines(system: System) -> list[str]:
    """Return what turns the rings; the period of `fix move rotate` is positive, so that the axis bears the sign."""
    turning = [ring for ring in system.rings if ring.omega]
    if not turning:
        return []
    lines = ["", "# rings that turn: x, v and omega of the glued discs at the end of the step"]
    for ring in turning:
        axis, period = math.copysign(1.0, ring.omega), 2.0 * math.pi / abs(ring.omega)
        lines.append(
            f"fix turn_{ring.name} {_group(ring)} move rotate {numbers(ring.centre)} 0 0 0 {number(axis)}"
            f" {number(period)}"
        )
    return lines


def series_lines(system: System) -> list[str]:
    """Return the sums over the glued discs of each ring: force, and torque about the ring's centre."""
    lines = []
    for ring in system.rings:
        name, group, (x, y) = ring.name, _group(ring), (number(c) for c in ring.centre)
        lines += [
            f"compute couple_{name} {group} property/atom tqz",
            f"variable moment_{name} atom (x-({x}))*fy-(y-({y}))*fx+c_couple_{name}",
            f"compute sum_{name} {group} reduce sum v_moment_{name} fx fy",
        ]
    return lines


def series_columns(system: System) -> dict[str, str]:
    """Return the words of the deck by column of the series."""
    return {
        f"{ring.name}_{c}": f"c_sum_{ring.name}[{k + 1}]"
        for ring in system.rings for k, c in enumerate(("torque", "fx", "fy"))
    }


def read_as(system: System) -> tuple[GluedRing, ...]:
    """Return the rings as readers want them."""
    from postproc.readers.rings import GluedRing

    names = ("index", "name", "centre", "circle", "x", "radius")
    return tuple(GluedRing(omega=r.omega or 0.0, **{a: getattr(r, a) for a in names}) for r in system.rings)


def _group(ring: Ring) -> str:
    return f"ring_{ring.name}"
