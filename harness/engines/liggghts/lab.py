"""The deck of prescribed motion: particles, walls and laws, but nothing that moves them.

`harness.engines.liggghts.prescribed` runs it and then leads the bodies along their path. Neighbour lists are
renewed in every step, so that a contact that opens is forgotten however fast it opens.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from harness.engines.liggghts.deck import DATA, INPUT, cell_words, skin_of
from harness.engines.liggghts.domain import Domain, domain_of
from harness.engines.liggghts.law import header_lines, law_lines
from harness.engines.liggghts.motions import carrier_lines
from harness.engines.liggghts.packing import packing_data
from harness.engines.liggghts.planes import meshes, stl
from harness.engines.liggghts.walls import wall_lines
from harness.engines.text import comment, number
from harness.scene.system import System, Wall

ROOM = 3.0
"""How far bodies may be led from where the deck places them, in largest radii; meshes end not far beyond."""

CELLS = 20_000
"""Cells of the neighbour search: it starts anew in every step."""


def render_prescribed(system: System) -> dict[str, str]:
    """Return the deck files; raises ValueError for a wall that moves, a ring, or a periodic axis."""
    if any(w.motion is not None for w in system.walls) or system.periodic is not None:
        raise ValueError("prescribed motion knows fixed planes and open axes only")
    if system.rings:
        raise ValueError("prescribed motion knows no rings")
    still = _at_rest(system)
    domain = _roomy(domain_of(still), ROOM * float(system.particles.radius.max()), system.dimension)
    files = {INPUT: _script(still, domain), DATA: packing_data(still, domain)}
    return files | {f"{w.name}.stl": _small_stl(still, w) for w in meshes(still)}


def _at_rest(system: System) -> System:
    """Return the bodies at rest: they fly nowhere, so the domain is no larger than it has to be."""
    p = system.particles
    still = replace(p, v=np.zeros_like(p.v), spin=np.zeros_like(p.spin))
    return system.with_(particles=still, contacts=False, gravity=None, background=None)


def _small_stl(system: System, wall: Wall) -> str:
    """Return a triangle below the bodies that can come to the plane: a large one costs digits of the overlap."""
    p = system.particles
    room = ROOM * float(p.radius.max())
    near = (p.x - wall.point) @ np.array(wall.normal) < p.radius + room
    chosen = near if near.any() else np.ones(len(p), bool)
    arrays = ("x", "radius", "mass", "inertia_factor", "v", "spin")
    bodies = replace(p, **{name: getattr(p, name)[chosen] for name in arrays})
    bounds = np.zeros((3, 2))
    bounds[: system.dimension] = np.stack([bodies.x.min(axis=0) - room, bodies.x.max(axis=0) + room], axis=1)
    return stl(system.with_(particles=bodies), wall, bounds)


def _roomy(domain: Domain, room: float, dimension: int) -> Domain:
    bounds = domain.bounds.copy()
    bounds[:dimension] += [-room, room]
    return Domain(bounds=bounds, styles=domain.styles, discs=domain.discs)


def _script(system: System, domain: Domain) -> str:
    skin = skin_of(system)
    lines = [
        f"# {comment(system.title) or system.scene_name}",
        f"# {len(system.particles)} bodies that are led along a path from outside",
        "units si", "atom_style granular", "atom_modify map array sort 0 0", f"boundary {domain.styles}",
        *(["dimension 2"] if domain.discs else []),
        "newton off", "communicate single vel yes", *header_lines(system), f"read_data {DATA}", *carrier_lines(system),
        "", "# neighbours", f"neighbor {number(skin)} bin",
        " ".join(["neigh_modify delay 0 every 1 check no", *cell_words(domain, _cutoff(system, skin), CELLS)]),
        *law_lines(system), *wall_lines(system),
        "", "# states come from outside, one a step; histories move on by this", f"timestep {number(system.dt)}",
        "thermo_style custom step atoms", "thermo_modify lost error",
    ]
    return "\n".join(lines) + "\n"


def _cutoff(system: System, skin: float) -> float:
    return 2.0 * float(system.particles.radius.max()) + skin
