"""Deck lines for output: series, frames, wall states, and restart files for the contacts.

Looking must not alter the run. Contacts are therefore never asked of the running instance (`compute
pair/local` cuts its springs); the run drops restart files and contacts.in opens clones of them.
`write_restart noinit` leaves the neighbour lists alone and `run ... pre no` continues without a set-up,
so that a run with contact output is the same, bit for bit, as one without.
"""

from __future__ import annotations

from harness.engines.lammps.law import NO_LIMIT, contact_law
from harness.engines.lammps.text import comment
from harness.engines.lammps.walls import force_sums
from harness.scene.system import System, Wall

SERIES, WALLS, FRAMES = "series.dat", "walls.dat", "frames.dump"
TOTAL, SPRINGS = "contacts.total.dump", "contacts.springs.dump"


def check_interval(system: System) -> int:
    """Return how often LAMMPS counts its atoms, in steps: about a hundred times a run."""
    return max(1, system.steps // 100)


def output_lines(system: System) -> list[str]:
    """Return thermo, series and frames."""
    every = check_interval(system)
    return [
        "",
        "# lost atoms are seen when this prints",
        f"thermo {every}",
        "thermo_style custom step atoms",
        "thermo_modify lost error flush yes",
        *_series_lines(system),
        *_frame_lines(system),
    ]


def run_lines(system: System) -> list[str]:
    """Return the run; with contact output it leaves one restart file a frame."""
    if not system.contacts:
        return ["", f"run {system.steps}"]
    return [
        "",
        "# one restart file a frame for contacts.in, written without disturbing the run",
        "run 0 post no",
        "write_restart state.0 noinit",
        f'run {system.steps} pre no post no every {system.frame_every} "write_restart state.* noinit"',
    ]


def contacts_deck(system: System, neighbours: list[str]) -> str:
    """Return contacts.in: for every restart file a clone whose contacts are written out.

    total: law and velocities as they are, so force = elastic + damping with full-step velocities.
    springs: v = w = 0 and unlimited friction, so the tangential force is -k_t u exactly.
    The law is given again because pair granular does not restore its cutoffs from a restart file.
    """
    law = contact_law(system.normal, system.sliding)
    lines = [
        f"# contacts of {comment(system.scene_name)}, from the restart files of in.lammps",
        f"variable frame loop 0 {system.steps // system.frame_every}",
        "label next_frame",
        f"variable at equal ${{frame}}*{system.frame_every}",
        *_clone_lines(system, TOTAL, [*neighbours, f"pair_coeff * * {law}"]),
    ]
    if system.sliding is not None:
        no_slip = contact_law(system.normal, system.sliding, friction=NO_LIMIT)
        at_rest = [f"pair_coeff * * {no_slip}", "velocity all set 0 0 0", "set group all omega 0 0 0"]
        lines += _clone_lines(system, SPRINGS, [*neighbours, *at_rest])
    return "\n".join([*lines, "", "next frame", "jump SELF next_frame", ""])


def wall_columns(wall: Wall, dimension: int) -> list[str]:
    """Return the names of a wall's columns in series.dat and walls.dat."""
    moving = ["d", "v"] if wall.motion is not None else []
    return [f"{wall.name}_{c}" for c in [*moving, *(f"f{a}" for a in "xyz"[:dimension])]]


def _series_lines(system: System) -> list[str]:
    if not system.walls:
        return []
    lines = ["", "# of every wall: displacement along its normal, rate, force of the grains on it"]
    values: list[str] = []
    for wall in system.walls:
        if wall.motion is not None:
            values += [f"v_disp_{wall.name}", f"v_rate_{wall.name}"]
        for axis, force in zip("xyz", force_sums(system, wall), strict=False):
            lines.append(f"variable f{axis}_{wall.name} equal -{force}")
            values.append(f"v_f{axis}_{wall.name}")
    title = " ".join(["# step", *(c for w in system.walls for c in wall_columns(w, system.dimension))])
    for fix, file, every in (("series", SERIES, system.sample_every), ("walls", WALLS, system.frame_every)):
        lines.append(
            f"fix {fix} all ave/time {every} 1 {every} {' '.join(values)} &\n"
            f'    file {file} title1 "# walls" title2 "{title}" format " %.17g"'
        )
    return lines


def _frame_lines(system: System) -> list[str]:
    flat = system.dimension == 2
    columns = "id xu yu vx vy omegaz" if flat else "id xu yu zu vx vy vz omegax omegay omegaz"
    walls = [
        f"f_wall_{w.name}[{k}]" for w in system.walls for k in range(1, 2 + system.dimension)
    ] if system.contacts else []
    return [
        "",
        f"dump frames grains custom {system.frame_every} {FRAMES} {columns} radius mass {' '.join(walls)}".rstrip(),
        "dump_modify frames sort id format float %.17g",
    ]


def _clone_lines(system: System, file: str, settings: list[str]) -> list[str]:
    values = "c_pair[1]" + "".join(f" c_pair[{k}]" for k in (2, 3, 4) if system.sliding is not None)
    shear = " p1 p2 p3" if system.sliding is not None else ""
    return [
        "",
        "clear",
        "newton off",
        "read_restart state.${at}",
        "comm_modify vel yes",
        "atom_modify sort 0 0",
        *settings,
        "compute ids all property/local patom1 patom2 cutoff radius",
        f"compute pair all pair/local force{shear} cutoff radius",
        f"dump contacts all local 1 {file} c_ids[1] c_ids[2] {values}",
        'if "${frame} > 0" then "dump_modify contacts append yes"',
        "dump_modify contacts format float %.17g",
        "run 0 post no",
    ]
