"""The compare report: one page, and the same numbers as CSV and JSON."""

from __future__ import annotations

from dataclasses import asdict, dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from harness.report.page import Section, render_page
from harness.report.tables import csv_text
from harness.scene.model import Biaxial

if TYPE_CHECKING:
    from harness.studies.compare.study import Comparison


@dataclass(frozen=True, kw_only=True)
class Written:
    """The files of a report."""

    page: Path
    data: Path
    tables: tuple[Path, ...]


def write_report(comparison: Comparison, out: Path) -> Written:
    """Write report.html, report.json and the CSV tables into `out`; each file appears whole or not at all."""
    from harness.runs.atomic import write_json_atomic, write_text_atomic

    out.mkdir(parents=True, exist_ok=True)
    module = _kind(comparison)
    tables = {"checks": check_rows(comparison), "runs": run_rows(comparison), **module.tables(comparison)}
    sections = [
        Section(heading="Verdicts", note=VERDICT_NOTE, rows=tables["checks"]),
        Section(heading="Runs", note=RUN_NOTE, rows=tables["runs"]),
        *module.sections(comparison),
        Section(heading="Reproduce", text="\n".join(_reproduce(comparison))),
    ]
    page = render_page(title=comparison.scene.title, lead=_lead(comparison), sections=sections)
    for name, rows in tables.items():
        write_text_atomic(out / f"{name}.csv", csv_text(rows))
    write_json_atomic(out / "report.json", report_data(comparison, tables))
    write_text_atomic(out / "report.html", page)
    files = tuple(out / f"{name}.csv" for name in tables)
    return Written(page=out / "report.html", data=out / "report.json", tables=files)


VERDICT_NOTE = (
    "agrees / differs: a declared tolerance was met or not. inconclusive: the data cannot decide, for example one "
    "packing after chaos has set in. not_checked: there was nothing to check, which is never a pass. Levels: L1 "
    "collision, L2 trajectory until chaos, L3 statistics over packings, run: a property that one run must have."
)
RUN_NOTE = (
    "CPU time of the engine's own process, set-up and output included; runs shared this machine, so compare "
    "times only roughly. An engine that failed or is missing is listed with its reason."
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


def _run_row(run) -> dict:
    o = run.outcome
    done = o.status == "completed" and o.cpu_seconds is not None
    return {
        "engine": run.engine, "packing": run.packing + 1, "outcome": o.status, "version": o.engine_version,
        "particles": o.particles, "steps": o.steps, "CPU s": o.cpu_seconds if done else None,
        "us per step": 1e6 * o.timings["run"] / o.steps if done and "run" in o.timings else None,
        "reason": o.reason,
    }


def report_data(comparison: Comparison, tables: dict[str, list[dict]]) -> dict:
    """Everything in the page's tables as JSON-able data, with the scene and the outcomes in full."""
    import msgspec

    return {
        "scene_file": Path(comparison.scene_file).name,
        "scene": msgspec.to_builtins(comparison.scene),
        "exit_status": comparison.exit_status,
        "checks": [asdict(c) for c in comparison.checks],
        "runs": [msgspec.to_builtins(r.outcome) for r in comparison.runs],
        "tables": {k: v for k, v in tables.items() if k not in ("checks", "runs")},
    }


def _lead(comparison: Comparison) -> str:
    counts: dict[str, int] = {}
    for c in comparison.checks:
        counts[c.verdict] = counts.get(c.verdict, 0) + 1
    said = ", ".join(f"{n} {v.replace('_', ' ')}" for v, n in counts.items()) or "no check could be made"
    system = comparison.starts[0].system
    return (
        f"{len(system.particles)} particles, {system.steps} steps of {system.dt:.4g} s; "
        f"{len(comparison.completed)} of {len(comparison.runs)} runs completed; checks: {said}."
    )


def _reproduce(comparison: Comparison) -> list[str]:
    return [f"# {r.engine}, packing {r.packing + 1}\n{r.outcome.reproduce}" for r in comparison.runs if r.outcome.reproduce]


def _kind(comparison: Comparison):
    """The module that knows this kind of scene's figures and tables."""
    from harness.report import biaxial, free

    return biaxial if isinstance(comparison.scene, Biaxial) else free
