"""A system as a LIGGGHTS deck: in.liggghts, packing.data and one STL file a mesh."""

from __future__ import annotations

import math

import numpy as np

from harness.engines.facts import loaded_walls
from harness.engines.glued import MASS, exclusion_lines, glued, group_lines
from harness.engines.glued import motion_lines as ring_lines
from harness.engines.liggghts.domain import Domain, domain_of
from harness.engines.liggghts.law import header_lines, history, law_lines
from harness.engines.liggghts.motions import carrier_lines, constant_motion_lines, motion_lines
from harness.engines.liggghts.output import contact_computes, frame_lines, series_lines
from harness.engines.liggghts.packing import packing_data
from harness.engines.liggghts.planes import meshes, space, stl
from harness.engines.liggghts.walls import wall_lines
from harness.engines.ranks import processor_lines
from harness.engines.text import comment, number
from harness.scene.system import System

INPUT, DATA = "in.liggghts", "packing.data"
FINISHED = "grainproof: finished"
"""First words of the line that only a run that reached its end prints."""

SKIN_IN_RADII = 0.3
"""Skin of the neighbour lists in mean radii; results do not depend on it, cost does (measured)."""

MAX_BINS = 1_000_000
"""Cells of the neighbour search; a wide domain around few particles gets larger cells instead."""


def render(system: System, ranks: int = 1) -> dict[str, str]:
    """Return the deck files by name, for so many processes: deterministic, 17 digits."""
    domain = domain_of(system)
    files = {INPUT: input_script(system, domain, ranks), DATA: packing_data(system, domain)}
    return files | {f"{w.name}.stl": stl(system, w, domain.bounds) for w in meshes(system)}


def input_script(system: System, domain: Domain, ranks: int = 1) -> str:
    """Return the text of in.liggghts, one group of lines an effect."""
    lines = [
        *opening_lines(system, domain, ranks), *neighbour_lines(system, domain), *law_lines(system),
        "", "# velocity Verlet", "fix integrate grains nve/sphere",
        *drag_lines(system), *gravity_lines(system), *wall_lines(system),
        *constant_motion_lines(system), *flat_lines(system, domain),
        *contact_computes(system), *_first_force_lines(system), "", f"timestep {number(system.dt)}",
        *motion_lines(system), *ring_lines(system), *series_lines(system), *frame_lines(system), *_run_lines(system),
    ]
    return "\n".join(lines) + "\n"


def opening_lines(system: System, domain: Domain, ranks: int = 1) -> list[str]:
    """Return what stands before any physics: title, units, atoms."""
    particles, discs = len(system.particles), len(glued(system))
    also = [f"# {discs} glued discs behind them, whose {number(MASS)} kg stand for infinity"] if discs else []
    launcher = f"mpirun -np {ranks} " if ranks > 1 else ""
    return [
        f"# {comment(system.title) or system.scene_name}",
        f"# LIGGGHTS-PUBLIC 3.8.0; run it by: {launcher}liggghts -in {INPUT}",
        f"# {particles} particles, {system.steps} steps of {number(system.dt)} s",
        *also,
        "units si",
        *processor_lines(system, ranks),
        "atom_style granular",
        "atom_modify map array sort 0 0   # sorting would swap i and j of a contact",
        f"boundary {domain.styles}",
        *(["dimension 2"] if domain.discs else []),
        "newton off",
        "communicate single vel yes",
        *header_lines(system),
        f"read_data {DATA}",
        *group_lines(system),
        *carrier_lines(system),
    ]


def neighbour_lines(system: System, domain: Domain) -> list[str]:
    """Lists are renewed before anything can have moved by half a skin, so no contact is missed.

    contact_distance_factor keeps a pair known just after it opens, so that its spring is cleared:
    otherwise a spring outlives its contact until the next renewal of the lists.
    """
    skin = skin_of(system)
    factor = 1.01 if history(system) else 1.0
    words = ["delay 0 every 1 check yes"]
    if history(system):
        words.append(f"contact_distance_factor {factor}")
    words += cell_words(domain, 2.0 * factor * float(system.particles.radius.max()) + skin)
    if loaded_walls(system):
        words.append("exclude group carriers all")
    search = [f"neighbor {number(skin)} bin", f"neigh_modify {' '.join(words)}", *exclusion_lines(system)]
    return ["", "# neighbours", *search]


def skin_of(system: System) -> float:
    """Return how far beyond their reach particles are listed as neighbours, m."""
    return SKIN_IN_RADII * float(system.particles.radius.mean())


def cell_words(domain: Domain, cutoff: float, most: int = MAX_BINS) -> list[str]:
    """Return a cell size where half the cutoff, the default, would make too many cells."""
    axes = 2 if domain.discs else 3
    sides = np.diff(domain.bounds[:axes], axis=1)[:, 0]
    cells = math.prod(sides / (0.5 * cutoff))
    if cells <= most:
        return []
    return [f"binsize {number(0.5 * cutoff * (cells / most) ** (1.0 / axes))}"]


def flat_lines(system: System, domain: Domain) -> list[str]:
    """Keep a 2D system flat; behind all forces, as an oblique mesh may push out of the plane by rounding."""
    if system.dimension == 3:
        return []
    return ["", "fix flat all enforce2d" if domain.discs else "fix flat grains setforce NULL NULL 0.0"]


def drag_lines(system: System) -> list[str]:
    """Return f = -c v on the particles, c in kg/s."""
    if system.background is None:
        return []
    drag = number(system.background.translational_drag)
    return ["", "# drag of the surroundings, f = -c v", f"fix drag grains viscous {drag}"]


def gravity_lines(system: System) -> list[str]:
    """Return f = m g on the particles; gravity in m/s^2."""
    if system.gravity is None:
        return []
    size = number(math.hypot(*system.gravity))
    return ["", f"fix gravity grains gravity {size} vector {space(system.gravity)}"]


def _first_force_lines(system: System) -> list[str]:
    """Make a step of length 0: LIGGGHTS knows the force on a mesh only after a step."""
    if not meshes(system):
        return []
    return ["", "# a step of length 0, which moves nothing: after it the forces on the meshes are known",
            "timestep 0.0", "run 1", "reset_timestep 0"]


def _run_lines(system: System) -> list[str]:
    atoms = len(system.particles) + len(glued(system)) + len(loaded_walls(system))
    return [
        "",
        f"run {system.steps}",
        "variable done equal step",
        "variable left equal atoms",
        f'print "{FINISHED} step ${{done}} of {system.steps} with ${{left}} of {atoms} atoms"',
    ]
