"""The compare report: one page, and the same numbers as CSV and JSON."""

from __future__ import annotations

from collections import Counter
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from harness.report import biaxial, couette, figures, free
from harness.report.campaign import closing_sections, opening_sections
from harness.report.files import refuse_folders
from harness.report.junit import junit_xml
from harness.report.page import render_page
from harness.report.places import PLACES, place_rows, place_sections
from harness.report.tables import Answer, csv_text
from harness.report.watch import REMARKS, remark_rows, watch_matrix, watch_rows, watch_sections
from harness.scene.model import Biaxial, Couette, Free

if TYPE_CHECKING:
    from harness.studies.compare.study import Comparison, Run

KINDS = {Biaxial: biaxial, Couette: couette, Free: free}
"""The modules that know a kind of scene's tables (names in TABLES), sections and overview."""


@dataclass(frozen=True, kw_only=True)
class Written:
    """The files of a report. content: what `data` holds, see `report_data`."""

    page: Path
    data: Path
    tables: tuple[Path, ...]
    picture: Path | None
    content: dict


def compare_answer(comparison: Comparison, content: dict) -> Answer:
    """Return runs and verdicts for people, and everything for programs. content: of the report that was written."""
    tables = {"Runs": run_rows(comparison), "Verdicts": check_rows(comparison)}
    if any(r.watch for r in comparison.all_runs):
        tables["Watch, largest sizes"] = watch_matrix(comparison.all_runs)
        tables[REMARKS] = remark_rows(comparison.all_runs)
    places = place_rows(comparison.words)
    if places:
        tables[PLACES] = places
    return Answer(tables=tables, data=content)


def write_report(comparison: Comparison, out: Path) -> Written:
    """Write report.html, report.json, junit.xml, CSV tables and, for a box or a ring, overview.png into `out`.

    Each is written whole or not at all.
    All hold the same numbers: the page with three digits, the others with all. What the page leaves out
    is in the others.
    """
    from harness.runs.atomic import write_json_atomic, write_text_atomic

    out.mkdir(parents=True, exist_ok=True)
    of_kind = _kind(comparison).tables(comparison)
    tables = {"checks": check_rows(comparison), "runs": run_rows(comparison), **of_kind}
    content = report_data(comparison, of_kind)
    if any(r.watch for r in comparison.all_runs):
        tables |= {"watch": watch_rows(comparison.all_runs), "remarks": remark_rows(comparison.all_runs)}
    sections = [
        *opening_sections(comparison.checks, comparison.all_runs),
        *_kind(comparison).sections(comparison),
        *closing_sections(
            comparison.all_runs, check_rows=tables["checks"], run_rows=tables["runs"],
            between=[*watch_sections(comparison.all_runs), *place_sections(comparison.words)],
            command=comparison.command,
        ),
    ]
    page = render_page(title=comparison.scene.title, lead=_lead(comparison), sections=sections)
    files = _write_tables(tables, out, _table_names(_kind(comparison)))
    write_json_atomic(out / DATA, content)
    write_text_atomic(out / PAGE, page)
    write_text_atomic(out / JUNIT, _junit(comparison))
    picture = _write_picture(comparison, out / PICTURE)
    return Written(page=out / PAGE, data=out / DATA, tables=files, picture=picture, content=content)


def _write_tables(tables: dict[str, list[dict]], out: Path, possible: list[str]) -> tuple[Path, ...]:
    """Write a CSV file a table; take away those of a former report that this one does not have."""
    from harness.runs.atomic import write_text_atomic

    for name in set(possible) - set(tables):
        (out / f"{name}.csv").unlink(missing_ok=True)
    for name, rows in tables.items():
        write_text_atomic(out / f"{name}.csv", csv_text(rows))
    return tuple(out / f"{name}.csv" for name in tables)


def _lead(comparison: Comparison) -> str:
    """The summary, and of rings whether they were shown to be steady."""
    more = couette.lead(comparison) if isinstance(comparison.scene, Couette) else ""
    return f"{summary(comparison)}. {more}".strip()


PICTURE, PAGE, DATA, JUNIT = "overview.png", "report.html", "report.json", "junit.xml"


def check_report_places(out: Path) -> None:
    """Raise InputError when a folder stands where a file of the report goes: before anything is run."""
    names = (PICTURE, PAGE, DATA, JUNIT, *(f"{name}.csv" for name in _table_names(*KINDS.values())))
    refuse_folders(out, names)


def _table_names(*kinds) -> list[str]:
    """Return all tables that reports of these kinds can have."""
    return ["checks", "runs", "watch", "remarks", *(name for kind in kinds for name in kind.TABLES)]


def _write_picture(comparison: Comparison, path: Path) -> Path | None:
    """Write the one picture of a comparison, if its kind has one and a run of the first packing completed."""
    from harness.runs.atomic import write_bytes_atomic

    figure = _kind(comparison).overview(comparison)
    if figure is None:
        path.unlink(missing_ok=True)
        return None
    write_bytes_atomic(path, figures.png_bytes(figure, dpi=80))
    return path


def check_rows(comparison: Comparison) -> list[dict]:
    """One row a check, in the order in which they were made; of comparisons with statistics what chance gives, too."""
    chance = any(c.chance is not None for c in comparison.checks)
    return [
        {"verdict": c.verdict, "level": c.level, "quantity": c.quantity, "left": c.left, "right": c.right,
         "deviation": c.deviation, "tolerance": c.tolerance, **({"by chance": c.chance} if chance else {}),
         "why": c.why}
        for c in comparison.checks
    ]


def run_rows(comparison: Comparison) -> list[dict]:
    """One row a run: what became of it and what it cost."""
    return [_run_row(r) for r in comparison.all_runs]


def _run_row(run: Run) -> dict:
    o = run.outcome
    cpu = o.cpu_seconds if o.status == "completed" else None
    return {
        "engine": run.engine, "packing": run.packing + 1, "status": o.status, "version": o.engine_version,
        "particles": o.particles, "steps": o.steps, "CPU (s)": cpu,
        "CPU over steps (us)": None if cpu is None else 1e6 * cpu / o.steps,
        "reason": o.reason or "; ".join(f"warning: {warning}" for warning in o.warnings),
    }


def report_data(comparison: Comparison, tables: dict[str, list[dict]]) -> dict:
    """Everything in the page's tables as JSON-able data, with the scene and the outcomes in full.

    tables: those of the scene's kind.
    """
    import msgspec

    return {
        "scene_file": comparison.scene_file.name, "looks": list(comparison.looks),
        "scene": msgspec.to_builtins(comparison.scene),
        "exit_status": comparison.exit_status,
        "summary": summary(comparison),
        "checks": [asdict(c) for c in comparison.checks],
        "runs": [msgspec.to_builtins(r.outcome) for r in comparison.all_runs],
        "tables": {"runs": run_rows(comparison), **tables},
    }


FAILED = {
    "unstable": "was unstable", "crashed": "crashed", "timed_out": "timed out", "unavailable": "is unavailable",
    "unsupported": "cannot compute this scene",
}
"""What became of an engine, as the end of a sentence."""


NO_CHECK = (
    "none could be made, and nothing to check is no pass (exit status 1): [[compare.agreements]] of a free scene "
    "declares how near pairs of codes must come"
)


def summary(comparison: Comparison) -> str:
    """Return one line: how large, how many runs, which engines are missing, how many verdicts of each kind."""
    counts = Counter(c.verdict for c in comparison.checks)
    verdicts = ", ".join(f"{n} {v.replace('_', ' ')}" for v, n in counts.items()) or NO_CHECK
    failed = {r.engine: r.outcome.status for r in comparison.all_runs if r.trajectory is None}
    without = "".join(f", {engine} {FAILED[status]}" for engine, status in failed.items())
    system = comparison.starts[0].system
    return (
        f"{len(system.particles)} particles, {system.steps} steps of {system.dt:.4g} s; "
        f"{sum(r.trajectory is not None for r in comparison.all_runs)} of {len(comparison.all_runs)} runs completed"
        f"{without}; checks: {verdicts}"
    )


def own_cost(comparison: Comparison) -> str:
    """Return a line: CPU time of this process, which writes, reads, averages, judges and draws, beside the runs'.

    What the runs needed counts whether they were made now or kept; packings, which are computed like runs, are told
    apart. "" when no run tells.
    """
    import time

    theirs = sum(r.outcome.cpu_seconds or 0.0 for r in comparison.all_runs)
    packings = comparison.packing_seconds
    ours = time.process_time() - packings
    made = f", packings {packings:.3g} s" if packings >= 0.1 else ""
    share = f"harness {ours:.3g} s ({100 * ours / theirs:.3g} %)" if theirs else ""
    return f"CPU time: runs {theirs:.3g} s{made}, {share}\n" if theirs else ""


def _junit(comparison: Comparison) -> str:
    name = comparison.scene_file.stem
    return junit_xml(name=name, summary=summary(comparison), checks=comparison.checks, runs=comparison.all_runs)


def _kind(comparison: Comparison):
    """The module that knows this kind of scene's figures and tables."""
    return KINDS[type(comparison.scene)]
