"""Deck lines for output: series, frames, wall states, and restart files for the contacts.

Looking must not alter the run. Contacts are therefore never asked of the running instance (`compute
pair/local` cuts its springs); the run drops restart files and contacts.in opens clones of them.
`write_restart noinit` leaves the neighbour lists alone and `run ... pre no` continues without a set-up,
so that a run with contact output is the same, bit for bit, as one without.
"""

from __future__ import annotations

from harness.engines.family import MEAN_SPIN, rotation_lines
from harness.engines.glued import series_columns, series_lines
from harness.engines.lammps.files import STATE
from harness.engines.lammps.law import clone_stiffness, pair_law, springs_law
from harness.engines.lammps.materials import pair_coefficients
from harness.engines.lammps.walls import force_sums, frame_columns
from harness.engines.text import comment
from harness.scene.system import System

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
        f"write_restart {STATE}.0 noinit",
        f'run {system.steps} pre no post no every {system.frame_every} "write_restart {STATE}.* noinit"',
    ]


def contacts_deck(system: System, neighbours: list[str]) -> str:
    """Return contacts.in: for every restart file a clone whose contacts are written out.

    total: law and velocities as they are, so force = elastic + damping with full-step velocities.
    springs: v = w = 0 and unlimited friction, so the tangential force is -k u exactly.
    The pair style is given again, because pair granular does not restore its cutoffs from a restart
    file: they are whatever stood in memory, and contacts go missing. The springs are kept.
    """
    lines = [
        f"# contacts of {comment(system.scene_name)}, from the restart files of in.lammps",
        f"variable frame loop 0 {system.steps // system.frame_every}",
        "label next_frame",
        f"variable at equal ${{frame}}*{system.frame_every}",
        *_clone_lines(system, TOTAL, [*neighbours, "pair_style granular", *pair_coefficients(system, pair_law)]),
    ]
    if clone_stiffness(system) is not None:
        at_rest = ["velocity all set 0 0 0", "set group all omega 0 0 0"]
        settings = [*neighbours, "pair_style granular", f"pair_coeff * * {springs_law(system)}", *at_rest]
        lines += _clone_lines(system, SPRINGS, settings)
    return "\n".join([*lines, "", "next frame", "jump SELF next_frame", ""])


def _series_lines(system: System) -> list[str]:
    """Return the series, and in walls.dat the same columns at the frames."""
    walls = "; of every wall: displacement along its normal, rate, force of the grains on it" if system.walls else ""
    rings = "; of every ring: torque of the grains on it about its centre, force" if system.rings else ""
    lines = ["", f"# time{walls}{rings}", "variable time equal step*dt"]
    columns = {"time": "v_time"}
    for wall in system.walls:
        if wall.motion is not None:
            columns[f"{wall.name}_d"] = f"v_disp_{wall.name}"
            columns[f"{wall.name}_v"] = f"v_rate_{wall.name}"
        for axis, force in zip("xyz", force_sums(system, wall), strict=False):
            lines.append(f"variable f{axis}_{wall.name} equal -{force}")
            columns[f"{wall.name}_f{axis}"] = f"v_f{axis}_{wall.name}"
    lines += series_lines(system)
    columns |= series_columns(system)
    lines.append(_table_line("series", SERIES, system.sample_every, columns))
    if system.walls or system.rings:
        lines.append(_table_line("walls", WALLS, system.frame_every, columns))
    return lines


def _table_line(fix: str, file: str, every: int, columns: dict[str, str]) -> str:
    title = " ".join(["# step", *columns])
    return (
        f"fix {fix} all ave/time {every} 1 {every} {' '.join(columns.values())} &\n"
        f'    file {file} title1 "# {fix}" title2 "{title}" format " %.17g"'
    )


def _frame_lines(system: System) -> list[str]:
    flat = system.dimension == 2
    columns = "id xu yu vx vy omegaz" if flat else "id xu yu zu vx vy vz omegax omegay omegaz"
    made, names = frame_columns(system) if system.contacts else ([], {})
    more = " ".join([MEAN_SPIN, *names] if system.rotations else names)
    renamed = [f'dump_modify frames colname {given} "{name}"' for given, name in names.items() if given != name]
    return [
        *rotation_lines(system), *made,
        "",
        f"dump frames grains custom {system.frame_every} {FRAMES} {columns} radius mass {more}".rstrip(),
        "dump_modify frames sort id format float %.17g", *renamed,
    ]


def _clone_lines(system: System, file: str, settings: list[str]) -> list[str]:
    values = ["dist", "force"] if system.sliding is None else ["dist", "force", "p1", "p2", "p3"]
    columns = ["c_ids[1]", "c_ids[2]", *(f"c_pair[{k}]" for k in range(1, len(values) + 1))]
    return [
        "",
        "clear",
        "newton off",
        f"read_restart {STATE}.${{at}}",
        "comm_modify vel yes",
        "atom_modify sort 0 0",
        *settings,
        "compute ids all property/local patom1 patom2 cutoff radius",
        f"compute pair all pair/local {' '.join(values)} cutoff radius",
        f"dump contacts all local 1 {file} {' '.join(columns)}",
        'if "${frame} > 0" then "dump_modify contacts append yes"',
        "dump_modify contacts format float %.17g",
        "thermo_style custom step",
        "run 0 post no",
    ]
