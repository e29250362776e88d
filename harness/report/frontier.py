"""The frontier report: a page, a picture, CSV and JSON, and on demand the table that scenes are warned with."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from harness.report.files import Names, Written, write_files
from harness.report.frontier_figure import CAPTION, frontier_figure
from harness.report.frontier_tables import summary, tables
from harness.report.page import Figure, Section
from harness.report.tables import Answer
from harness.studies.frontier.late import LATE_STEPS, VISIBLE
from harness.studies.frontier.probe import AMPLITUDE, FRAMES, STEPS
from harness.studies.frontier.rest import BALANCED

if TYPE_CHECKING:
    from harness.studies.frontier.study import Frontiers

NAMES = Names(stem="frontier", tables=("frontiers", "map", "scenes", "skipped"), before="frontier_")


def _plain(small: float) -> str:
    """1e-5, not 1e-05."""
    return f"{small:g}".replace("e-0", "e-")


HOW = (
    f"Particles at rest under pressure get random velocities of {_plain(AMPLITUDE)} of their overlaps times the "
    "frequency, so that no contact opens or slides: motions are linear. Below the limit the kinetic energy of "
    f"velocity Verlet never exceeds its start; a step is unstable when it grows fourfold in one of {FRAMES} frames "
    f"of {STEPS} steps, or the code breaks off. Two steps 3 per cent around what theory expects are looked at "
    "first, further ones outwards until the limit is enclosed, then the bracket is halved to 1 per cent. Every "
    f"packing is at rest under the very law: no net force is above {_plain(BALANCED)} of the mean contact force "
    "(under Hertz's law random discs are moved until that holds), and no eigenvalue of M^-1 K is below 0. Others "
    "are left out."
)
EXACT = (
    "4 M - 2 dt C - dt^2 K must be positive definite, with mass, damping and stiffness matrix of the actual "
    "packing (dt < 2/w_max without dashpots). kernel:talk feels its tangential, rolling and torsion springs one "
    "step late, which is a dashpot of -dt k: C - dt K_late must not let motions grow either, and without any "
    "dashpot no step is stable. These motions grow slowly. They are followed for as many steps as theory needs to "
    f"let their energy grow by {VISIBLE:.0f}, {STEPS} at least, {LATE_STEPS} at most. kernel:talk knows of it, and "
    "does not begin, or breaks off, where it expects or sees that: the tables say which. Refusals below the limit "
    "of theory are no measurement, and are not compared."
)
MAP = "The random packing with one property varied; friction changes nothing as long as nothing slides."
SCENES = (
    "Of each kind of laws the smallest measured step over the formula beyond which scenes are refused: "
    "`grainproof scene` warns by it."
)


def frontier_answer(done: Frontiers) -> Answer:
    """Return the tables for people and everything for programs."""
    found = tables(done)
    shown = {"Largest stable steps, in sqrt(m/k)": found["frontiers"], "Map": found["map"]}
    return Answer(tables={k: _short(v) for k, v in shown.items()}, data=frontier_data(done))


def frontier_data(done: Frontiers) -> dict:
    """Return all tables with all digits, versions and machine."""
    from msgspec import to_builtins

    return {
        "size": done.size, "words": summary(done), "exit_status": done.exit_status, "versions": done.versions,
        "host": to_builtins(done.host), "wall_seconds": done.wall_seconds, "tables": tables(done),
    }


def write_frontier(done: Frontiers, out: Path) -> Path:
    """Write frontier.html, .json, .png, .svg and CSV tables into `out`, each whole or not at all; return the page."""
    return write_files(out, NAMES, Written(
        title="The largest stable time step", lead=f"{summary(done)}.", caption=CAPTION, figure=frontier_figure(done),
        tables=tables(done), data=frontier_data(done), sections=lambda figures: frontier_sections(done, figures),
    ))


def frontier_sections(done: Frontiers, figures: tuple[Figure, ...]) -> list[Section]:
    """Return the sections, for a page of its own or as part of another."""
    found = tables(done)
    sections = [
        Section(heading="Frontiers", note=f"{HOW} {EXACT}", figures=figures),
        Section(heading="Laws and packings", rows=found["frontiers"]),
        Section(heading="Map", note=MAP, rows=found["map"]),
        Section(heading="What scenes are held against", note=SCENES, rows=found["scenes"]),
        Section(heading="Left out", rows=found["skipped"]),
        Section(heading="Reproduce", text=command(done)),
    ]
    return [s for s in sections if s.rows != []]


def write_scene_table(done: Frontiers, path: Path, *, day: str) -> None:
    """Write the table that `harness.scene.frontier` reads, as TOML; day: of the measurement, YYYY-MM-DD."""
    from harness.runs.atomic import write_text_atomic

    lines = [
        "# The largest stable steps measured, over the formula beyond which scenes are refused: one entry for each",
        "# dimension, kind of laws and engine. Made by the command below; read by `grainproof scene`.",
        f'command = "{command(done)} --table FILE"', f'date = "{day}"', "",
        "[versions]", *(f'"{name}" = "{version}"' for name, version in done.versions.items()),
    ]
    for row in tables(done)["scenes"]:
        lines += ["", "[[measured]]", *(f"{key} = {_toml(value)}" for key, value in row.items() if value is not None)]
    write_text_atomic(path, "\n".join(lines) + "\n")


def command(done: Frontiers) -> str:
    """Return the command that measures this again."""
    size = " --full" if done.size == "full" else ""
    return f"grainproof frontier{size} --engines {','.join(done.versions)}"


def _short(rows: list[dict]) -> list[dict]:
    """Leave out what a terminal has no room for."""
    dropped = ("particles", "contacts", "sqrt(m/k) (s)", "runs", "beyond")
    return [{k: v for k, v in row.items() if k not in dropped} for row in rows]


def _toml(value: object) -> str:
    return f"{value:.4g}" if isinstance(value, float) else f'"{value}"' if isinstance(value, str) else str(value)
