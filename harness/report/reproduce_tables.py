"""A reproduced result as tables: rows beside the talk's values, convergence, runs."""

from __future__ import annotations

from collections.abc import Callable, Hashable, Iterable, Sequence
from typing import TYPE_CHECKING, TypeVar

import numpy as np

from harness.report.matrix import SEVERITY
from harness.report.tables import csv_text
from postproc.results import headed

if TYPE_CHECKING:
    from harness.studies.reproduce.protocol import Chart, Measured, RatePoint, Row, Study, StudyRun


T = TypeVar("T")

MOST_DIGITS = 12
"""Of a number beside its error: what lies below is round-off."""


def tag(row: Row) -> str | None:
    """Say how the talk's value is known: "seen" in its source, "recalled", or "exact" for a closed form."""
    if row.talk is None:
        return None
    if row.talk.kind == "analytical":
        return "exact"
    return "seen" if row.talk.seen else "recalled"


def value_rows(rows: Sequence[Row]) -> list[dict]:
    """One row a quantity and engine, with all digits."""
    return [
        {
            "quantity": headed(r.quantity, r.unit), "engine": r.ours.engine,
            "talk": None if r.talk is None else r.talk.value, "known": tag(r),
            "ours": _number(r.ours.value), "error": r.ours.error, "packings": r.ours.packings,
            "ours - talk": r.deviation, "relative": _relative(r), "tolerance": r.tolerance, "verdict": r.verdict,
            "why": r.why, "source": None if r.talk is None else r.talk.origin,
        }
        for r in rows
    ]


def compact_rows(rows: Sequence[Row]) -> list[dict]:
    """One row a quantity, a column an engine, and the worst verdict of them with its reason: for reading.

    Without the talk's columns where no row has a value of the talk.
    """
    engines = list(dict.fromkeys(r.ours.engine for r in rows))
    held = any(r.talk is not None for r in rows)
    found = []
    for same in _together(rows, lambda r: (r.quantity, r.unit)):
        first, by_engine = same[0], {r.ours.engine: r for r in same}
        worst = max(same, key=lambda r: SEVERITY[r.verdict])
        talk = {"talk": None if first.talk is None else f"{first.talk.value:g}", "known": tag(first)} if held else {}
        found.append({
            "quantity": headed(first.quantity, first.unit), **talk,
            **{e: _said(by_engine[e].ours) if e in by_engine else None for e in engines},
            **({"verdict": worst.verdict, "why": worst.why} if held else {}),
        })
    return found


def compact_rates(points: Sequence[RatePoint]) -> list[dict]:
    """One row a quantity and setting, a column an engine: for reading."""
    engines = list(dict.fromkeys(p.ours.engine for p in points))
    found = []
    for same in _together(points, lambda p: (p.quantity, p.setting)):
        by_engine = {p.ours.engine: p.ours for p in same}
        found.append({
            "quantity": headed(same[0].quantity, same[0].unit), "setting": same[0].setting, "number": same[0].number,
            **{e: _said(by_engine[e]) if e in by_engine else None for e in engines},
        })
    return found


def _together(items: Iterable[T], key: Callable[[T], Hashable]) -> list[list[T]]:
    """Return the items of one key together, keys in the order in which they first occur."""
    found: dict[Hashable, list[T]] = {}
    for item in items:
        found.setdefault(key(item), []).append(item)
    return list(found.values())


def _said(ours: Measured) -> str:
    """Write a number with its error, if there is one: with the digits that the error speaks of, four at least."""
    if not np.isfinite(ours.value):
        return "not known"
    if not ours.error or not np.isfinite(ours.error) or not ours.value:
        return f"{ours.value:.4g}" if not ours.error else f"{ours.value:.4g} ± {ours.error:.2g}"
    digits = int(np.floor(np.log10(abs(ours.value))) - np.floor(np.log10(abs(ours.error)))) + 2
    return f"{ours.value:.{min(max(digits, 4), MOST_DIGITS)}g} ± {ours.error:.2g}"


def rate_rows(points: Sequence[RatePoint]) -> list[dict]:
    """One row a setting; the change is that from the setting before, of the same quantity and engine."""
    rows, before = [], {}
    for p in points:
        key = (p.quantity, p.ours.engine)
        rows.append({
            "quantity": headed(p.quantity, p.unit), "engine": p.ours.engine, "setting": p.setting, "number": p.number,
            "ours": _number(p.ours.value), "error": p.ours.error, "packings": p.ours.packings,
            "change": _change(before.get(key), p.ours), "error of the change": _change_error(before.get(key), p.ours),
        })
        before[key] = p.ours
    return rows


def study_rows(studies: Sequence[Study]) -> list[dict]:
    """One row a study and size, for `--list`."""
    return [
        {
            "name": s.name, "size": size, "packings": d.packings, "computes": d.says, "title": s.title,
            "engines": ", ".join(s.engines), "lacking": ", ".join(s.lacking) or None, "the talk says": s.claim,
            "source": s.source,
        }
        for s in studies for size, d in s.sizes.items()
    ]


def run_rows(runs: Sequence[StudyRun]) -> list[dict]:
    """One row a run."""
    return [
        {
            "case": r.case, "engine": r.engine, "packing": r.packing + 1, "status": r.outcome.status,
            "particles": r.outcome.particles, "steps": r.outcome.steps, "CPU (s)": r.outcome.cpu_seconds,
            "reason": r.outcome.reason or None,
        }
        for r in runs
    ]


def chart_csv(chart: Chart, *, digits: int = 17) -> str:
    """Return the numbers of a chart: one row a point, with the line it belongs to."""
    def short(value: float) -> float:
        return float(f"{value:.{digits}g}")

    return csv_text([
        {"line": line.name, "engine": line.engine or None, chart.x: short(x), chart.y: short(y),
         "error": None if e is None else short(e)}
        for line in chart.lines
        for x, y, e in zip(line.x, line.y, _errors(line), strict=True)
    ])


def _errors(line) -> list[float | None]:
    return [None] * len(line.x) if line.error is None else [float(e) for e in line.error]


def _number(value: float) -> float | None:
    return value if np.isfinite(value) else None


def _relative(row: Row) -> float | None:
    return None if row.talk is None or row.deviation is None else row.deviation / abs(row.talk.value)


def _change(before: Measured | None, now: Measured) -> float | None:
    return None if before is None else _number(now.value - before.value)


def _change_error(before: Measured | None, now: Measured) -> float | None:
    """Return the standard error: of differences packing by packing where both have the same ones, else of both."""
    if before is None or before.error is None or now.error is None:
        return None
    if len(before.values) == len(now.values) > 1:
        return float(np.std(np.subtract(now.values, before.values), ddof=1) / np.sqrt(len(now.values)))
    return float(np.hypot(before.error, now.error))
