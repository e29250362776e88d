"""What lies in a results folder: runs by outcome, with their size, and what could go."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from pathlib import Path

from harness.errors import InputError
from harness.report.compare import DATA
from harness.report.tables import Answer
from harness.runs.folder import runs_root
from harness.runs.survey import Kept, remove, survey


def status_answer(out: Path) -> Answer:
    """Return every run below `out`, and how many there are of each state. Raises InputError without runs."""
    runs = surveyed(out)
    totals = [
        {"state": state, "runs": number, "size (MB)": _megabytes(r for r in runs if r.state == state)}
        for state, number in Counter(r.state for r in runs).items()
    ]
    return Answer(tables={"Runs": rows(runs), "In all": totals}, data={"runs": rows(runs), "totals": totals})


def clean_answer(out: Path, *, really: bool) -> Answer:
    """Return the runs that are needless; delete them if `really`. Raises InputError without runs."""
    needless = [r for r in surveyed(out) if r.needless]
    gone = remove(needless) if really else []
    title = "Deleted" if really else "Would be deleted, with --yes"
    shown = rows(gone if really else needless)
    return Answer(tables={title: shown}, data={"deleted" if really else "needless": shown})


def surveyed(out: Path) -> list[Kept]:
    """Return the runs below `out`. Raises InputError if there is no folder of runs."""
    root = runs_root(out)
    if not root.is_dir():
        raise InputError(file=out, expected="a results folder, with runs in it", got="no folder 'runs' there")
    return survey(root, out / DATA)


def rows(runs: Sequence[Kept]) -> list[dict]:
    """One row a run."""
    return [
        {"run": r.folder.name, "state": r.state, "size (MB)": _megabytes([r]),
         "in the report": {None: None, True: "yes", False: "no"}[r.shown], "could go": r.needless or None,
         "note": r.note or None}
        for r in runs
    ]


def _megabytes(runs) -> float:
    return sum(r.size for r in runs) / 1e6
