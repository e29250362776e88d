"""What one run says: its outcome, and for free scenes the trajectory and exit values as CSV and JSON."""

from __future__ import annotations

from typing import TYPE_CHECKING

from harness.report.free import collision_table, exit_table
from harness.report.tables import Answer, csv_text
from harness.report.watch import REMARKS
from harness.scene.model import Free
from postproc.results import headed

if TYPE_CHECKING:
    from harness.studies.single import SingleRun

TITLES = {"run": "Run", "exits": "Exit values", "collisions": "Collisions", "watch": "Watch", "remarks": REMARKS}
"""What is shown to people; the trajectory is in the files only."""


UNITS = {
    "id": "1", "radius": "m", "mass": "kg", "inertia": "kg m^2", "rotation": "rad",
    **dict.fromkeys("xyz", "m"), **{f"v{a}": "m/s" for a in "xyz"}, **{f"w{a}": "rad/s" for a in "xyz"},
}
"""Of the particles' columns."""


def run_answer(run: SingleRun) -> Answer:
    """Return what became of the run; of a completed free one also exit values, collisions, trajectory."""
    tables = {"run": [run_row(run)]}
    if run.trajectory is not None and isinstance(run.scene, Free):
        tables |= free_tables(run)
    if run.watch is not None:
        tables |= {"watch": run.watch.rows(), "remarks": run.watch.remark_rows()}
    shown = {title: tables[name] for name, title in TITLES.items() if name in tables}
    return Answer(tables=shown, data=tables)


def write_run_files(run: SingleRun) -> None:
    """Leave exits.csv, collisions.csv and trajectory.csv in the folder of a completed free run, a page if watched."""
    from harness.runs.atomic import write_text_atomic

    if run.watch is not None and run.folder.exists():
        write_text_atomic(run.folder / WATCH_PAGE, _watch_page(run))

    if run.trajectory is not None and isinstance(run.scene, Free):
        for name, rows in free_tables(run).items():
            write_text_atomic(run.folder / f"{name}.csv", csv_text(rows))


WATCH_PAGE = "watch.html"


def _watch_page(run: SingleRun) -> str:
    from harness.report.page import Section, render_page
    from harness.report.watch import NOTE, REMARKS_NOTE, energy_panel
    from harness.runs.outcome import describe_outcome

    figures = (energy_panel(run.engine, run.watch),) if run.watch.of_frames else ()
    return render_page(
        title=f"Watched: {run.scene.title}", lead=describe_outcome(run.outcome),
        sections=[
            Section(heading=REMARKS, note=REMARKS_NOTE, rows=run.watch.remark_rows()),
            Section(heading="Watch", note=NOTE, rows=run.watch.rows(), figures=figures),
        ],
    )


def run_row(run: SingleRun) -> dict:
    """How the run ended, and where it is if something was run."""
    from harness.runs.outcome import describe_outcome

    return {
        "engine": run.engine, "status": run.outcome.status, "what": describe_outcome(run.outcome),
        "folder": str(run.folder) if run.folder.exists() else None,
    }


def free_tables(run: SingleRun) -> dict[str, list[dict]]:
    """Rows by table name."""
    from harness.studies.compare.exits import exit_values

    exits = exit_values(run.trajectory, run.system)
    return {
        "exits": exit_table(run.engine, exits, run.system), "collisions": collision_table(run.engine, exits),
        "trajectory": trajectory_table(run),
    }


def trajectory_table(run: SingleRun) -> list[dict]:
    """One row a frame and body: time and every recorded column."""
    return [
        {"time (s)": frame.time,
         **{headed(name, UNITS[name]): _plain(name, values[k]) for name, values in frame.particles.items()}}
        for frame in run.trajectory for k in range(frame.particles.rows)
    ]


def _plain(name: str, value: float) -> int | float:
    """Return a number for JSON and CSV: names of bodies are whole."""
    return int(value) if name == "id" else float(value)
