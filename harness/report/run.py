"""What one run says: its outcome, and for free scenes the trajectory and exit values as CSV."""

from __future__ import annotations

from typing import TYPE_CHECKING

from harness.report.free import collision_table, exit_table
from harness.report.tables import csv_text
from harness.scene.model import Free

if TYPE_CHECKING:
    from harness.studies.single import SingleRun


def write_run_tables(run: SingleRun) -> tuple[dict[str, list[dict]], dict[str, str]]:
    """Return tables and titles for the terminal; a completed free run leaves CSV files in its folder."""
    from harness.runs.outcome import describe_outcome

    tables = {"run": [{"engine": run.engine, "outcome": run.outcome.status, "what": describe_outcome(run.outcome),
                       "folder": str(run.folder)}]}
    titles = {"run": "Run"}
    if run.trajectory is None or not isinstance(run.scene, Free):
        return tables, titles
    return tables | _free_tables(run), titles | {"exits": "Exit values", "collisions": "Collisions"}


def _free_tables(run: SingleRun) -> dict[str, list[dict]]:
    from harness.runs.atomic import write_text_atomic
    from harness.studies.compare.exits import exit_values

    exits = exit_values(run.trajectory, run.system)
    tables = {"exits": exit_table(run.engine, exits, run.system), "collisions": collision_table(run.engine, exits)}
    for name, rows in (tables | {"trajectory": trajectory_table(run)}).items():
        write_text_atomic(run.folder / f"{name}.csv", csv_text(rows))
    return tables


def trajectory_table(run: SingleRun) -> list[dict]:
    """One row a frame and body: time and every recorded column."""
    return [
        {"time": frame.time, **{name: float(values[k]) for name, values in frame.particles.items()}}
        for frame in run.trajectory for k in range(frame.particles.rows)
    ]
