"""The simulation box: where LAMMPS keeps its atoms, which is not where the walls are.

Behind an axis-aligned wall there is little room: a grain that breaks through the wall leaves the box
and LAMMPS stops with "Lost atoms"; so too behind a ring around all grains. On an open side the box
ends a billion system sizes away, which only a run that blew up reaches. (Shrink-wrapped faces would do
without that number, but restart files written between two neighbour searches cannot be read when a
grain has left the box of the last one.)
In 2D the z axis is periodic, one unit thick.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from harness.engines.facts import is_periodic, loaded_walls, walls_across
from harness.engines.glued import enclosing, reach
from harness.scene.system import Constant, Cosine, Loaded, System, Wall

ROOM_IN_RADII = 4.0
"""Distance of a face from the wall before it, in largest radii."""
FAR = 1e9
"""Distance of an open face, in system sizes."""


@dataclass(frozen=True, kw_only=True)
class Axis:
    """One axis of the box: bounds in m, periodic or not, and whether a side of it is open."""

    low: float
    high: float
    periodic: bool = False
    is_open: bool = False


@dataclass(frozen=True, kw_only=True)
class Box:
    """The three axes."""

    axes: tuple[Axis, ...]

    @property
    def is_open(self) -> bool:
        """Is a side open, so that the box is far larger than what is in it?"""
        return any(axis.is_open for axis in self.axes)

    def styles(self) -> str:
        """Return the words of the `boundary` command."""
        return " ".join("p" if axis.periodic else "f" for axis in self.axes)


def simulation_box(system: System) -> Box:
    """Return the box of a system; it also holds the origin, where the wall carriers stand."""
    axes = [_axis(system, a) for a in range(system.dimension)]
    if system.dimension == 2:
        axes.append(Axis(low=-0.5, high=0.5, periodic=True))
    return Box(axes=tuple(axes))


def _axis(system: System, a: int) -> Axis:
    if is_periodic(system, a):
        return Axis(low=0.0, high=system.periodic[a], periodic=True)
    p = system.particles
    room = ROOM_IN_RADII * float(p.radius.max())
    below, above = walls_across(system, a, +1.0), walls_across(system, a, -1.0)
    ends = [*_origin(system), *(p.x[:, a] - p.radius), *(p.x[:, a] + p.radius)]
    ends += [*(w.point[a] for w in below + above), *reach(system, a)]
    extent = max(ends) - min(ends)
    low = min([*ends, *(w.point[a] + _lowest(system, w, extent) for w in below)]) - room
    high = max([*ends, *(w.point[a] - _lowest(system, w, extent) for w in above)]) + room
    inside = enclosing(system) is not None
    return Axis(
        low=low if below or inside else low - FAR * extent,
        high=high if above or inside else high + FAR * extent,
        is_open=not (inside or (below and above)),
    )


def _origin(system: System) -> list[float]:
    return [0.0] if loaded_walls(system) else []


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
