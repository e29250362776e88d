"""The data file: particles, the glued discs of rings, and one carrier atom for every wall with a mass.

A carrier is no particle: it never moves and touches nothing, its velocity components only store the
state of its wall (see `motions`).
"""

from __future__ import annotations

import itertools

import numpy as np

from harness.engines.facts import carrier_id, loaded_walls
from harness.engines.glued import MASS, glued
from harness.engines.liggghts.domain import Domain
from harness.engines.liggghts.law import glued_types, particle_types, type_count
from harness.engines.liggghts.planes import meshes
from harness.engines.text import comment, number, numbers
from harness.scene.system import System


def packing_data(system: System, domain: Domain) -> str:
    """Return the text of packing.data."""
    atoms = len(system.particles) + len(glued(system)) + len(loaded_walls(system))
    bounds = [f"{numbers(b)} {a}lo {a}hi" for a, b in zip("xyz", domain.bounds, strict=True)]
    head = [f"{comment(system.scene_name)}: id, type, diameter, density, position", "",
            f"{atoms} atoms", f"{type_count(system)} atom types", "", *bounds]
    sections = [*head, "", "Atoms", "", *_atoms(system, domain)]
    if np.any(system.particles.v) or np.any(system.particles.spin) or np.any(glued(system).spin):
        sections += ["", "Velocities", "", *_velocities(system)]
    return "\n".join(sections) + "\n"


def _atoms(system: System, domain: Domain) -> list[str]:
    """Return rows; the density column is mass over the volume LIGGGHTS gives a disc or a sphere."""
    p = system.particles
    volume = np.pi * p.radius**2 if domain.discs else 4.0 / 3.0 * np.pi * p.radius**3
    density = p.mass / volume
    flat = " 0" if system.dimension == 2 else ""
    types = particle_types(system)
    rows = [
        f"{i + 1} {types[i]} {number(2 * p.radius[i])} {number(density[i])} {numbers(p.x[i])}{flat}"
        for i in range(len(p))
    ]
    rows += _glued_atoms(system, domain)
    return rows + [
        f"{carrier_id(system, w)} 1 {number(2 * p.radius.min())} {number(density.min())}"
        f" {numbers(_parking_place(system, domain))}"
        for w in loaded_walls(system)
    ]


def _glued_atoms(system: System, domain: Domain) -> list[str]:
    """Return the rows of glued discs; their mass stands for infinity."""
    discs, types = glued(system), glued_types(system)
    density = MASS / (np.pi * discs.radius**2 if domain.discs else 4.0 / 3.0 * np.pi * discs.radius**3)
    return [
        f"{i} {kind} {number(2 * a)} {number(rho)} {numbers(x)} 0"
        for i, kind, a, rho, x in zip(discs.id, types, discs.radius, density, discs.x, strict=True)
    ]


def _parking_place(system: System, domain: Domain) -> np.ndarray:
    """Return the corner of the domain, or its middle, that is farthest from all meshes.

    Meshes see every atom. They cannot push a carrier, but one just on a plane has no normal.
    """
    room = float(system.particles.radius.max())
    ends = np.array([[low + room, high - room] for low, high in domain.bounds[: system.dimension]])
    places = [np.array(corner) for corner in itertools.product(*ends)] + [ends.mean(axis=1)]
    clearance = [min(abs(np.dot(x - w.point, w.normal)) for w in meshes(system)) for x in places]
    return np.pad(places[int(np.argmax(clearance))], (0, 3 - system.dimension))


def _velocities(system: System) -> list[str]:
    p = system.particles
    flat, spin = (" 0", "0 0 ") if system.dimension == 2 else ("", "")
    rows = [f"{i + 1} {numbers(p.v[i])}{flat} {spin}{numbers(p.spin[i])}" for i in range(len(p))]
    discs = glued(system)
    rows += [f"{i} {numbers(v)} 0 0 0 {number(w)}" for i, v, w in zip(discs.id, discs.v, discs.spin, strict=True)]
    return rows + [f"{carrier_id(system, w)} 0 0 0 0 0 0" for w in loaded_walls(system)]
