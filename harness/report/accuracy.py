"""The accuracy report: a page, a picture, and the same numbers as CSV and JSON."""

from __future__ import annotations

import shlex
from pathlib import Path
from typing import TYPE_CHECKING

from harness.report.accuracy_figure import accuracy_figure, caption
from harness.report.accuracy_tables import tables
from harness.report.accuracy_words import paragraph
from harness.report.files import Names, Written, write_files
from harness.report.page import Figure, Section
from harness.report.tables import Answer

if TYPE_CHECKING:
    from harness.studies.accuracy.study import Accuracy

NAMES = Names(stem="accuracy", tables=("budget", "slopes", "front", "points", "costs", "oracles"))

BUDGET_NOTE = (
    "The largest step from which on an engine stays below the error on all rungs, and of these the cheapest; only runs "
    "that passed their checks have a time, and only steps that `grainproof scene` takes are named. What it gives up: "
    "the other errors of that setting, and what comes with it. dt_fraction is that of the step that ran: so many whole "
    "steps make the duration, which a rung of few steps feels."
)
SLOPE_NOTE = (
    "Slope: the order p in error ~ dt^p by least squares over the rungs of at least 25 steps a contact whose error is "
    "above five times that of the oracle, at least three of them, with one standard error: scatter about the line and "
    "phases drawn again. Where there is none, or it is known too badly to be told, the last column says why."
)
COST_NOTE = (
    "CPU time of a step: all steps of one rung in a timing session, without set-up and output, median of repeats in "
    "which the engines take turns on one core. It is that of all copies of the scene together, which run side by side; "
    "times of a rung are steps times it. The whole process also starts, reads and writes."
)
ORACLE_NOTE = (
    "Every engine is held against the limit of its own laws as dt tends to 0, so that its error is that of the step "
    "alone. The last column says how far that limit is from that of the talks' laws. Growth: change of the exit, over "
    "the speed, by a displacement of the start, over the radius; chaos sets the limit where it is large."
)
FRONT_NOTE = "No other setting of any engine is both faster and better, of those that `grainproof scene` takes."
POINT_NOTE = (
    "Errors over the largest relative speed at the start; exit: velocity and spin times radius together. rung: "
    "dt_fraction as asked for; dt_fraction: of the step that ran. Steps beyond the scene's limit are measured to show "
    "where things break; `scene` and `run` refuse them."
)
SCHEMA = "grainproof accuracy of free bodies, 2"


def accuracy_answer(accuracy: Accuracy) -> Answer:
    """Return the main tables for people and everything for programs."""
    found = tables(accuracy)
    shown = {"Cheapest settings": found["budget"], "Orders": found["slopes"], "Times": found["costs"]}
    return Answer(tables=shown, data=accuracy_data(accuracy))


def accuracy_data(accuracy: Accuracy) -> dict:
    """Return all tables with all digits, the errors of every phase, scene and machine."""
    from msgspec import to_builtins

    return {
        "schema": SCHEMA, "scene_file": accuracy.scene_file.name, "scene": to_builtins(accuracy.scene),
        "knob": accuracy.asked.knob.name, "ladder": list(accuracy.asked.values), "quantity": accuracy.asked.quantity,
        "phases": accuracy.phases, "contact_time": accuracy.contact_time, "exit_status": accuracy.exit_status,
        "words": paragraph(accuracy), "host": to_builtins(accuracy.host), "wall_seconds": accuracy.wall_seconds,
        "own_seconds": accuracy.own_seconds, "tables": tables(accuracy),
        "errors": [
            {"case": t.case, "engine": t.engine, "rung": p.rung, "dt_fraction": p.value, **p.errors}
            for t in accuracy.tracks for p in t.points if p.good
        ],
    }


def write_accuracy(accuracy: Accuracy, out: Path) -> Path:
    """Write accuracy.html, .json, .png, .svg and CSV tables into `out`, each whole or not at all; return the page."""
    return write_files(out, NAMES, Written(
        title=f"What accuracy costs: {accuracy.scene.title}", lead=f"{summary(accuracy)}.", caption=caption(accuracy),
        figure=accuracy_figure(accuracy), tables=tables(accuracy), data=accuracy_data(accuracy),
        sections=lambda figures: _sections(accuracy, figures, out),
    ))


def summary(accuracy: Accuracy) -> str:
    """Return one line: what was turned, how far, on whom."""
    values, engines = accuracy.asked.values, list(dict.fromkeys(t.engine for t in accuracy.tracks))
    return (
        f"{accuracy.asked.knob.value} from {max(values):g} to {min(values):g} in {len(values)} rungs; "
        f"{accuracy.phases} copies of {accuracy.bodies} bodies, whose contacts begin at as many phases of a step, side "
        f"by side in one run; {', '.join(engines)}"
    )


def _sections(accuracy: Accuracy, figures: tuple[Figure, ...], out: Path) -> list[Section]:
    found = tables(accuracy)
    return [
        Section(heading="In words", note=paragraph(accuracy)),
        Section(heading="Error against time", figures=figures),
        Section(heading="Cheapest settings", note=BUDGET_NOTE, rows=found["budget"]),
        Section(heading="Orders", note=SLOPE_NOTE, rows=found["slopes"]),
        Section(heading="Front", note=FRONT_NOTE, rows=found["front"]),
        Section(heading="Times", note=COST_NOTE, rows=found["costs"]),
        Section(heading="Oracles", note=ORACLE_NOTE, rows=found["oracles"]),
        Section(heading="All rungs", note=POINT_NOTE, rows=found["points"]),
        Section(heading="Reproduce", text=_command(accuracy, out)),
    ]


def _command(accuracy: Accuracy, out: Path) -> str:
    engines = ",".join(dict.fromkeys(t.engine for t in accuracy.tracks))
    ladder = ",".join(f"{v:g}" for v in accuracy.asked.values)
    return shlex.join([
        "grainproof", "accuracy", str(accuracy.scene_file), "--knob", accuracy.asked.knob.name, "--ladder", ladder,
        "--engines", engines, "--quantity", accuracy.asked.quantity, "--phases", str(accuracy.phases),
        "--out", str(out),
    ])

