"""Facts about a system that more than one engine has to ask for before it can write its deck."""

from __future__ import annotations

import numpy as np

from harness.scene.system import Loaded, System, Wall


def rotates(system: System) -> bool:
    """Can a contact turn a particle? Without friction and resistances spins stay what they are."""
    return any(law is not None for law in (system.sliding, system.rolling, system.torsion))


def is_rough(system: System, wall: Wall) -> bool:
    """Can the wall turn a particle?"""
    return wall.friction and rotates(system)


def is_periodic(system: System, axis: int) -> bool:
    """Is this axis periodic?"""
    return system.periodic is not None and axis < system.dimension and system.periodic[axis] > 0


def narrow_axes(system: System) -> list[str]:
    """Return the periodic axes up to two diameters long, along which a pair can touch through two images.

    Codes that keep springs by the partner's id mix up such contacts.
    """
    widest = 4.0 * float(system.particles.radius.max())
    return [axis for a, axis in enumerate("xyz") if is_periodic(system, a) and system.periodic[a] <= widest]


def walls_across(system: System, axis: int, sign: float) -> list[Wall]:
    """Return the walls whose normal is exactly +e_a or -e_a (`sign`): they bound that side of the axis."""
    unit = sign * np.eye(system.dimension)[axis]
    return [w for w in system.walls if np.array_equal(w.normal, unit)]


def crossing_walls(system: System) -> list[Wall]:
    """Return the walls that lie across a periodic axis."""
    return [w for w in system.walls if any(n != 0.0 and is_periodic(system, a) for a, n in enumerate(w.normal))]


def loaded_walls(system: System) -> list[Wall]:
    """Return the walls that have a mass."""
    return [w for w in system.walls if isinstance(w.motion, Loaded)]


def carrier_id(system: System, wall: Wall) -> int:
    """Return the atom id of the carrier of a wall with a mass; carriers come after particles and glued discs."""
    others = len(system.particles) + sum(len(ring.radius) for ring in system.rings)
    return others + 1 + [w.name for w in loaded_walls(system)].index(wall.name)
