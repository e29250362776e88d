"""The accuracy report of boxes and rings: a page, a picture, and the same numbers as CSV and JSON."""

from __future__ import annotations

import shlex
from pathlib import Path
from typing import TYPE_CHECKING

from harness.report.accuracy_bulk_figure import BULK_CAPTION, bulk_figure
from harness.report.accuracy_bulk_tables import bulk_tables, data_rows, shown_budget
from harness.report.accuracy_bulk_words import bulk_paragraph, what
from harness.report.files import Names, Written, write_files
from harness.report.page import Section
from harness.report.tables import Answer
from harness.studies.accuracy.bulk_quantities import BULK
from harness.studies.accuracy.shaken import HOT, UNBALANCED

if TYPE_CHECKING:
    from harness.report.page import Figure
    from harness.studies.accuracy.bulk import BulkAccuracy

BULK_NAMES = Names(stem="accuracy", tables=("budget", "orders", "floor", "front", "rungs"))
SCHEMA = "grainproof accuracy of bulk quantities, 2"

BUDGET_NOTE = (
    "For each knob, the others as declared: the cheapest rung from which on error and its standard error together stay "
    "below the target, on the cheapest engine; of steps those that `grainproof scene` takes. What it gives up: other "
    "quantities whose error stands out of the noise; or, where no rung keeps the target, why. Packings that would tell "
    "are those that bring the standard error of this knob's own error, against its own limit, down to the target: what "
    "a packing does to all rungs alike is not in it, so that it may take fewer than the quantity itself does (Floor). "
    "`advise` asks for packings that tell the errors of all knobs together."
)
ORDER_NOTE = (
    "p in error ~ x^p over all rungs, x = dt, 1/stiffness, rate, 1/sqrt(N) or width, one standard error by leaving out "
    "each packing in turn; none where coarsest and finest rung differ by no more than noise. Limits are of the finest "
    "three rungs: least squares with the expected order where nothing contradicts it (extrapolated), the finest two "
    "and the whole correction as an error where something does (outside the asymptotic range), the mean where rungs "
    "differ by no more than noise (flat)."
)
FLOOR_NOTE = (
    "Scatter over packings at the scene's own setting, over the quantity. Below that of the mean no knob buys "
    "anything: only more packings, or larger ones, do. Packings for 1 %: so many bring the standard error of the "
    "quantity's mean down to 1 % of it, whatever the knobs do; (scatter of one packing/1 %) squared."
)
FRONT_NOTE = (
    "No other setting of any knob or engine is both faster and better, its error with one standard error added; there "
    "the front is drawn. Errors here are those of whole settings: against the limit of all asked knobs together, so "
    "with what the other knobs leave at their declared values. Steps that `grainproof scene` refuses are not on it."
)
RUNG_NOTE = (
    "CPU time is that of the engine's own process for one whole test, shared out among set-up, run and output as the "
    "engine tells them; the run's, median over packings; rungs that failed have none. To the same strain or angle: a "
    "faster drive takes less physical time. Steps beyond the scene's limit are measured to show where things break; "
    "`scene` and `run` refuse them. Unstable are also completed runs whose sample is shaken: opposite walls more than "
    f"{UNBALANCED:g} times as far out of balance, or discs with more than {HOT:g} times the kinetic energy (over that "
    "at the drive's speed), as on the finest rung, each by two standard errors over packings. A drive x times as fast "
    "may have x times both, contacts 1/x as stiff x times the energy: that is physics. Unstable rungs have no time and "
    "are in no limit and no order."
)


def bulk_answer(done: BulkAccuracy) -> Answer:
    """Return the main tables for people and everything for programs."""
    found = bulk_tables(done)
    shown = {"Cheapest settings": shown_budget(done), "Orders and limits": _of_asked(done, found["orders"]),
             "Floor": _of_asked(done, found["floor"]), "Rungs": found["rungs"]}
    return Answer(tables=shown, data=bulk_data(done))


def bulk_data(done: BulkAccuracy) -> dict:
    """Return everything with all digits.

    schema: SCHEMA. scene_file, scene: as written. knobs: names; ladders: values by knob, cheapest first. quantity: what
    the tables tell of; quantities: of all, what they are and their unit. packings, engines, host, times of the study.
    rows: one a knob, rung, engine and quantity, and one a limit; each says all that it needs::

        scene, knob, knob_value (what its numbers are), engine, quantity, unit
        scale         what errors are measured by, in the unit; floor, spread: scatter over packings of the mean and of
                      one packing, over the scale, at the scene's own setting
        kind          "measured": a rung; "extrapolated": the limit of its ladder
        value, setting, x   of the knob as number and in words; x tends to 0 as the knob is turned up
        mean, mean_error    over packings, in the unit (of a curve the rms over its places); packings: how many had it
        error_bar     one standard error over the scale: of a rung that of its error, of a limit its own
        measured only:      declared (whether it is the scene's own setting), status, reason, each (values by packing,
                      null without), error (>= 0) and signed_error against the knob's limit (of `law`: against the
                      scene as declared), seen (error > 2 error_bar), beyond_limit (the largest dt_fraction that the
                      scene takes, where this one is larger), whole_error and whole_error_bar (against the limit of all
                      asked knobs), cpu_seconds (median of a test; null for failed rungs), cpu_seconds_each,
                      setup_seconds, output_seconds, dt (s), steps, particles
        extrapolated only:  state ("extrapolated", "outside", "flat": see `harness.studies.accuracy.limit`), how,
                      order_used, order, order_error (shown by the whole ladder; null if noise hides it)

    What was not measured is null. tables: those of the page.
    """
    from msgspec import to_builtins

    return {
        "schema": SCHEMA, "scene_file": done.scene_file.name, "scene": to_builtins(done.scene), "knobs": done.knobs,
        "ladders": {a.knob.name: list(a.values) for a in done.asked}, "quantity": done.quantity,
        "quantities": {b.name: {"says": b.says, "unit": b.unit} for b in BULK[type(done.scene)]},
        "packings": done.packings, "engines": done.engines, "exit_status": done.exit_status,
        "words": bulk_paragraph(done), "host": to_builtins(done.host), "wall_seconds": done.wall_seconds,
        "own_seconds": done.own_seconds, "own_share": done.own_share, "packing_seconds": done.packing_seconds,
        "engine_seconds": done.engine_seconds, "runs": done.runs, "kept": done.kept, "load": done.load,
        "rows": list(data_rows(done)), "tables": bulk_tables(done),
    }


def write_bulk(done: BulkAccuracy, out: Path) -> Path:
    """Write accuracy.html, .json, .png, .svg and CSV tables into `out`, each whole or not at all; return the page."""
    return write_files(out, BULK_NAMES, Written(
        title=f"What accuracy costs: {done.scene.title}", lead=f"{bulk_summary(done)}.", caption=BULK_CAPTION,
        figure=bulk_figure(done), tables=bulk_tables(done), data=bulk_data(done),
        sections=lambda figures: _sections(done, figures, out),
    ))


def bulk_summary(done: BulkAccuracy) -> str:
    """Return one line: what was turned, on whom."""
    host = done.host
    return (
        f"{what(done).capitalize()} against {', '.join(done.knobs)}; {done.packings} packings, "
        f"{', '.join(done.engines)}; {done.runs} runs on {host.cpu_model}, {host.cores} cores; load of the machine, "
        f"these runs and all else on it, up to {done.load:.1f} when a run began"
    )


def _sections(done: BulkAccuracy, figures: tuple[Figure, ...], out: Path) -> list[Section]:
    found = bulk_tables(done)
    return [
        Section(heading="In words", note=bulk_paragraph(done)),
        Section(heading="Error against time", figures=figures),
        Section(heading="Cheapest settings", note=BUDGET_NOTE, rows=shown_budget(done)),
        Section(heading="Floor", note=FLOOR_NOTE, rows=found["floor"]),
        Section(heading="Front", note=FRONT_NOTE, rows=found["front"]),
        Section(heading="Orders and limits", note=ORDER_NOTE, rows=_of_asked(done, found["orders"])),
        Section(heading="All rungs", note=RUNG_NOTE, rows=found["rungs"]),
        Section(heading="Other quantities", note="As above.", rows=_of_others(done, found["orders"])),
        Section(heading="Reproduce", text=_command(done, out)),
    ]


def _of_asked(done: BulkAccuracy, rows: list[dict]) -> list[dict]:
    return [r for r in rows if r["quantity"] == done.quantity]


def _of_others(done: BulkAccuracy, rows: list[dict]) -> list[dict]:
    return [r for r in rows if r["quantity"] != done.quantity]


def _command(done: BulkAccuracy, out: Path) -> str:
    words = ["grainproof", "accuracy", str(done.scene_file), "--knob", ",".join(done.knobs)]
    if len(done.asked) == 1 and not done.asked[0].knob.words:
        words += ["--ladder", ",".join(f"{v:.12g}" for v in done.asked[0].values)]
    return shlex.join([
        *words, "--engines", ",".join(done.engines), "--quantity", done.quantity, "--packings", str(done.packings),
        "--out", str(out),
    ])
