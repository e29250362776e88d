"""Atom types: LIGGGHTS keeps the constants of a law in tables over pairs of types.

Mostly there is one type, of everything. Meshes without friction beside meshes with friction are a type of
their own, because all meshes share one `fix wall/gran`. Where a constant depends on who touches whom (a
dashpot that LIGGGHTS wants as a restitution), every radius and mass is a type, walls are another, and so is every
radius of glued discs, whose mass is infinite. Materials, which go with laws that have no such dashpot, are a type each,
of particles and walls alike.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import inf

import numpy as np

from harness.engines.facts import is_rough
from harness.engines.glued import glued
from harness.engines.liggghts.planes import meshes
from harness.scene.system import System, Wall

MOST_BODIES = 12
"""Different bodies that get types of their own; the tables grow with the square."""


@dataclass(frozen=True, kw_only=True)
class Kind:
    """What atoms and walls of one type are; radius (m) and mass (kg) are inf for walls, None where they do not count.

    Of glued discs the mass alone is infinite. smooth: walls that only push. material: the word; None without materials.
    """

    radius: float | None = None
    mass: float | None = None
    smooth: bool = False
    material: str | None = None


def kinds(system: System, *, by_body: bool) -> tuple[Kind, ...]:
    """Return what type 1, 2, ... are."""
    if system.materials is not None:
        pushing = sorted({w.material for w in _pushing(system)})
        return tuple(
            [Kind(material=word) for word in system.materials.names]
            + [Kind(radius=inf, mass=inf, smooth=True, material=word) for word in pushing]
        )
    found = [Kind(radius=r, mass=m) for r, m in bodies(system)] if by_body else [Kind()]
    if by_body and system.walls:
        found.append(Kind(radius=inf, mass=inf))
    if mixed(system):
        found.append(Kind(radius=inf, mass=inf, smooth=True))
    if by_body:
        found += [Kind(radius=r, mass=inf) for r in _glued_radii(system)]
    return tuple(found)


def bodies(system: System) -> list[tuple[float, float]]:
    """Return the different (radius, mass) of the particles, ascending."""
    p = system.particles
    return sorted(set(zip(p.radius.tolist(), p.mass.tolist(), strict=True)))


def types_of_particles(system: System, *, by_body: bool) -> np.ndarray:
    """Return the type of every particle, (N,)."""
    p = system.particles
    if system.materials is not None:
        return 1 + system.materials.numbers(p.material)
    if not by_body:
        return np.ones(len(p), dtype=int)
    number = {body: k + 1 for k, body in enumerate(bodies(system))}
    return np.array([number[body] for body in zip(p.radius.tolist(), p.mass.tolist(), strict=True)])


def types_of_glued(system: System, *, by_body: bool) -> np.ndarray:
    """Return the type of every glued disc, (M,); theirs are the last ones."""
    radius = glued(system).radius
    if not by_body:
        return np.ones(len(radius), dtype=int)
    sizes = _glued_radii(system)
    first = len(kinds(system, by_body=True)) - len(sizes) + 1
    return np.array([first + sizes.index(r) for r in radius.tolist()], dtype=int)


def _glued_radii(system: System) -> list[float]:
    return sorted(set(glued(system).radius.tolist()))


def type_of_wall(system: System, wall: Wall, *, by_body: bool) -> int:
    """Return the type whose constants a wall has."""
    if system.materials is not None:
        wanted = [(k.material, k.smooth) for k in kinds(system, by_body=False)]
        return 1 + wanted.index((wall.material, wall in _pushing(system)))
    rough = len(bodies(system)) + 1 if by_body else 1
    return rough + 1 if wall in _pushing(system) else rough


def _pushing(system: System) -> list[Wall]:
    """Return the meshes without friction beside meshes with friction."""
    return [w for w in meshes(system) if not is_rough(system, w)] if mixed(system) else []


def mixed(system: System) -> bool:
    """Are there meshes with friction and meshes without?"""
    return len({is_rough(system, w) for w in meshes(system)}) == 2


def reduced(a: float, b: float) -> float:
    """Return a b/(a + b) of two masses or radii, of which one may be a wall's; 1 for two walls, which never touch.

    >>> reduced(2.0, 2.0), reduced(2.0, inf)
    (1.0, 2.0)
    """
    if a == b == inf:
        return 1.0
    return min(a, b) if inf in (a, b) else a * b / (a + b)
