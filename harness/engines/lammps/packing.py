"""The data file: particles, the glued discs of rings, and one carrier atom for every loaded wall.

Atom types tell the moments of inertia apart (LAMMPS integrates a group either as spheres or as
discs); then comes the type of the glued discs, and last that of the carriers. Masses stand in a
section of their own, because the density column of the Atoms section would round them.
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


def kinds(system: System) -> dict[str, int]:
    """Return atom type by kind of grain; one kind "grain" when nothing turns them."""
    if not rotates(system):
        return {"grain": 1}
    factors = system.particles.inertia_factor
    present = [k for k in INTEGRATORS if np.any(factors == INERTIA_FACTOR[k])]
    return {kind: t for t, kind in enumerate(present, start=1)}


def carrier_type(system: System) -> int:
    """Return the atom type of the wall carriers, the last one."""
    return len(kinds(system)) + bool(system.rings) + 1


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
        f"{i} {len(kinds(system)) + 1} {number(2 * a)} 1 {numbers(x)} 0"
        for i, a, x in zip(discs.id, discs.radius, discs.x, strict=True)
    ]
    return rows + [f"{carrier_id(system, w)} {carrier_type(system)} 0 1 0 0 0" for w in loaded_walls(system)]


def _types(system: System) -> np.ndarray:
    of_kind = kinds(system)
    if not rotates(system):
        return np.ones(len(system.particles), dtype=int)
    factors = system.particles.inertia_factor
    return sum(t * (factors == INERTIA_FACTOR[k]).astype(int) for k, t in of_kind.items())


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
