"""The compare report: one page, and the same numbers as CSV and JSON."""

from __future__ import annotations

from collections import Counter
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from harness.errors import InputError
from harness.report import biaxial, figures, free
from harness.report.page import Section, render_page
from harness.report.tables import Answer, csv_text
from harness.scene.model import Biaxial

if TYPE_CHECKING:
    from harness.studies.compare.study import Comparison, Run

@dataclass(frozen=True, kw_only=True)
class Written:
    """The files of a report."""

    page: Path
    data: Path
    tables: tuple[Path, ...]
    picture: Path | None


def compare_answer(comparison: Comparison) -> Answer:
    """Return runs and verdicts for people, and everything for programs."""
    tables = {"Runs": run_rows(comparison), "Verdicts": check_rows(comparison)}
    return Answer(tables=tables, data=report_data(comparison))


def write_report(comparison: Comparison, out: Path) -> Written:
    """Write report.html, report.json, CSV tables and, for a box, overview.png into `out`; each whole or not at all.

    All hold the same numbers: the page with three digits, the others with all. What the page leaves out
    is in the others.
    """
    from harness.runs.atomic import write_json_atomic, write_text_atomic

    out.mkdir(parents=True, exist_ok=True)
    tables = {"checks": check_rows(comparison), "runs": run_rows(comparison), **_kind(comparison).tables(comparison)}
    sections = [
        Section(heading="Verdicts", note=VERDICT_NOTE, rows=tables["checks"]),
        Section(heading="Runs", note=RUN_NOTE, rows=tables["runs"]),
        *_kind(comparison).sections(comparison),
        Section(heading="Reproduce", text="\n".join(_reproduce(comparison))),
    ]
    page = render_page(title=comparison.scene.title, lead=f"{summary(comparison)}.", sections=sections)
    for name, rows in tables.items():
        write_text_atomic(out / f"{name}.csv", csv_text(rows))
    write_json_atomic(out / DATA, report_data(comparison))
    write_text_atomic(out / PAGE, page)
    files = tuple(out / f"{name}.csv" for name in tables)
    picture = _write_picture(comparison, out / PICTURE)
    return Written(page=out / PAGE, data=out / DATA, tables=files, picture=picture)


PICTURE, PAGE, DATA = "overview.png", "report.html", "report.json"


def check_report_places(out: Path) -> None:
    """Raise InputError when a folder stands where a file of the report goes: before anything is run."""
    names = (PICTURE, PAGE, DATA, *(f"{name}.csv" for name in ("checks", "runs", *biaxial.TABLES, *free.TABLES)))
    for place in (out / name for name in names):
        if place.is_dir():
            raise InputError(
                file=place, expected="a file or nothing, as the report goes there", got="a folder",
                fix="move it away or name another --out",
            )


def _write_picture(comparison: Comparison, path: Path) -> Path | None:
    """Write the one picture of a box comparison; other scenes, and failed ones, have none."""
    from harness.report.overview import overview
    from harness.runs.atomic import write_bytes_atomic

    if not isinstance(comparison.scene, Biaxial) or not comparison.result.curves:
        path.unlink(missing_ok=True)
        return None
    write_bytes_atomic(path, figures.png_bytes(overview(comparison), dpi=80))
    return path


VERDICT_NOTE = (
    "agrees / differs: a declared tolerance was met or not. inconclusive: the data cannot decide, for example one "
    "packing after chaos has set in. not_checked: there was nothing to check, which is never a pass. Levels: L1 "
    "collision, L2 trajectory until chaos, L3 statistics over packings, run: a property that one run must have."
)
RUN_NOTE = (
    "CPU time of the engine's own process, set-up and output included; runs shared this machine, so compare "
    "times only roughly. CPU per step is that time over the steps. An engine that failed or is missing is listed "
    "with its reason."
)


def check_rows(comparison: Comparison) -> list[dict]:
    """One row a check, in the order in which they were made."""
    return [
        {"verdict": c.verdict, "level": c.level, "quantity": c.quantity, "left": c.left, "right": c.right,
         "deviation": c.deviation, "tolerance": c.tolerance, "why": c.why}
        for c in comparison.checks
    ]


def run_rows(comparison: Comparison) -> list[dict]:
    """One row a run: what became of it and what it cost."""
    return [_run_row(r) for r in comparison.runs]


def _run_row(run: Run) -> dict:
    o = run.outcome
    cpu = o.cpu_seconds if o.status == "completed" else None
    return {
        "engine": run.engine, "packing": run.packing + 1, "status": o.status, "version": o.engine_version,
        "particles": o.particles, "steps": o.steps, "CPU (s)": cpu,
        "CPU per step (us)": None if cpu is None else 1e6 * cpu / o.steps, "reason": o.reason,
    }


def report_data(comparison: Comparison) -> dict:
    """Everything in the page's tables as JSON-able data, with the scene and the outcomes in full."""
    import msgspec

    return {
        "scene_file": comparison.scene_file.name,
        "scene": msgspec.to_builtins(comparison.scene),
        "exit_status": comparison.exit_status,
        "summary": summary(comparison),
        "checks": [asdict(c) for c in comparison.checks],
        "runs": [msgspec.to_builtins(r.outcome) for r in comparison.runs],
        "tables": _kind(comparison).tables(comparison),
    }


FAILED = {
    "unstable": "was unstable", "crashed": "crashed", "timed_out": "timed out", "unavailable": "is unavailable",
    "unsupported": "cannot compute this scene",
}
"""What became of an engine, as the end of a sentence."""


def summary(comparison: Comparison) -> str:
    """Return one line: how large, how many runs, which engines are missing, how many verdicts of each kind."""
    counts = Counter(c.verdict for c in comparison.checks)
    verdicts = ", ".join(f"{n} {v.replace('_', ' ')}" for v, n in counts.items()) or "none could be made"
    failed = {r.engine: r.outcome.status for r in comparison.runs if r.trajectory is None}
    without = "".join(f", {engine} {FAILED[status]}" for engine, status in failed.items())
    system = comparison.starts[0].system
    return (
        f"{len(system.particles)} particles, {system.steps} steps of {system.dt:.4g} s; "
        f"{len(comparison.completed)} of {len(comparison.runs)} runs completed{without}; checks: {verdicts}"
    )


def _reproduce(comparison: Comparison) -> list[str]:
    made = [r for r in comparison.runs if r.outcome.reproduce]
    return [f"# {r.engine}, packing {r.packing + 1}\n{r.outcome.reproduce}" for r in made]


def _kind(comparison: Comparison):
    """The module that knows this kind of scene's figures and tables."""
    return biaxial if isinstance(comparison.scene, Biaxial) else free
