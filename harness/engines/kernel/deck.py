"""A system as the kernel's deck: kernel.json and particles.csv, with rings also rings.csv.

Effects that are off have no key. Laws go in as the scene has them, by their word `law` and the scene's own names of
parameters.
"""

from __future__ import annotations

import json
from typing import TYPE_CHECKING

import numpy as np

from harness.scene.system import Constant, Cosine, Cycles, Loaded, System

if TYPE_CHECKING:
    from harness.scene.system import Ring, Wall


def render_deck(system: System, convention: str) -> dict[str, str]:
    """Return the deck files by name."""
    deck = {
        "title": system.title,
        "dimension": system.dimension,
        "convention": convention,
        "dt": system.dt,
        "plan": _plan(system),
        "normal": _law(system, "normal"),
        "walls": [_wall(w, system) for w in system.walls],
        **_optional(system),
    }
    glued = {"rings.csv": _glued_discs(system)} if system.rings else {}
    return {"kernel.json": json.dumps(deck, indent=1) + "\n", "particles.csv": _particles(system), **glued}


def _plan(system: System) -> dict:
    keys = ("steps", "sample_every", "frame_every", "contacts")
    return {k: getattr(system, k) for k in keys}


def _optional(system: System) -> dict:
    families = [f for f in ("sliding", "rolling", "torsion") if getattr(system, f) is not None]
    on: dict = {family: _law(system, family) for family in families}
    if system.materials is not None:
        on["materials"] = list(system.materials.names)
    if system.background is not None:
        on["drag"] = system.background.translational_drag
    if system.gravity is not None:
        on["gravity"] = list(system.gravity)
    if system.periodic is not None:
        on["periodic"] = list(system.periodic)
    if system.rotations:
        on["rotations"] = True
    if system.rings:
        on["rings"] = [_ring(ring) for ring in system.rings]
    return on


def _law(system: System, family: str) -> dict:
    """The scene's table of a law, without what is not given and without what only chooses the time step.

    With materials its numbers are tables over pairs of them.
    """
    import msgspec

    table = msgspec.to_builtins(getattr(system, family))
    given = {k: v for k, v in table.items() if v is not None and k != "impact_speed"}
    if system.materials is None:
        return given
    return {k: v if isinstance(v, str) else system.materials.table(family, k).tolist() for k, v in given.items()}


def _wall(wall: Wall, system: System) -> dict:
    material = {} if system.materials is None else {"material": system.materials.number(wall.material)}
    return {
        "name": wall.name, "point": list(wall.point), "normal": list(wall.normal), "friction": wall.friction,
        "motion": _motion(wall.motion, system), **material,
    }


def _motion(motion, system: System) -> dict:
    if motion is None:
        return {"kind": "fixed"}
    if isinstance(motion, Cosine):
        again = {"cycles": motion.cycles} if isinstance(motion, Cycles) else {}
        return {"kind": "cosine", "travel": motion.travel, "duration": motion.duration, **again}
    if isinstance(motion, Constant):
        return {"kind": "constant", "velocity": list(motion.velocity)}
    return {"kind": "loaded", "mass": motion.mass, "load": motion.load, "stress": motion.stress,
            "span": _span(motion, system), "damping": motion.damping}


def _span(motion: Loaded, system: System) -> list[int] | None:
    return None if motion.span is None else [system.wall(name).index - 1 for name in motion.span]


def _ring(ring: Ring) -> dict:
    """The ring without its discs; one at rest has no omega."""
    turning = {} if ring.omega is None else {"omega": ring.omega}
    return {"name": ring.name, "centre": list(ring.centre), "circle": ring.circle, **turning}


def _glued_discs(system: System) -> str:
    """A line for every disc: the number of its ring, from 1 on, its place and its radius."""
    rows = (
        ",".join([str(number), *(repr(float(value)) for value in (*place, radius))])
        for number, ring in enumerate(system.rings, start=1)
        for place, radius in zip(ring.x, ring.radius, strict=True)
    )
    return "\n".join(["ring,x,y,radius", *rows]) + "\n"


def _particles(system: System) -> str:
    p, dim = system.particles, system.dimension
    axes, spins = "xyz"[:dim], (["wz"] if dim == 2 else ["wx", "wy", "wz"])
    header = ["id", *axes, "radius", "mass", "inertia", *(f"v{a}" for a in axes), *spins]
    inertia = p.inertia_factor * p.mass * p.radius**2
    table = np.column_stack([p.x, p.radius, p.mass, inertia, p.v, p.spin])
    materials = [""] * len(p)
    if system.materials is not None:
        header.append("material")
        materials = [f",{m}" for m in system.materials.numbers(p.material)]
    rows = (
        ",".join([str(k + 1), *(repr(float(value)) for value in row)]) + material
        for k, (row, material) in enumerate(zip(table, materials, strict=True))
    )
    return "\n".join([",".join(header), *rows]) + "\n"
