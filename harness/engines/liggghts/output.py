"""What the run leaves behind: the series of the walls, particles, contacts. All with 17 digits.

`fix ave/time` of this version prints 6 digits, so the series is the thermodynamic output, in a file
of its own (`thermo_log`). Its total kinetic energy is only looked at for NaN.
"""

from __future__ import annotations

from harness.engines import glued
from harness.engines.facts import is_rough
from harness.engines.family import MEAN_SPIN, rotation_lines
from harness.engines.liggghts.law import told_history
from harness.engines.liggghts.motions import displacement, force, mesh_force, rate
from harness.engines.liggghts.planes import is_still, meshes, primitives
from harness.engines.liggghts.walls import shares_are_unclear
from harness.scene.system import Loaded, System, Wall

SERIES, PARTICLES, CONTACTS, MESH_CONTACTS = "series.txt", "particles.dump", "contacts.dump", "mesh_contacts.dump"


def contact_computes(system: System) -> list[str]:
    """Return the computes of contacts; LIGGGHTS wants them before the first run."""
    if not system.contacts:
        return []
    lines = ["", "# contacts, evaluated again from full-step velocities, which changes nothing"]
    history = " history" if told_history(system) else ""
    bodies = "all" if system.rings else "grains"
    lines.append(f"compute pairs {bodies} pair/gran/local id force{history} delta")
    if meshes(system) and shares_are_unclear(system):
        kept = history if _any_rough_mesh(system) else ""
        lines.append(f"compute shares grains wall/gran/local id force{kept} delta")
    return lines


def series_lines(system: System) -> list[str]:
    """Return the series: displacement and rate of moving walls, force of the particles on every wall."""
    lines = ["", "# series of the walls", *glued.series_lines(system)]
    for wall in system.walls:
        lines += _wall_lines(system, wall)
    columns = [f"v_{c}" for w in system.walls for c in wall_columns(system, w)]
    columns += glued.series_columns(system).values()
    return [
        *lines, "compute motion grains ke",
        f"thermo_style custom step atoms c_motion {' '.join(columns)}".rstrip(),
        'thermo_modify lost error flush yes format float "%.17g "',
        f"thermo_log {SERIES}", *_schedule(system),
    ]


def wall_columns(system: System, wall: Wall) -> list[str]:
    """Return the names of a wall's columns in the series file."""
    moves = [] if is_still(wall) else ["d", "v"]
    return [f"{wall.name}_{c}" for c in (*moves, *(f"f{a}" for a in "xyz"[: system.dimension]))]


def frame_lines(system: System) -> list[str]:
    """Return the dumps. Particles come first: wall/gran/local clears the wall forces on the particles."""
    lines = rotation_lines(system)
    lines += ["", "# frames", *_dump("particles", "grains custom", system, PARTICLES, _particle_columns(system))]
    lines.append("dump_modify particles sort id")
    if system.contacts:
        told = len(told_history(system))
        lines += _dump("contacts", "grains local", system, CONTACTS, _local("pairs", 7 + told))
    if system.contacts and meshes(system) and shares_are_unclear(system):
        told = len(told_history(system)) if _any_rough_mesh(system) else 0
        lines += _dump("shares", "grains local", system, MESH_CONTACTS, _local("shares", 7 + told))
    return lines


def _any_rough_mesh(system: System) -> bool:
    return any(is_rough(system, w) for w in meshes(system))


def _wall_lines(system: System, wall: Wall) -> list[str]:
    name, axes = wall.name, "xyz"[: system.dimension]
    lines = []
    if isinstance(wall.motion, Loaded):
        lines.append(f'variable {name}_force equal "{force(system, wall)}"')
    if not is_still(wall):
        lines.append(f'variable {name}_d equal "{displacement(system, wall)}"')
        lines.append(f'variable {name}_v equal "{rate(system, wall)}"')
    if wall in primitives(system):
        columns = " ".join(f"f_force_{name}_plane[{k + 1}]" for k in range(len(axes)))
        lines.append(f"compute {name}_sum grains reduce sum {columns}")
        return lines + [f"variable {name}_f{a} equal -c_{name}_sum[{k + 1}]" for k, a in enumerate(axes)]
    return lines + [f'variable {name}_f{a} equal "{mesh_force(wall, k)}"' for k, a in enumerate(axes)]


def _schedule(system: System) -> list[str]:
    """Return when to print: at samples, and at frames too if these fall between samples."""
    if system.frame_every % system.sample_every == 0:
        return [f"thermo {system.sample_every}"]
    end = system.steps
    return [
        f"variable sample equal stride(0,{end},{system.sample_every})",
        f"variable frame equal stride(0,{end},{system.frame_every})",
        'variable row equal "(v_sample<=v_frame)*v_sample+(v_sample>v_frame)*v_frame"',
        "thermo v_row",
    ]


def _dump(name: str, what: str, system: System, file: str, columns: list[str]) -> list[str]:
    """Return a dump of whole frames with 17 digits; ids print as they are."""
    formats = " ".join("%d" if c == "id" else "%.17g" for c in columns)
    return [
        f"dump {name} {what} {system.frame_every} {file} {' '.join(columns)}",
        f'dump_modify {name} format "{formats}"',
    ]


def _local(compute: str, count: int) -> list[str]:
    return [f"c_{compute}[{k + 1}]" for k in range(count)]


def _particle_columns(system: System) -> list[str]:
    """Return id, position (unwrapped where an axis is periodic), motion, size, forces and springs at walls."""
    axes = "xyz"[: system.dimension]
    unwrapped = "u" if system.periodic is not None else ""
    spins = "z" if system.dimension == 2 else "xyz"
    columns = ["id", *(a + unwrapped for a in axes), *("v" + a for a in axes), *("omega" + a for a in spins),
               "radius", "mass", *([MEAN_SPIN] if system.rotations else [])]
    if not system.contacts:
        return columns
    for wall in primitives(system):
        columns += [f"f_force_{wall.name}_plane[{k + 1}]" for k in range(len(axes))]
        if is_rough(system, wall) and told_history(system):
            first = told_history(system).index("ux") + 1
            columns += [f"f_history_{wall.name}_plane[{first + k}]" for k in range(len(axes))]
    if meshes(system):
        columns += [f"f_force_meshes[{k + 1}]" for k in range(len(axes))]
    return columns
