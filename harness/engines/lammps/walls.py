"""Deck lines for walls: a plane region each, its motion, its contact law, and the wall with a mass.

A wall's state is one scalar: its displacement `disp_<name>` along its normal since step 0, inwards
positive, with rate `rate_<name>`. `region ... move` takes displacements; LAMMPS differentiates them into
the half-step wall velocity (x(n) - x(n-1))/dt that the contact damping and friction need.

A wall with a mass is carried by an atom: LAMMPS integrates the atom by velocity Verlet with the force

    F = load + stress * extent - F_grains . n - damping * v      (F_grains: force of the wall on the grains)

and the atom's coordinate is the displacement, scaled by a power of two, which rounds nothing and
keeps the atom at its place in the box wherever the wall goes.
"""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

from harness.engines.facts import carrier_id, is_periodic, loaded_walls
from harness.engines.lammps.materials import wall_laws
from harness.engines.text import number, numbers
from harness.scene.system import Constant, Cosine, Loaded, System, Wall

CARRIER_SCALE = 2.0**20
"""Displacement of a loaded wall over its carrier's coordinate."""


def wall_lines(system: System) -> list[str]:
    """Return the planes, their motions and their contact laws."""
    lines: list[str] = []
    for wall in system.walls:
        lines += ["", f"# wall {wall.index}: {wall.name}", *motion_lines(system, wall)]
        lines += [_region_line(system, wall), *_contact_lines(system, wall)]
    return lines


def motion_lines(system: System, wall: Wall) -> list[str]:
    """Return `disp_<name>` and `rate_<name>`, displacement along the normal and its rate; none when fixed."""
    motion, name = wall.motion, wall.name
    if motion is None:
        return []
    if isinstance(motion, Constant):
        rate = number(float(np.dot(motion.velocity, wall.normal)))
        return [f"variable disp_{name} equal {rate}*step*dt", f"variable rate_{name} equal {rate}"]
    if isinstance(motion, Cosine):
        return _cosine_lines(system, name, motion)
    atom, axis = carrier_id(system, wall), "xyz"[carrier_axis(system)]
    return [
        f"# carried by atom {atom}: displacement = 2^20 = {number(CARRIER_SCALE)} times its coordinate; a power of two",
        "# rounds nothing, and the atom stays in the box wherever the wall goes",
        f"variable disp_{name} equal {number(CARRIER_SCALE)}*{axis}[{atom}]",
        f"variable rate_{name} equal {number(CARRIER_SCALE)}*v{axis}[{atom}]",
    ]


def loaded_wall_lines(system: System) -> list[str]:
    """Return the equations of motion of the walls that have a mass.

    They stand behind all `wall/gran/region` fixes, so that they see the contact forces of this step.
    """
    walls = loaded_walls(system)
    if not walls:
        return []
    lines = [
        "", "# walls with a mass: m d'' = load + stress*extent + F.n - damping*d', F of the grains;",
        f"# the atom that carries the wall gets this force over {number(CARRIER_SCALE)}, as its coordinate is",
    ]
    for wall in walls:
        lines += _loaded_lines(system, wall)
    return lines


def beyond_lines(system: System, every: int) -> list[str]:
    """Return the check that no grain's centre has passed a wall: LAMMPS would stop seeing the contact."""
    if not system.walls:
        return []
    inside = " - ".join(f"count(grains,plane_{w.name})" for w in system.walls)
    return [
        "",
        "# a grain whose centre is beyond a plane has no contact with it any more: stop",
        f'variable beyond equal "{len(system.walls)}*count(grains) - {inside}"',
        f"fix grain_beyond_wall all halt {every} v_beyond > 0 error hard",
    ]


def carrier_axis(system: System) -> int:
    """Return the axis along which carriers move: the first that does not wrap."""
    return next(a for a in range(system.dimension) if not is_periodic(system, a))


def force_sums(system: System, wall: Wall) -> list[str]:
    """Return the force components of the wall on the grains, one an axis."""
    return [_sum(f"c_F_{name}[{a + 1}]" for name, *_ in wall_laws(system, wall)) for a in range(system.dimension)]


def frame_columns(system: System) -> tuple[list[str], dict[str, str]]:
    """Return lines for a dump of the forces of walls on each grain, and its columns with the names they are to bear.

    A wall with several laws has a fix for each material; a grain is seen by one of them, and has zeros in the others.
    """
    lines, columns = [], {}
    for wall in system.walls:
        fixes = [name for name, *_ in wall_laws(system, wall)]
        for k in range(1, 2 + system.dimension):
            name = f"f_wall_{wall.name}[{k}]"
            given = name if len(fixes) == 1 else f"v_wall_{wall.name}_{k}"
            if given != name:
                terms = "+".join(f"f_wall_{fix}[{k}]" for fix in fixes)
                lines.append(f"variable wall_{wall.name}_{k} atom {terms}")
            columns[given] = name
    return lines, columns


def _sum(terms: Iterable[str]) -> str:
    terms = list(terms)
    return terms[0] if len(terms) == 1 else f"({'+'.join(terms)})"


def _cosine_lines(system: System, name: str, motion: Cosine) -> list[str]:
    """travel/2 (1 - cos(pi t/T)) = travel sin^2(pi t/2T), the form that does not cancel at small t."""
    half, end = number(motion.duration), number(motion.end)
    d = f"{number(motion.travel)}*sin(PI*step*dt/2/{half})^2"
    v = f"{number(motion.travel)}*PI/2/{half}*sin(PI*step*dt/{half})"
    if system.steps * system.dt > motion.end * (1 + 1e-12):
        d = f"(step*dt<{end})*{d}+(step*dt>={end})*{number(motion.rest)}"
        v = f"(step*dt<{end})*{v}"
    return [f'variable disp_{name} equal "{d}"', f'variable rate_{name} equal "{v}"']


def _region_line(system: System, wall: Wall) -> str:
    flat = " 0" if system.dimension == 2 else ""
    plane = f"region plane_{wall.name} plane {numbers(wall.point)}{flat} {numbers(wall.normal)}{flat} units box"
    if wall.motion is None:
        return plane
    axes = _direction(wall)
    moves = [f"variable move_{wall.name}_{a} equal {expr}" for a, expr in zip("xyz", axes, strict=False) if expr]
    names = [f"v_move_{wall.name}_{a}" if expr else "NULL" for a, expr in zip("xyz", axes, strict=False)]
    words = " ".join(names + ["NULL"] * (3 - len(names)))
    return "\n".join([*moves, f"{plane} move {words}"])


def _direction(wall: Wall) -> list[str]:
    """Return the displacement of the plane along each axis as an expression, "" where it is none."""
    if isinstance(wall.motion, Constant):
        return [f"{number(v)}*step*dt" if v else "" for v in wall.motion.velocity]
    return [f"{number(n)}*v_disp_{wall.name}" if n else "" for n in wall.normal]


def _contact_lines(system: System, wall: Wall) -> list[str]:
    lines = []
    for name, group, law in wall_laws(system, wall):
        sums = " ".join(f"f_wall_{name}[{a + 2}]" for a in range(system.dimension))
        lines += [
            f"fix wall_{name} {group} wall/gran/region granular {law} region plane_{wall.name} contacts",
            f"compute F_{name} {group} reduce sum {sums}",
        ]
    return lines


def _loaded_lines(system: System, wall: Wall) -> list[str]:
    name, motion = wall.name, wall.motion
    terms = [number(motion.load)] if motion.load else []
    lines = []
    if motion.span is not None and motion.stress:
        lines.append(f'variable extent_{name} equal "{_extent(system, motion)}"')
        terms.append(f"{number(motion.stress)}*v_extent_{name}")
    terms += [f"{number(-n)}*{s}" for n, s in zip(wall.normal, force_sums(system, wall), strict=True) if n]
    if motion.damping:
        terms.append(f"{number(-motion.damping)}*v_rate_{name}")
    force = " + ".join(terms)
    axes = ["0", "0", "0"]
    axes[carrier_axis(system)] = f"v_force_{name}"
    return [
        *lines,
        f'variable force_{name} equal "({force})/{number(CARRIER_SCALE)}"',
        f"group carrier_{name} id {carrier_id(system, wall)}",
        f"fix move_{name} carrier_{name} nve",
        f"fix force_{name} carrier_{name} setforce {' '.join(axes)}",
    ]


def _extent(system: System, motion: Loaded) -> str:
    """Return the distance of the two walls of the span: the initial one less what both moved in."""
    low, high = (system.wall(n) for n in motion.span)
    distance = abs(float(np.dot(np.subtract(high.point, low.point), low.normal)))
    return "".join([number(distance), *(f" - v_disp_{w.name}" for w in (low, high) if w.motion is not None)])
