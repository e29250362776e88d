"""The numbers of two reports beside each other: curves sample by sample, and quantities with their scatter."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from postproc.results import headed

Row = Mapping[str, Any]
Tables = Mapping[str, Sequence[Row]]

FOLLOWED = 1e-9
"""Difference over the largest value within which two curves are called one: a thousand times what rounding does in
one step, and a millionth of what chaos ends with."""

PLACES = ("strain", "time (s)")
"""Columns that say where a row stands, the first that a table has."""

NOT_CURVES = ("runs", "macro", "phases")
"""Tables with an engine in each row whose rows are no samples."""


def curve_changes(old: Tables, new: Tables, names: Mapping[str, str]) -> list[dict]:
    """Return a row for every table and engine in both: the column that changed most, and to where all are the same.

    names: new names of old engines. Of engines with other samples than before nothing can be said but that.
    """
    shared = [t for t in new if t in old and t not in NOT_CURVES and new[t] and "engine" in new[t][0]]
    rows = []
    for table in shared:
        before, after = _by_engine(old[table], names), _by_engine(new[table], {})
        rows += [_curve_row(table, e, before[e], after[e]) for e in after if e in before]
    return rows


def _curve_row(table: str, engine: str, old: Sequence[Row], new: Sequence[Row]) -> dict:
    row = {"engine": engine, "table": table, "samples": len(new), "largest in": None, "difference over largest": None}
    if len(old) != len(new):
        return {**row, f"same within {FOLLOWED:g} up to": f"not comparable: {len(old)} samples before"}
    deviations = {c: _deviation(old, new, c) for c in new[0] if c in old[0] and _numeric(old, new, c)}
    worst = max(deviations, key=lambda c: deviations[c].max(), default=None)
    if worst is None:
        return {**row, f"same within {FOLLOWED:g} up to": "nothing to compare"}
    apart = np.max(list(deviations.values()), axis=0)
    return {
        **row, "largest in": worst if apart.max() > 0 else None, "difference over largest": float(apart.max()),
        f"same within {FOLLOWED:g} up to": _until(new, apart),
    }


def _numeric(old: Sequence[Row], new: Sequence[Row], column: str) -> bool:
    """Whether a column holds numbers, or nothing where there was none, and at least one number on both sides."""
    values = [[r.get(column) for r in rows] for rows in (old, new)]
    plain = all(v is None or (isinstance(v, int | float) and not isinstance(v, bool)) for of in values for v in of)
    return plain and all(any(v is not None for v in of) for of in values)


def _deviation(old: Sequence[Row], new: Sequence[Row], column: str) -> np.ndarray:
    """Return |a - b| over the largest |value|, (S,); 1 where only one of them is a number, 0 where none is."""
    a, b = (np.array([np.nan if r.get(column) is None else r[column] for r in rows], float) for rows in (old, new))
    largest = float(np.nanmax(np.abs([a, b])))
    apart = np.abs(a - b) / (largest or 1.0)
    return np.where(np.isnan(a) & np.isnan(b), 0.0, np.where(np.isnan(apart), 1.0, apart))


def _until(rows: Sequence[Row], apart: np.ndarray) -> str:
    """Say the last place before the first row that is not the same."""
    wrong = np.flatnonzero(~(apart <= FOLLOWED))
    if not wrong.size:
        return "the end"
    if wrong[0] == 0:
        return "nowhere"
    place = next((p for p in PLACES if isinstance(rows[0].get(p), float)), None)
    last = wrong[0] - 1
    return f"row {last + 1} of {len(rows)}" if place is None else f"{place} {rows[last][place]:.4g}"


def _by_engine(rows: Sequence[Row], names: Mapping[str, str]) -> dict[str, list[Row]]:
    found: dict[str, list[Row]] = {}
    for r in rows:
        found.setdefault(names.get(r["engine"], r["engine"]), []).append(r)
    return found


def macro_changes(old: Tables, new: Tables, names: Mapping[str, str]) -> list[dict]:
    """Return a row for every macroscopic number of an engine that is not the same to `FOLLOWED`.

    The standard error of the difference is sqrt(s_old^2/n_old + s_new^2/n_new) over packings, as of independent
    samples; None with a single packing on a side.
    """
    before = {(r["quantity"], names.get(r["engine"], r["engine"])): r for r in old.get("macro", ())}
    pairs = ((before[k], r) for r in new.get("macro", ()) if (k := (r["quantity"], r["engine"])) in before)
    return [_macro_row(a, b) for a, b in pairs if _changed(a["mean"], b["mean"])]


def _changed(a: float | None, b: float | None) -> bool:
    if a is None or b is None:
        return a is not b
    return not abs(a - b) <= FOLLOWED * max(abs(a), abs(b))


def _macro_row(old: Row, new: Row) -> dict:
    known = None not in (old["mean"], new["mean"])
    apart = new["mean"] - old["mean"] if known else None
    spread = [r["standard deviation"] for r in (old, new)]
    error = None
    if None not in spread:
        error = float(np.hypot(*(s / np.sqrt(r["packings"]) for s, r in zip(spread, (old, new), strict=True))))
    return {
        "quantity": headed(new["quantity"], new["unit"]), "engine": new["engine"], "old": old["mean"],
        "new": new["mean"], "new - old": apart, "its standard error": error,
        "packings, old": old["packings"], "packings, new": new["packings"],
    }
