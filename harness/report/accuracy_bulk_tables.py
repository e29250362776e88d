"""Rows of the bulk accuracy report: with all digits for CSV and JSON, the same for people."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

import numpy as np

from harness.report.accuracy_tables import BEYOND, percent
from harness.studies.accuracy.bulk_quantities import BULK
from harness.studies.accuracy.bulk_result import cheapest, front
from harness.studies.accuracy.limit import standard_error
from harness.studies.accuracy.result import TARGETS

if TYPE_CHECKING:
    from harness.studies.accuracy.bulk import BulkAccuracy
    from harness.studies.accuracy.bulk_result import Ladder, Offer, Rung

EVERY = "every"
"""Engine of a budget row that is the cheapest of all engines."""


def bulk_tables(done: BulkAccuracy) -> dict[str, list[dict]]:
    """Return rows by table name."""
    return {
        "budget": budget_rows(done), "orders": order_rows(done), "floor": floor_rows(done),
        "front": front_rows(done), "rungs": rung_rows(done),
    }


def shown_budget(done: BulkAccuracy) -> list[dict]:
    """Return the rows of the cheapest engine only: what the page shows."""
    return [{k: v for k, v in row.items() if k != "of"} for row in budget_rows(done) if row["of"] == EVERY]


def budget_rows(done: BulkAccuracy) -> list[dict]:
    """Return a row a target and knob: the cheapest engine's setting, then one for each engine."""
    rows = []
    for target in TARGETS:
        for knob in done.knobs:
            ladders = [la for la in done.ladders if la.knob.name == knob]
            offers = [(la, offer_of(done, la, target)) for la in ladders]
            found = [o for _, o in offers if o.rung is not None]
            best = min(found, key=lambda o: o.rung.seconds) if found else offers[0][1]
            rows.append(_budget_row(done, knob, EVERY, best))
            rows += [_budget_row(done, knob, la.engine, o) for la, o in offers]
    return rows


def offer_of(done: BulkAccuracy, ladder: Ladder, target: float) -> Offer:
    """Return the cheapest setting of a knob on an engine that keeps the asked quantity's error below a target."""
    return cheapest(ladder, done.quantity, target, done.floors.get((ladder.engine, done.quantity)))


def _budget_row(done: BulkAccuracy, knob: str, of: str, offer: Offer) -> dict:
    row = {"error below": offer.target, "knob": knob, "of": of}
    if offer.rung is None:
        return row | {
            "cheapest": None, "setting": None, "error": None, "+-": None, "CPU (s)": None,
            "times faster than declared": None, "gives up": offer.why,
        }
    own = offer.ladder.own
    faster = None if own is None or not own.seconds or not offer.rung.seconds else own.seconds / offer.rung.seconds
    return row | {
        "cheapest": offer.ladder.engine, "setting": offer.rung.label, "error": offer.error.size,
        "+-": offer.error.bar, "CPU (s)": offer.rung.seconds, "times faster than declared": faster,
        "gives up": gives_up(offer.ladder, offer.rung, done.quantity) + above(done, offer),
    }


def above(done: BulkAccuracy, offer: Offer) -> str:
    """Say that packings scatter by more than the target, so that the setting alone does not bring it; "" if not."""
    floor = done.floors.get((offer.ladder.engine, done.quantity))
    if floor is None or floor.mean <= offer.target:
        return ""
    return (
        f"; the {done.quantity} itself, mean over packings, is known to {percent(floor.mean)} only: "
        f"{floor.needed(offer.target)} packings would do"
    )


def gives_up(ladder: Ladder, rung: Rung, quantity: str) -> str:
    """Say how far the other quantities are off at a setting: those whose error stands out of the noise."""
    told = []
    for name in ladder.scales:
        error = ladder.error(rung, name)
        if name != quantity and error is not None and error.seen:
            told.append(f"{name} off by {percent(error.size)}")
    return "; ".join(told) or "nothing that stands out of the noise"


def order_rows(done: BulkAccuracy) -> list[dict]:
    """Return a row a knob, engine and quantity: the order, what time buys, and the limit with its error bar."""
    return [
        _order_row(done, la, name) for la in done.ladders if not la.knob.words for name in la.scales
    ]


def _order_row(done: BulkAccuracy, ladder: Ladder, name: str) -> dict:
    order, limit, price = ladder.orders.get(name), ladder.limits.get(name), time_exponent(ladder)
    slope = None if order is None or price is None else -order.value / price
    return {
        "knob": ladder.knob.name, "engine": ladder.engine, "quantity": name,
        "order": order.value if order else None, "standard error": order.error if order else None,
        "no order, because": ladder.orderless.get(name) or None,
        "expected": ladder.knob.expected, "slope of error against time": slope,
        "its standard error": None if slope is None else order.error / price,
        "limit": None if limit is None else mean_of(limit.value),
        "limit +-": None if limit is None else mean_of(limit.bar),
        "unit": next(b.unit for b in BULK[type(done.scene)] if b.name == name),
        "limit is": None if limit is None else limit.state, "how": "no two rungs" if limit is None else limit.says,
    }


def time_exponent(ladder: Ladder) -> float | None:
    """Return q in time ~ x^-q over the rungs that have a time; None where the knob changes no run, or is of words."""
    timed = [(r.x, r.seconds) for r in ladder.rungs if r.seconds]
    if ladder.knob.words or len({x for x, _ in timed}) < 2 or len({s for _, s in timed}) < 2:
        return None
    x, seconds = np.log(np.array(timed).T)
    return float(-np.polyfit(x, seconds, 1)[0])


def mean_of(values: np.ndarray) -> float:
    """Return a number as it is, of a curve the root mean square."""
    return float(values[0]) if len(values) == 1 else float(np.sqrt((values**2).mean()))


def floor_rows(done: BulkAccuracy) -> list[dict]:
    """Return a row an engine and quantity: value at the scene's own setting and its scatter over packings."""
    return [
        {"engine": engine, "quantity": name, "value": f.value, "unit": f.unit, "scatter of one packing": f.spread,
         "of their mean": f.mean, "packings": f.packings, "packings for 1 %": f.needed(0.01)}
        for (engine, name), f in done.floors.items()
    ]


def front_rows(done: BulkAccuracy) -> list[dict]:
    """Return a row a setting than which no other is both faster and better, all knobs together."""
    return [
        {"engine": la.engine, "knob": la.knob.name, "setting": r.label, "CPU (s)": r.seconds, "whole error": e.size,
         "+-": e.bar}
        for la, r, e in front(done.ladders, done.quantity)
    ]


def rung_rows(done: BulkAccuracy) -> list[dict]:
    """Return a row a rung and engine: the asked quantity, its error, times, fate."""
    return [_rung_row(done, la, r) for la in done.ladders for r in la.rungs]


def _rung_row(done: BulkAccuracy, ladder: Ladder, rung: Rung) -> dict:
    name = done.quantity
    error, values = ladder.error(rung, name), rung.values.get(name)
    value, scatter, count = value_of(values)
    column = column_of(done)
    return {
        "knob": ladder.knob.name, "engine": ladder.engine, "setting": rung.label, "status": rung.status,
        BEYOND: rung.beyond, column: value, f"{column} +-": scatter, "packings": count,
        "error": error.size if error else None, "error +-": error.bar if error else None,
        "CPU (s)": rung.seconds, "least (s)": min(rung.each, default=None), "largest (s)": max(rung.each, default=None),
        "set-up (s)": rung.setup, "output (s)": rung.output, "particles": rung.particles,
        "dt (s)": rung.dt if np.isfinite(rung.dt) else None, "steps": rung.steps,
        "reason": rung.reason or _lacks(rung, name, len(rung.each)),
    }


def column_of(done: BulkAccuracy) -> str:
    """Return the asked quantity as the head of a column, its unit beside it."""
    unit = next(b.unit for b in BULK[type(done.scene)] if b.name == done.quantity)
    return done.quantity if unit == "1" else f"{done.quantity} ({unit})"


def value_of(values: np.ndarray | None) -> tuple[float | None, float | None, int]:
    """Return mean over packings (of a curve its rms), standard error, and how many packings have it."""
    if values is None:
        return None, None, 0
    found = values[np.isfinite(values).all(axis=1)]
    return mean_of(found.mean(axis=0)), mean_of(standard_error(found)), len(found)


def _lacks(rung: Rung, name: str, packings: int) -> str:
    if not rung.good:
        return ""
    have = value_of(rung.values.get(name))[2]
    return "" if have == packings else f"{packings - have} of {packings} packings have no {name}"


# --- for programs --------------------------------------------------------------------------------------


def data_rows(done: BulkAccuracy) -> Iterator[dict]:
    """Yield one row a knob, rung, engine and quantity; see `harness.report.accuracy_bulk.bulk_data`."""
    for ladder in done.ladders:
        others = [o for o in done.ladders if o.engine == ladder.engine and o is not ladder and not o.knob.words]
        for name in (b.name for b in BULK[type(done.scene)]):
            for rung in ladder.rungs:
                yield _measured_row(done, ladder, rung, name, others)
            limit = ladder.limits.get(name)
            if limit is not None:
                yield _extrapolated_row(done, ladder, name, limit)


def _common(done: BulkAccuracy, ladder: Ladder, name: str) -> dict:
    floor = done.floors.get((ladder.engine, name))
    return {
        "scene": done.scene_file.name, "knob": ladder.knob.name, "knob_value": ladder.knob.value,
        "engine": ladder.engine, "quantity": name, "scale": ladder.scales.get(name),
        "unit": next(b.unit for b in BULK[type(done.scene)] if b.name == name),
        "floor": floor.mean if floor else None, "spread": floor.spread if floor else None,
    }


def _measured_row(done: BulkAccuracy, ladder: Ladder, rung: Rung, name: str, others: list[Ladder]) -> dict:
    values, error = rung.values.get(name), ladder.error(rung, name)
    whole = ladder.whole_error(rung, name, others)
    mean, scatter, count = value_of(values)
    return _common(done, ladder, name) | {
        "kind": "measured", "value": rung.value, "setting": rung.label, "x": rung.x, "declared": rung.own,
        "status": rung.status, "reason": rung.reason, "mean": mean, "mean_error": scatter, "packings": count,
        "error": error.size if error else None, "error_bar": error.bar if error else None,
        "signed_error": error.signed if error else None, "seen": error.seen if error else None,
        "whole_error": whole.size if whole else None, "whole_error_bar": whole.bar if whole else None,
        "cpu_seconds": rung.seconds, "cpu_seconds_each": list(rung.each), "setup_seconds": rung.setup,
        "output_seconds": rung.output, "beyond_limit": rung.beyond, "dt": rung.dt if np.isfinite(rung.dt) else None,
        "steps": rung.steps, "particles": rung.particles, "each": None if values is None else _each(values),
    }


def _each(values: np.ndarray) -> list:
    """Return numbers by packing (lists of curves), None where a packing has none."""
    told = [v.tolist() if np.isfinite(v).all() else None for v in values]
    return [v[0] if v is not None and len(v) == 1 else v for v in told]


def _extrapolated_row(done: BulkAccuracy, ladder: Ladder, name: str, limit) -> dict:
    order, scale = ladder.orders.get(name), ladder.scales.get(name)
    bar = mean_of(limit.bar)
    return _common(done, ladder, name) | {
        "kind": "extrapolated", "value": None, "setting": "limit", "x": 0.0, "state": limit.state, "how": limit.says,
        "mean": mean_of(limit.value), "mean_error": bar, "packings": len(limit.packings),
        "error_bar": bar / scale if scale else None, "order_used": limit.order,
        "order": order.value if order else None, "order_error": order.error if order else None,
    }
