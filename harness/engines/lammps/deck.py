"""The deck of a system: in.lammps, packing.data and, when contacts are asked for, contacts.in."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from harness.engines.facts import loaded_walls
from harness.engines.glued import MASS, group_lines, motion_lines
from harness.engines.lammps.box import Box, simulation_box
from harness.engines.lammps.effects import drag_lines, gravity_lines, integration_lines
from harness.engines.lammps.files import CONTACTS, DECK, PACKING
from harness.engines.lammps.law import pair_law
from harness.engines.lammps.materials import group_of_materials, materials_comment, pair_coefficients
from harness.engines.lammps.neighbours import neighbour_lines
from harness.engines.lammps.output import (
    check_interval,
    contacts_deck,
    output_lines,
    run_lines,
)
from harness.engines.lammps.packing import kinds, packing_data
from harness.engines.lammps.partition import balance_lines, processor_lines
from harness.engines.lammps.walls import beyond_lines, loaded_wall_lines, wall_lines
from harness.engines.text import comment, number
from harness.scene.system import INERTIA_FACTOR, System


def render(system: System, ranks: int = 1) -> dict[str, str]:
    """Return the deck's files by name, for so many processes; the same system gives the same bytes."""
    box = simulation_box(system)
    files = {DECK: _deck(system, box, ranks), PACKING: packing_data(system, box)}
    if system.contacts:
        files[CONTACTS] = contacts_deck(system, neighbour_lines(system, box))
    return files


def _deck(system: System, box: Box, ranks: int) -> str:
    lines = [
        *_title_lines(system, ranks),
        *processor_lines(system, ranks),
        *atom_lines(system, box),
        *balance_lines(system, box, ranks),
        *contact_lines(system, box),
        *integration_lines(system),
        *motion_lines(system),
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

    Raises ValueError for a wall that moves, or a ring.
    """
    if any(w.motion is not None for w in system.walls):
        raise ValueError("prescribed motion knows fixed planes only")
    if system.rings:
        raise ValueError("prescribed motion knows no rings")
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
        *materials_comment(system),
        "pair_style granular",
        *pair_coefficients(system, pair_law),
        *neighbour_lines(system, box),
    ]


def _title(system: System) -> str:
    return f"# {comment(system.scene_name)}: {comment(system.title)}".rstrip(": ")


def _title_lines(system: System, ranks: int) -> list[str]:
    lmp = "lmp" if ranks == 1 else f"mpiexec -n {ranks} lmp"
    return [
        _title(system),
        f"# LAMMPS 22 Jul 2025; run it by: {lmp} -in in.lammps"
        + (f", then: {lmp} -in contacts.in" if system.contacts else ""),
    ]


def atom_lines(system: System, box: Box) -> list[str]:
    """Return what stands before any physics.

    `newton off` and no sorting keep the order of a pair fixed, one process keeps sums in one order.
    """
    grains = [str(t) for types in kinds(system).values() for t in types]
    others = ", then glued discs" if system.rings else ""
    others += ", then wall carriers" if loaded_walls(system) else ""
    return [
        "units si",
        f"dimension {system.dimension}",
        f"boundary {box.styles()}",
        "newton off",
        "atom_style sphere",
        "atom_modify map array sort 0 0",
        "comm_modify vel yes",
        "",
        f"# grains{others}; masses come as they are, not through a density",
        *_glued_comment(system),
        "fix grain_mass all property/atom d_mass",
        f"read_data {PACKING} fix grain_mass NULL GrainMass",
        "variable mass atom d_mass",
        "set group all mass v_mass",
        "variable mass delete",
        "unfix grain_mass",
        f"group grains type {' '.join(grains)}",
        *group_lines(system),
        *group_of_materials(system),
    ]


def _glued_comment(system: System) -> list[str]:
    words = f"# {number(MASS)} kg, of glued discs, stand for infinity: reduced masses are those of the grains"
    return [words] if system.rings else []
