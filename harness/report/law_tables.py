"""The tables of the laws study, as rows: matrices, codes against each other, frames, exits, what is missing and why."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable
from typing import TYPE_CHECKING

from harness.engines.registry import KERNEL_PREFIX
from harness.studies.laws.direct import DirectCheck, code_pairs
from harness.studies.laws.frame_checks import FrameCheck

if TYPE_CHECKING:
    from harness.studies.laws import LawsResult
    from harness.studies.laws.matrix import Cell
    from harness.studies.verdict import Check

EMPTY = ("unsupported", "known wrong", "unavailable", "failed")

LEGEND = (
    "0 is equality to the last bit. A star: the engine does not compute all parts, the note on what it does not "
    "compute says which. -: computed, but there is nothing to compare it with, or not both codes compute it. "
    "differs: beyond the tolerance. failed: the reason stands below."
)


def tables(result: LawsResult) -> dict[str, list[dict]]:
    """Rows by table name: what the CSV files hold."""
    return {
        "prescribed": cell_rows(result.prescribed), "collisions": cell_rows(result.collisions),
        "codes": direct_rows(result), "codes_why": reason_rows(result), "friction": reach_rows(result),
        "exits": exit_rows(result), "checks": check_rows(result.checks), "frames": frame_rows(result),
        "invariance": invariance_rows(result), "missing": missing_rows(result), "failed": failed_rows(result),
    }


# --- matrices --------------------------------------------------------------------------------------


def prescribed_rows(result: LawsResult) -> list[dict]:
    """One row a combination of laws, one column an engine, one a pair of codes."""
    return matrix_rows((*result.prescribed, *result.direct[0]), [*result.engines, *_pair_names(result)])


def collision_rows(result: LawsResult) -> list[dict]:
    """The matrix of collisions; a kernel has nobody to be compared with but closed forms, which stand apart."""
    codes = codes_of(result)
    if not codes:
        return []
    cells = [c for c in result.collisions if c.engine in codes]
    return matrix_rows((*cells, *result.direct[1]), [*codes, *_pair_names(result)])


def matrix_rows(cells: Iterable[Cell], columns: Iterable[str]) -> list[dict]:
    """One row a combination of laws."""
    by_laws: dict[str, dict[str, str]] = {}
    for c in cells:
        by_laws.setdefault(c.laws, {})[c.engine] = c.text
    return [{"laws": laws, **{name: texts[name] for name in columns}} for laws, texts in by_laws.items()]


def codes_of(result: LawsResult) -> list[str]:
    """Return the engines that are not kernels."""
    return [e for e in result.engines if not e.startswith(KERNEL_PREFIX)]


def _pair_names(result: LawsResult) -> list[str]:
    return [f"{left} - {right}" for left, right in code_pairs(result.engines)]


def cell_rows(cells: Iterable[Cell]) -> list[dict]:
    """One row a cell, with everything it knows."""
    return [
        {"laws": c.laws, "engine": c.engine, "shown": c.shown, "deviation": c.deviation, "against": c.against or None,
         "differs": c.differs, "note": c.note, "missing": "; ".join(c.missing) or None}
        for c in cells
    ]


# --- codes against each other ----------------------------------------------------------------------


COLLISIONS = "collisions"


def direct_rows(result: LawsResult) -> list[dict]:
    """One row a combination that two codes compute: how far apart they are in each motion and in collisions."""
    found: dict[tuple[str, str, str], list[DirectCheck]] = {}
    for c in _direct(result):
        found.setdefault((c.laws, c.left, c.right), []).append(c)
    motions = dict.fromkeys(_motion(c) for checks in found.values() for c in checks)
    return [_direct_row(key, of, motions) for key, of in found.items()]


def _direct_row(key: tuple[str, str, str], checks: list[DirectCheck], motions: Iterable[str]) -> dict:
    largest: dict[str, float] = {}
    for c in checks:
        largest[_motion(c)] = max(largest.get(_motion(c), 0.0), c.deviation)
    offs = [c.off for c in checks if c.off is not None]
    return {
        "laws": key[0], "codes": f"{key[1]} - {key[2]}", **{m: largest.get(m) for m in motions},
        "unexplained": max(offs, default=None),
    }


def _direct(result: LawsResult) -> list[DirectCheck]:
    return [c for c in result.checks if isinstance(c, DirectCheck)]


def _motion(check: DirectCheck) -> str:
    """Places, velocities and spins of collisions stand together: the largest counts."""
    return COLLISIONS if check.what.startswith(COLLISIONS) else check.what


def reason_rows(result: LawsResult) -> list[dict]:
    """One row a choice in which two codes differ, with the combinations of laws that it matters to."""
    about: dict[tuple[str, str], dict[str, None]] = {}
    for c in _direct(result):
        for reason in c.reasons if c.verdict == "known_difference" else ():
            about.setdefault((f"{c.left} - {c.right}", reason), {})[c.laws] = None
    return [{"codes": codes, "differ in": reason, "laws": ", ".join(laws)} for (codes, reason), laws in about.items()]


def reach_rows(result: LawsResult) -> list[dict]:
    """One row a combination with friction, one column an engine: the largest |f_t| over Coulomb's limit in shear."""
    rows: dict[str, dict] = {}
    for r in result.reaches:
        rows.setdefault(r.laws, {"laws": r.laws, **dict.fromkeys(result.engines)})[r.engine] = r.found
    return list(rows.values())


# --- single impacts, checks ------------------------------------------------------------------------


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


# --- frames ----------------------------------------------------------------------------------------


def invariance_rows(result: LawsResult) -> list[dict]:
    """One row a combination and dimension, one column an engine: the largest change where nothing may change."""
    rows: dict[tuple[str, int], dict] = {}
    for c in result.checks:
        if isinstance(c, FrameCheck) and not c.reason:
            laws = c.quantity.partition(": ")[0]
            empty = {"laws": laws, "dimension": f"{c.dimension}D", **dict.fromkeys(result.engines)}
            row = rows.setdefault((laws, c.dimension), empty)
            row[c.left] = max(row[c.left] or 0.0, c.deviation)
    return list(rows.values())


def frame_rows(result: LawsResult) -> list[dict]:
    """One row an engine and a known reason why its answer depends on the frame."""
    found: dict[tuple[str, str], list[FrameCheck]] = {}
    for c in result.checks:
        if isinstance(c, FrameCheck) and c.reason:
            found.setdefault((c.left, c.reason), []).append(c)
    return [_frame_row(engine, reason, of) for (engine, reason), of in found.items()]


def _frame_row(engine: str, reason: str, checks: list[FrameCheck]) -> dict:
    names = [c.quantity.partition(": ") for c in checks]
    largest = max(checks, key=lambda c: c.deviation)
    return {
        "verdict": "differs" if any(c.verdict == "differs" for c in checks) else "known_difference", "engine": engine,
        "reason": reason, "motions": ", ".join(dict.fromkeys(motion for _, _, motion in names)),
        "combinations of laws": len({laws for laws, _, _ in names}), "largest change": largest.deviation,
        "the reason": "predicts" if largest.predicted else "allows", "that much": largest.tolerance,
        "off the prediction": max(c.off for c in checks),
    }


def short_frame_rows(result: LawsResult) -> list[dict]:
    """One row a reason, with the engines and motions that it is about, for people."""
    found: dict[str, list[FrameCheck]] = {}
    for c in result.checks:
        if isinstance(c, FrameCheck) and c.reason:
            found.setdefault(c.reason, []).append(c)
    return [_short_frame_row(reason, of) for reason, of in found.items()]


def _short_frame_row(reason: str, checks: list[FrameCheck]) -> dict:
    largest = max(checks, key=lambda c: c.deviation)
    return {
        "reason": reason, "engines": ", ".join(dict.fromkeys(c.left for c in checks)),
        "motions": ", ".join(dict.fromkeys(c.quantity.partition(": ")[2] for c in checks)),
        "change": largest.deviation,
        "expected": f"{'' if largest.predicted else 'at most '}{largest.tolerance:.3g}",
        "off that": max(c.off for c in checks),
    }


# --- what there is not -----------------------------------------------------------------------------


def failed_rows(result: LawsResult) -> list[dict]:
    """One row a cell whose run failed."""
    both = {"prescribed motion": result.prescribed, "collisions": result.collisions}
    return [
        {"laws": c.laws, "engine": c.engine, "where": where, "why": c.note}
        for where, cells in both.items() for c in cells if c.shown == "failed"
    ]


def missing_rows(result: LawsResult) -> list[dict]:
    """One row an engine and a reason why it does not compute something, with the laws it is about."""
    about: dict[tuple[str, str, str], list[str]] = {}
    for c in (*result.prescribed, *result.collisions):
        if c.shown in EMPTY and c.shown != "failed":
            about.setdefault((c.engine, c.shown, c.note), []).append(c.laws)
        for part in c.missing:
            about.setdefault((c.engine, "in part", part), []).append(c.laws)
    return [
        {"engine": engine, "shown": shown, "laws": ", ".join(dict.fromkeys(laws)), "why": why}
        for (engine, shown, why), laws in about.items()
    ]


def summary(result: LawsResult) -> str:
    """Return one line: how many laws and engines, how many verdicts of each kind."""
    counts = Counter(c.verdict for c in result.checks)
    verdicts = ", ".join(f"{n} {v.replace('_', ' ')}" for v, n in counts.items()) or "none could be made"
    broken = len(failed_rows(result))
    laws, engines = _counted(len(result.laws), "combination"), _counted(len(result.engines), "engine")
    failed = f"; {_counted(broken, 'cell')} failed" if broken else ""
    return f"{laws} of laws on {engines}; checks: {verdicts}{failed}"


def _counted(number: int, what: str) -> str:
    return f"{number} {what}{'s' * (number != 1)}"
