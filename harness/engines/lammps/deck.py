"""The deck of a system: in.lammps, packing.data and, when contacts are asked for, contacts.in."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from harness.engines.facts import loaded_walls
from harness.engines.lammps.box import Box, simulation_box
from harness.engines.lammps.effects import drag_lines, gravity_lines, integration_lines
from harness.engines.lammps.law import pair_law
from harness.engines.lammps.neighbours import neighbour_lines
from harness.engines.lammps.output import (
    check_interval,
    contacts_deck,
    output_lines,
    run_lines,
)
from harness.engines.lammps.packing import kinds, packing_data
from harness.engines.lammps.walls import beyond_lines, loaded_wall_lines, wall_lines
from harness.engines.text import comment, number
from harness.scene.system import INERTIA_FACTOR, System

DECK, PACKING, CONTACTS = "in.lammps", "packing.data", "contacts.in"
LOG = "log.lammps"
MARKER = "grainproof finished:"
"""First words of the line by which the child process says that it got to the end."""


def render(system: System) -> dict[str, str]:
    """Return the deck's files by name; the same system gives the same bytes."""
    box = simulation_box(system)
    files = {DECK: _deck(system, box), PACKING: packing_data(system, box)}
    if system.contacts:
        files[CONTACTS] = contacts_deck(system, neighbour_lines(system, box))
    return files


def _deck(system: System, box: Box) -> str:
    lines = [
        *_title_lines(system),
        *atom_lines(system, box),
        *contact_lines(system, box),
        *integration_lines(system),
        *gravity_lines(system.gravity),
        *drag_lines(system.background),
        *wall_lines(system),
        *loaded_wall_lines(system),
        *beyond_lines(system, check_interval(system)),
        *output_lines(system),
        *run_lines(system),
    ]
    return "\n".join(lines) + "\n"


def render_prescribed(system: System) -> dict[str, str]:
    """Return the deck of prescribed motion: the law alone. Nothing integrates, pulls or drags the bodies.

    Raises ValueError for a wall that moves.
    """
    if any(w.motion is not None for w in system.walls):
        raise ValueError("prescribed motion knows fixed planes only")
    alike = replace(system.particles, inertia_factor=np.full(len(system.particles), INERTIA_FACTOR["sphere"]))
    still = system.with_(particles=alike, contacts=False)
    box = simulation_box(still)
    lines = [
        _title(still),
        "# LAMMPS 22 Jul 2025, led by grainproof: a state from outside for every step, and no integrator",
        *atom_lines(still, box),
        *contact_lines(still, box),
        *wall_lines(still),
        "",
        "# histories move on by this",
        f"timestep {number(system.dt)}",
        "thermo_style custom step atoms",
        "thermo_modify lost error",
        "",
        "run 0 post no",
    ]
    return {DECK: "\n".join(lines) + "\n", PACKING: packing_data(still, box)}


def contact_lines(system: System, box: Box) -> list[str]:
    """Return the contact law between grains and the neighbour search."""
    return [
        "",
        "# contacts between grains",
        "pair_style granular",
        f"pair_coeff * * {pair_law(system)}",
        *neighbour_lines(system, box),
    ]


def _title(system: System) -> str:
    return f"# {comment(system.scene_name)}: {comment(system.title)}".rstrip(": ")


def _title_lines(system: System) -> list[str]:
    return [
        _title(system),
        "# LAMMPS 22 Jul 2025; run it by: lmp -in in.lammps"
        + (", then: lmp -in contacts.in" if system.contacts else ""),
    ]


def atom_lines(system: System, box: Box) -> list[str]:
    """Return what stands before any physics.

    `newton off` and no sorting keep the order of a pair fixed, one rank keeps sums in one order.
    """
    grains = [str(t) for t in kinds(system).values()]
    carriers = ", then wall carriers" if loaded_walls(system) else ""
    return [
        "units si",
        f"dimension {system.dimension}",
        f"boundary {box.styles()}",
        "newton off",
        "atom_style sphere",
        "atom_modify map array sort 0 0",
        "comm_modify vel yes",
        "",
        f"# grains{carriers}; masses come as they are, not through a density",
        "fix grain_mass all property/atom d_mass",
        f"read_data {PACKING} fix grain_mass NULL GrainMass",
        "variable mass atom d_mass",
        "set group all mass v_mass",
        "variable mass delete",
        "unfix grain_mass",
        f"group grains type {' '.join(grains)}",
    ]
