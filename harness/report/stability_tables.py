"""Rows of the stability report: how every case ended on every engine, and what every invariant was."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING

from harness.report.matrix import Cell, Line, Matrix
from harness.report.tables import text
from harness.studies.stability.judge import worst

if TYPE_CHECKING:
    from harness.studies.stability.cases import Case
    from harness.studies.stability.judge import Held, Result
    from harness.studies.stability.study import Stability

TABLES = ("outcomes", "invariants", "cases")


def tables(stability: Stability) -> dict[str, list[dict]]:
    """Return rows by table name."""
    return {
        "outcomes": outcome_rows(stability), "invariants": invariant_rows(stability),
        "cases": case_rows(stability.cases),
    }


def outcome_rows(stability: Stability) -> list[dict]:
    """One row a case and engine."""
    return [
        {
            "case": r.case, "engine": r.engine, "outcome": r.ended, "declared": r.expected,
            "as declared": "yes" if r.as_declared else "no", "reason": r.reason, "declared because": r.known,
            "steps": r.steps or None, "CPU (s)": r.seconds, "rerun": r.reproduce,
        }
        for r in stability.results
    ]


def invariant_rows(stability: Stability) -> list[dict]:
    """One row an invariant of a run; a size that was not measured is left empty."""
    return [
        {
            "case": r.case, "engine": r.engine, "invariant": h.invariant, "size": h.size, "tolerance": h.tolerance,
            "meaningless beyond": h.ruin, "holds": _holds(h), "what it is": h.says,
        }
        for r in stability.results for h in r.held
    ]


def case_rows(cases: Sequence[Case]) -> list[dict]:
    """One row a case: what it is, why it is hard, what is promised."""
    return [
        {
            "case": c.name, "title": c.title, "topics": ", ".join(c.expect.topics), "hard because": c.expect.why,
            "promised": "; ".join(f"{i.name} <= {i.tolerance:g}: {i.reason}" for i in c.expect.invariants)
            or f"refused: {c.expect.refused}",
        }
        for c in cases
    ]


def outcome_table(stability: Stability) -> list[dict]:
    """One row a case, a column an engine: the table for a terminal."""
    return [
        {"case": c.name, **{e: _words(stability.of(c.name, e)) for e in stability.engines}} for c in stability.cases
    ]


def count_rows(stability: Stability) -> list[dict]:
    """How many cases ended how, an engine a row."""
    words = (
        "stable", "degraded", "failed_loudly", "failed_silently", "timed_out", "refused", "unsupported", "unavailable",
    )
    ended = {e: [r.ended for r in stability.results if r.engine == e] for e in stability.engines}
    return [{"engine": e, **{w.replace("_", " "): found.count(w) for w in words}} for e, found in ended.items()]


def outcome_matrix(stability: Stability) -> Matrix:
    """Return the matrix of the page: cases down, engines across."""
    rows = (
        Line(level="", quantity=c.name, cells=tuple(_cell(stability.of(c.name, e)) for e in stability.engines))
        for c in stability.cases
    )
    return Matrix(title="Cases and codes", columns=tuple((e,) for e in stability.engines), rows=tuple(rows))


def note(result: Result) -> str:
    """Return what stands beside the word: the invariant that says most, with its size."""
    bad = worst(result.held)
    if bad is not None:
        return f"{bad.invariant} {text(bad.size)} > {text(bad.tolerance)}"
    near = nearest_limit(result.held)
    return "" if near is None else f"{near.invariant} {text(near.size)} of {text(near.tolerance)}"


def broken(result: Result) -> bool:
    """Whether a run that came to its end, or seemed to, is not what was promised."""
    return result.ended in ("degraded", "failed_silently")


def share(result: Result) -> float | None:
    """Return how much of its tolerance the invariant used that says most; of a broken case the one that broke.

    Infinite where the tolerance is 0, the size is no number, or no invariant could be measured at all. None of a run
    that was refused or ended early, and where no tolerance is above 0.
    """
    if broken(result):
        bad = worst(result.held)
        return math.inf if bad is None else bad.excess
    near = nearest_limit(result.held)
    return None if near is None else near.excess


def nearest_limit(held: Sequence[Held]) -> Held | None:
    """Return the invariant that uses most of its tolerance; those with a tolerance of 0 have no share."""
    shares = [h for h in held if h.size is not None and h.tolerance > 0 and math.isfinite(h.size)]
    return max(shares, key=lambda h: h.excess, default=None)


def _cell(result: Result) -> Cell:
    unexpected = "" if result.as_declared else f"declared {result.expected.replace('_', ' ')}; "
    return Cell(verdict=result.ended, note=unexpected + note(result))


def _words(result: Result) -> str:
    words = result.ended.replace("_", " ")
    return words if result.as_declared else f"{words} (declared {result.expected.replace('_', ' ')})"


def _holds(held: Held) -> str:
    if held.size is None:
        return "not measured"
    return "no" if held.broken else "yes"
