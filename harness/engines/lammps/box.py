"""The simulation box: where LAMMPS keeps its atoms, which is not where the walls are.

A face behind an axis-aligned wall is fixed (`f`) with some room: a particle that breaks through the
wall leaves the box and LAMMPS stops with "Lost atoms". An open face shrink-wraps (`s`): nothing that
flies can leave. In 2D the z axis is periodic, one unit thick.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from harness.scene.system import Constant, Cosine, Loaded, System, Wall

@dataclass(frozen=True, kw_only=True)
class Face:
    """One side of the box: its coordinate in m and its LAMMPS style, "p", "f" or "s"."""

    position: float
    style: str


@dataclass(frozen=True, kw_only=True)
class Box:
    """Three (lower, upper) pairs of faces."""

    axes: tuple[tuple[Face, Face], ...]

    @property
    def is_open(self) -> bool:
        """Can the box grow?"""
        return any(face.style == "s" for pair in self.axes for face in pair)

    def styles(self) -> str:
        """Return the words of the `boundary` command."""
        return " ".join("p" if low.style == "p" else low.style + high.style for low, high in self.axes)


def simulation_box(system: System) -> Box:
    """Return the box of a system; it also holds the origin, where the wall carriers stand."""
    axes = [_axis(system, a) for a in range(system.dimension)]
    if system.dimension == 2:
        axes.append((Face(position=-0.5, style="p"), Face(position=0.5, style="p")))
    return Box(axes=tuple(axes))


def is_periodic(system: System, axis: int) -> bool:
    """Is this axis periodic?"""
    return system.periodic is not None and system.periodic[axis] > 0


def _axis(system: System, a: int) -> tuple[Face, Face]:
    if is_periodic(system, a):
        return Face(position=0.0, style="p"), Face(position=system.periodic[a], style="p")
    p = system.particles
    room = 4.0 * float(p.radius.max())
    below, above = _walls_across(system, a, +1.0), _walls_across(system, a, -1.0)
    ends = [*_carrier(system), *(p.x[:, a] - p.radius), *(p.x[:, a] + p.radius), *(w.point[a] for w in below + above)]
    extent = max(ends) - min(ends)
    low = min([*ends, *(w.point[a] + _lowest(system, w, extent) for w in below)])
    high = max([*ends, *(w.point[a] - _lowest(system, w, extent) for w in above)])
    return (
        Face(position=low - room, style="f" if below else "s"),
        Face(position=high + room, style="f" if above else "s"),
    )


def _carrier(system: System) -> list[float]:
    return [0.0] if any(isinstance(w.motion, Loaded) for w in system.walls) else []


def _walls_across(system: System, a: int, sign: float) -> list[Wall]:
    """Return the walls whose normal is exactly +-e_a."""
    unit = sign * np.eye(system.dimension)[a]
    return [w for w in system.walls if np.array_equal(w.normal, unit)]


def _lowest(system: System, wall: Wall, extent: float) -> float:
    """Return the lowest displacement along the normal (outwards is negative) during the run.

    A loaded wall goes where the particles push it: it gets the extent of the whole system.
    """
    motion = wall.motion
    if isinstance(motion, Loaded):
        return -extent
    if isinstance(motion, Cosine):
        return min(0.0, motion.travel)
    if isinstance(motion, Constant):
        return min(0.0, float(np.dot(motion.velocity, wall.normal)) * system.steps * system.dt)
    return 0.0
