"""The report of the laws study: two matrices, exit values, what differs and why; page, CSV, JSON, figures."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from harness.engines.registry import KERNEL_PREFIX
from harness.report import figures
from harness.report.law_figures import draw_curves_page, draw_matrix
from harness.report.page import Figure, Section, render_page
from harness.report.tables import Answer, csv_text
from harness.studies.laws.judge import PLAIN_FRAME

if TYPE_CHECKING:
    from harness.studies.laws import LawsResult
    from harness.studies.laws.matrix import Cell
    from harness.studies.verdict import Check

TITLE = "Contact laws, proven in every code that has them"
EMPTY = ("unsupported", "known wrong", "unavailable", "failed")


@dataclass(frozen=True, kw_only=True)
class Written:
    """The files of a report."""

    page: Path
    picture: Path


def laws_answer(result: LawsResult) -> Answer:
    """Return the matrices, exit values and what differs for people, and everything for programs."""
    tables = {
        "Prescribed motion: codes against the kernel in their conventions, kernels against closed forms":
            matrix_rows(result.prescribed, result.engines),
        "Collisions: codes against the kernel in their conventions": collision_rows(result),
    }
    if result.exits:
        tables["Single impacts against closed forms"] = short_exit_rows(result)
    wrong = check_rows(c for c in result.checks if c.verdict == "differs")
    if wrong:
        tables["What differs"] = wrong
    return Answer(tables=tables, data=laws_data(result))


def write_laws_report(result: LawsResult, out: Path) -> Written:
    """Write laws.html, laws.json, laws.png and CSV tables into `out`; each whole or not at all."""
    from harness.runs.atomic import write_bytes_atomic, write_json_atomic, write_text_atomic

    out.mkdir(parents=True, exist_ok=True)
    matrix, curves = draw_matrix(result), draw_curves_page(result)
    for name, rows in tables(result).items():
        write_text_atomic(out / f"laws_{name}.csv", csv_text(rows))
    write_json_atomic(out / "laws.json", laws_data(result))
    write_bytes_atomic(out / "laws.png", figures.png_bytes(matrix, dpi=110))
    page = render_page(title=TITLE, lead=f"{summary(result)}.", sections=_sections(result, matrix, curves))
    write_text_atomic(out / "laws.html", page)
    return Written(page=out / "laws.html", picture=out / "laws.png")


def summary(result: LawsResult) -> str:
    """Return one line: how many laws and engines, how many verdicts of each kind."""
    counts = Counter(c.verdict for c in result.checks)
    verdicts = ", ".join(f"{n} {v.replace('_', ' ')}" for v, n in counts.items()) or "none could be made"
    broken = sum(c.shown == "failed" for c in (*result.prescribed, *result.collisions))
    return (
        f"{len(result.laws)} combinations of laws on {len(result.engines)} engines; checks: {verdicts}"
        + (f"; {broken} cells failed" if broken else "")
    )


# --- tables ----------------------------------------------------------------------------------------


def tables(result: LawsResult) -> dict[str, list[dict]]:
    """Rows by table name: what the CSV files hold."""
    return {
        "prescribed": cell_rows(result.prescribed), "collisions": cell_rows(result.collisions),
        "exits": exit_rows(result), "checks": check_rows(result.checks), "frames": frame_rows(result),
        "missing": missing_rows(result), "allowances": allowance_rows(result),
    }


def matrix_rows(cells: Iterable[Cell], engines: Iterable[str]) -> list[dict]:
    """One row a combination of laws, one column an engine."""
    by_laws: dict[str, dict[str, str]] = {}
    for c in cells:
        by_laws.setdefault(c.laws, {})[c.engine] = c.text
    return [{"laws": laws, **{e: texts[e] for e in engines}} for laws, texts in by_laws.items()]


def collision_rows(result: LawsResult) -> list[dict]:
    """The matrix of collisions; a kernel has nobody to be compared with but closed forms, which stand apart."""
    codes = codes_of(result)
    return matrix_rows((c for c in result.collisions if c.engine in codes), codes) if codes else []


def codes_of(result: LawsResult) -> list[str]:
    """Return the engines that are not kernels."""
    return [e for e in result.engines if not e.startswith(KERNEL_PREFIX)]


def cell_rows(cells: Iterable[Cell]) -> list[dict]:
    """One row a cell, with everything it knows."""
    return [
        {"laws": c.laws, "engine": c.engine, "shown": c.shown, "deviation": c.deviation, "against": c.against or None,
         "differs": c.differs, "note": c.note, "missing": "; ".join(c.missing) or None}
        for c in cells
    ]


def exit_rows(result: LawsResult) -> list[dict]:
    """One row a tabulated value, one column an engine with what it found."""
    rows: dict[str, dict] = {}
    for x in result.exits:
        row = rows.setdefault(x.value.name, {
            "what": x.value.quantity, "closed form": x.value.value, "tolerance": x.value.tolerance,
            **dict.fromkeys(result.engines), "why this tolerance": x.value.reason, "source": x.value.origin,
        })
        row[x.engine] = x.found
    return list(rows.values())


def short_exit_rows(result: LawsResult) -> list[dict]:
    """The same without words, for people."""
    return [{k: v for k, v in row.items() if k not in ("why this tolerance", "source")} for row in exit_rows(result)]


def check_rows(checks: Iterable[Check]) -> list[dict]:
    """One row a check."""
    return [
        {"verdict": c.verdict, "level": c.level, "quantity": c.quantity, "left": c.left, "right": c.right,
         "deviation": c.deviation, "tolerance": c.tolerance, "why": c.why}
        for c in checks
    ]


def frame_rows(result: LawsResult) -> list[dict]:
    """One row an engine and a known reason why its answer depends on the frame."""
    found: dict[tuple[str, str], list[Check]] = {}
    for c in result.checks:
        if c.right == PLAIN_FRAME and c.verdict == "known_difference":
            found.setdefault((c.left, c.why.rpartition("; largest in frame")[0]), []).append(c)
    return [_frame_row(engine, reason, of) for (engine, reason), of in found.items()]


def _frame_row(engine: str, reason: str, checks: list[Check]) -> dict:
    names = [c.quantity.partition(": ") for c in checks]
    return {
        "verdict": "known_difference", "engine": engine, "reason": reason,
        "motions": ", ".join(dict.fromkeys(motion for _, _, motion in names)),
        "combinations of laws": len({laws for laws, _, _ in names}),
        "largest deviation": max(c.deviation for c in checks),
    }


def missing_rows(result: LawsResult) -> list[dict]:
    """One row an engine and a reason why it does not compute something, with the laws it is about."""
    about: dict[tuple[str, str, str], list[str]] = {}
    for c in (*result.prescribed, *result.collisions):
        if c.shown in EMPTY:
            about.setdefault((c.engine, c.shown, c.note), []).append(c.laws)
        for part in c.missing:
            about.setdefault((c.engine, "in part", part), []).append(c.laws)
    return [
        {"engine": engine, "shown": shown, "laws": ", ".join(dict.fromkeys(laws)), "why": why}
        for (engine, shown, why), laws in about.items()
    ]


def allowance_rows(result: LawsResult) -> list[dict]:
    """One row a tolerance that a combination of laws declares for an engine."""
    return [
        {"laws": each.name, "engine": engine, "tolerance": a.tolerance, "reason": a.reason}
        for each in result.laws for engine, a in each.allowances.items() if engine in result.engines
    ]


def laws_data(result: LawsResult) -> dict:
    """Everything as JSON-able data."""
    import msgspec

    laws = {each.name: {k: msgspec.to_builtins(v) for k, v in each.tables().items() if v} for each in result.laws}
    return {
        "summary": summary(result), "exit_status": result.exit_status, "versions": result.versions, "laws": laws,
        "prescribed": [asdict(c) for c in result.prescribed], "collisions": [asdict(c) for c in result.collisions],
        "exits": exit_rows(result), "checks": [asdict(c) for c in result.checks],
    }


# --- the page --------------------------------------------------------------------------------------

MATRIX_NOTE = (
    "Largest deviation over all motions (normal cycles, shear, oblique loading, rolling, twisting, everything at "
    "once), frames (turned, in translation, mirrored, relabelled, in rotation), pairs and planes, 2D and 3D: force "
    "over the largest force, torque over the largest torque of the motion. A code is compared with the kernel in its "
    "own conventions, a kernel with closed forms (a code too, where the kernel lacks the law). A star: the engine does "
    "not compute all parts, see below. Differences in rounding count: 1e-15 is agreement to the last digit."
)
COLLISION_NOTE = "Largest deviation of places, velocities and spins over whole collisions: oblique, with spin, 3D."
EXIT_NOTE = (
    "What bodies left with, of one impact each. The deviations are those of the time step; laws_exits.csv says why "
    "each tolerance is what it is."
)
FRAME_NOTE = (
    "The same motion in another frame must give the same answer. Where a code's conventions make it depend on the "
    "frame, this is known, bounded, and shown here; anything else differs."
)
CHECK_NOTE = "All checks with all digits are in laws_checks.csv and laws.json."


def _sections(result: LawsResult, matrix, curves) -> list[Section]:
    wrong = check_rows(c for c in result.checks if c.verdict == "differs")
    picture = Figure(uri=figures.png_uri(matrix), caption="The two matrices: the paler, the closer.")
    made = [
        Section(heading="Prescribed motion", note=MATRIX_NOTE, rows=matrix_rows(result.prescribed, result.engines)),
        Section(heading="Collisions", note=COLLISION_NOTE, rows=collision_rows(result)),
        Section(heading="Both at a glance", figures=(picture,)),
        Section(heading="Single impacts against closed forms", note=EXIT_NOTE, rows=short_exit_rows(result)),
        Section(heading="What differs", note=CHECK_NOTE, rows=wrong),
        Section(heading="What depends on the frame, and why", note=FRAME_NOTE, rows=frame_rows(result)),
        Section(heading="Tolerances of their own", rows=allowance_rows(result)),
        Section(heading="What an engine does not compute", rows=missing_rows(result)),
    ]
    if curves is not None:
        made.insert(3, Section(heading="The laws", figures=(Figure(uri=figures.png_uri(curves), caption=CURVES),)))
    versions = "\n".join(f"{engine}: {version or 'not here'}" for engine, version in result.versions.items())
    return [*made, Section(heading="Versions", text=versions)]


CURVES = (
    "What a pair of unequal bodies answers: above normal force against overlap in the normal cycles, below friction "
    "against slip at one depth, back and forth. Lines that cover each other are equal; a kernel is left out where the "
    "code whose conventions it follows is drawn."
)
