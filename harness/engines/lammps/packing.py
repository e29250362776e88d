"""The data file: particles, the glued discs of rings, and one carrier atom for every loaded wall.

Atom types tell the moments of inertia apart (LAMMPS integrates a group either as spheres or as
discs), and the materials where there are any; then comes the type of the glued discs, and last that of
the carriers. Masses stand in a section of their own, because the density column of the Atoms section would round them.
"""

from __future__ import annotations

import numpy as np

from harness.engines.facts import carrier_id, loaded_walls, rotates
from harness.engines.glued import MASS, glued
from harness.engines.lammps.box import Box
from harness.engines.text import comment, number, numbers
from harness.scene.system import INERTIA_FACTOR, System

INTEGRATORS = {"sphere": "nve/sphere", "disc": "nve/sphere disc"}
"""The moments of inertia LAMMPS can integrate, and how; "disc" in 2D only."""


def kinds(system: System) -> dict[str, tuple[int, ...]]:
    """Return atom types by kind of grain, one a material; one kind "grain" when nothing turns them."""
    factors = system.particles.inertia_factor
    present = [k for k in INTEGRATORS if np.any(factors == INERTIA_FACTOR[k])] if rotates(system) else ["grain"]
    count = len(words(system))
    return {kind: tuple(range(k * count + 1, (k + 1) * count + 1)) for k, kind in enumerate(present)}


def words(system: System) -> tuple[str | None, ...]:
    """Return the words of the materials, in the order of the types of a kind; (None,) without materials."""
    return (None,) if system.materials is None else system.materials.names


def types_of_material(system: System, word: str | None) -> tuple[int, ...]:
    """Return the atom types of a material, one a kind."""
    return tuple(types[words(system).index(word)] for types in kinds(system).values())


def grain_types(system: System) -> int:
    """Return the number of atom types of grains."""
    return sum(len(types) for types in kinds(system).values())


def carrier_type(system: System) -> int:
    """Return the atom type of the wall carriers, the last one."""
    return grain_types(system) + bool(system.rings) + 1


def packing_data(system: System, box: Box) -> str:
    """Return the text of packing.data."""
    sections = [_header(system, box), "Atoms # sphere\n", *_atoms(system)]
    if np.any(system.particles.v) or np.any(system.particles.spin) or np.any(glued(system).spin):
        sections += ["\nVelocities\n", *_velocities(system)]
    sections += ["\nGrainMass\n", *_masses(system)]
    return "\n".join(sections) + "\n"


def _header(system: System, box: Box) -> str:
    carriers, discs = len(loaded_walls(system)), len(glued(system))
    also = f", {discs} glued discs" if discs else ""
    also += f", {carriers} wall carriers" if carriers else ""
    bounds = [
        f"{number(axis.low)} {number(axis.high)} {a}lo {a}hi" for a, axis in zip("xyz", box.axes, strict=True)
    ]
    return "\n".join(
        [
            f"{comment(system.scene_name)}: {len(system.particles)} grains{also}",
            "",
            f"{len(system.particles) + discs + carriers} atoms",
            f"{carrier_type(system) - (not carriers)} atom types",
            "",
            *bounds,
            "",
        ]
    )


def _atoms(system: System) -> list[str]:
    """Return rows: id, type, diameter, density, x, y, z; the density is replaced by the mass."""
    p = system.particles
    types = _types(system)
    flat = " 0" if system.dimension == 2 else ""
    rows = [
        f"{i + 1} {types[i]} {number(2 * p.radius[i])} 1 {numbers(p.x[i])}{flat}" for i in range(len(p))
    ]
    discs = glued(system)
    rows += [
        f"{i} {grain_types(system) + 1} {number(2 * a)} 1 {numbers(x)} 0"
        for i, a, x in zip(discs.id, discs.radius, discs.x, strict=True)
    ]
    return rows + [f"{carrier_id(system, w)} {carrier_type(system)} 0 1 0 0 0" for w in loaded_walls(system)]


def _types(system: System) -> np.ndarray:
    first = np.ones(len(system.particles), dtype=int)
    if rotates(system):
        factors = system.particles.inertia_factor
        first = sum(t[0] * (factors == INERTIA_FACTOR[k]).astype(int) for k, t in kinds(system).items())
    return first if system.materials is None else first + system.materials.numbers(system.particles.material)


def _velocities(system: System) -> list[str]:
    p = system.particles
    flat, spin = (" 0", "0 0 ") if system.dimension == 2 else ("", "")
    rows = [f"{i + 1} {numbers(p.v[i])}{flat} {spin}{numbers(p.spin[i])}" for i in range(len(p))]
    discs = glued(system)
    rows += [f"{i} {numbers(v)} 0 0 0 {number(w)}" for i, v, w in zip(discs.id, discs.v, discs.spin, strict=True)]
    return rows + [f"{carrier_id(system, w)} 0 0 0 0 0 0" for w in loaded_walls(system)]


def _masses(system: System) -> list[str]:
    rows = [f"{i + 1} {number(m)}" for i, m in enumerate(system.particles.mass)]
    rows += [f"{i} {number(MASS)}" for i in glued(system).id]
    return rows + [f"{carrier_id(system, w)} {number(w.motion.mass)}" for w in loaded_walls(system)]
