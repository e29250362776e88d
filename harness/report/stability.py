"""The report of the gauntlet: a page, a picture, and the same numbers as CSV and JSON."""

from __future__ import annotations

import shlex
from pathlib import Path
from typing import TYPE_CHECKING

from harness.report.files import Names, Written, write_files
from harness.report.page import Entry, Figure, Section
from harness.report.stability_figure import CAPTION, stability_figure
from harness.report.stability_tables import TABLES, count_rows, outcome_matrix, outcome_table, tables
from harness.report.tables import Answer

if TYPE_CHECKING:
    from harness.studies.stability.cases import Case
    from harness.studies.stability.judge import Result
    from harness.studies.stability.study import Stability

NAMES = Names(stem="stability", tables=TABLES)

MATRIX_NOTE = (
    "Stable: every invariant held. Degraded: one is beyond its tolerance, and the answer still means something. "
    "Failed loudly: the code stopped and said why. Failed silently: the code ended as if all were well, and it was "
    "not; the harness found it. Timed out: the harness ended it at the time limit, and nothing is known of the rest. "
    "Refused: the scene is turned down before anything runs. Unsupported: the code has not the law. Beside the word "
    "stands the invariant that used most of its tolerance."
)
SILENT_NOTE = "These runs ended with status 0 and no message. What they leave behind must not be used."
INVARIANT_NOTE = (
    "Computed from the recorded trajectories, not by the codes. Formulas and sources stand with the functions in "
    "harness/studies/stability/invariants.py."
)


def stability_answer(stability: Stability) -> Answer:
    """Return the tables for people and everything for programs."""
    shown = {"How each case ended": outcome_table(stability), "Count": count_rows(stability)}
    return Answer(tables=shown, data=stability_data(stability))


def stability_data(stability: Stability) -> dict:
    """Return all tables with all digits, and the machine."""
    from msgspec import to_builtins

    return {
        "exit_status": stability.exit_status, "engines": list(stability.engines), "host": to_builtins(stability.host),
        "wall_seconds": stability.wall_seconds, "surprises": [[r.case, r.engine] for r in stability.surprises],
        "tables": tables(stability),
    }


def case_list(cases: tuple[Case, ...]) -> Answer:
    """Return what `--list` shows: the cases, what they stand for and why they are hard."""
    rows = [
        {
            "case": c.name, "set": "long" if c.expect.long else "standard", "topics": ", ".join(c.expect.topics),
            "title": c.title,
        }
        for c in cases
    ]
    return Answer(tables={"Hard cases": rows}, data={"cases": rows})


def write_stability(stability: Stability, out: Path) -> Path:
    """Write stability.html, .json, .png, .svg and CSV tables into `out`, each whole or not at all; return the page."""
    return write_files(out, NAMES, Written(
        title="Hard cases: stable, or failing loudly?", lead=f"{summary(stability)}.", caption=CAPTION,
        figure=stability_figure(stability), tables=tables(stability), data=stability_data(stability),
        sections=lambda figures: _sections(stability, figures, out),
    ))


def summary(stability: Stability) -> str:
    """Return one line: how many cases, how many ended otherwise than declared, how many silently."""
    silent = sum(r.ended == "failed_silently" for r in stability.results)
    other = len(stability.surprises)
    late = sum(r.ended == "timed_out" for r in stability.results)
    return (
        f"{len(stability.cases)} hard case{'s' * (len(stability.cases) != 1)} on {', '.join(stability.engines)}: "
        f"{'all ended as declared' if not other else f'{other} ended otherwise than declared'}; "
        f"{_runs(silent)} failed without a word of the code"
        f"{f'; {_runs(late)} met the time limit' if late else ''}"
    )


def _runs(count: int) -> str:
    return "no run" if not count else "one run" if count == 1 else f"{count} runs"


def _sections(stability: Stability, figures: tuple[Figure, ...], out: Path) -> list[Section]:
    found = tables(stability)
    silent = tuple(_entry(r) for r in stability.results if r.ended == "failed_silently")
    surprising = tuple(_entry(r) for r in stability.surprises if r.ended != "failed_silently")
    sections = [Section(heading="Count", rows=count_rows(stability))]
    if surprising:
        sections.append(Section(heading="Not as declared", entries=surprising))
    if silent:
        sections.append(Section(heading="Failed silently", note=SILENT_NOTE, entries=silent))
    return [
        *sections,
        Section(heading="Outcomes", note=MATRIX_NOTE, matrices=(outcome_matrix(stability),)),
        Section(heading="At a glance", figures=figures),
        Section(heading="Why", rows=[_why(r) for r in stability.results if r.reason and r.ended != "refused"]),
        Section(heading="Cases", rows=found["cases"]),
        Section(heading="Invariants", note=INVARIANT_NOTE, rows=found["invariants"]),
        Section(heading="Reproduce", text=_command(stability, out)),
    ]


def _entry(result: Result) -> Entry:
    known = f" Declared so: {result.known}" if result.as_declared and result.known else ""
    return Entry(
        word=result.ended, title=f"{result.case} on {result.engine}", why=f"{result.reason}.{known}",
        command=result.reproduce,
    )


def _why(result: Result) -> dict:
    return {
        "case": result.case, "engine": result.engine, "outcome": result.ended.replace("_", " "),
        "reason": result.reason,
        "declared because": result.known,
    }


def _command(stability: Stability, out: Path) -> str:
    names = [c.name for c in stability.cases]
    return shlex.join(["grainproof", "stability", *names, "--engines", ",".join(stability.engines), "--out", str(out)])
