"""Rows of the accuracy report: with all digits for CSV and JSON, the same for people."""

from __future__ import annotations

from typing import TYPE_CHECKING

from harness.studies.accuracy.result import TARGETS, best, cheapest, front

if TYPE_CHECKING:
    from harness.studies.accuracy.fit import Fit
    from harness.studies.accuracy.result import Point, Track
    from harness.studies.accuracy.study import Accuracy

BEYOND = "beyond the scene's limit of"
"""Column of the largest dt_fraction that the scene takes; empty for rungs that keep to it."""

VAGUE = 0.25
"""Standard error of an order beyond which it tells first from second order no more."""

NOT_SYMPLECTIC = "energy drifts over many collisions without damping"
"""What the second-order scheme gives up."""


def tables(accuracy: Accuracy) -> dict[str, list[dict]]:
    """Return rows by table name."""
    return {
        "budget": budget_rows(accuracy), "slopes": slope_rows(accuracy), "front": front_rows(accuracy),
        "points": point_rows(accuracy), "costs": cost_rows(accuracy), "oracles": oracle_rows(accuracy),
    }


def budget_rows(accuracy: Accuracy) -> list[dict]:
    """One row a target for all engines together, and one for each: the cheapest setting and what it gives up."""
    rows = []
    for target in TARGETS:
        choice = best(accuracy.declared, accuracy.asked.quantity, target)
        rows.append(_budget_row(accuracy, target, "all", choice.track, choice.point))
        for track in accuracy.declared:
            point = cheapest(track, accuracy.asked.quantity, target)
            rows.append(_budget_row(accuracy, target, track.engine, track, point))
    return rows


def _budget_row(accuracy: Accuracy, target: float, of: str, track: Track | None, point: Point | None) -> dict:
    if track is None or point is None:
        return {
            "error below": target, "of": of, "cheapest": None, "dt_fraction": None, "steps": None, "error": None,
            "CPU (ms)": None, "times faster than the scene's step": None, "gives up": "no timed rung does",
        }
    return {
        "error below": target, "of": of, "cheapest": track.engine, "dt_fraction": point.value, "steps": point.steps,
        "error": point.size(accuracy.asked.quantity), "CPU (ms)": 1e3 * point.seconds,
        "times faster than the scene's step": point.value / own_step(accuracy, track),
        "gives up": gives_up(track, point),
    }


def is_own(accuracy: Accuracy, point: Point) -> bool:
    """Whether the scene's own step was asked for on this rung."""
    return abs(point.rung / accuracy.scene.numerics.dt_fraction - 1.0) < 1e-9


def own_step(accuracy: Accuracy, track: Track) -> float:
    """Return the dt_fraction that ran for the scene's own step; as declared where the ladder does not have it."""
    ran = (p.value for p in track.points if is_own(accuracy, p))
    return next(ran, accuracy.scene.numerics.dt_fraction)


def gives_up(track: Track, point: Point) -> str:
    """Say what a setting costs in digits, and what else comes with its engine."""
    off = [f"{q} {percent(point.size(q))}" for q in point.errors if q != "exit"]
    words = [f"{', '.join(off)} of the impact's speed", f"{1.0 / point.value:.3g} steps a contact"]
    if track.engine.endswith(":corrected"):
        words.append(NOT_SYMPLECTIC)
    return "; ".join(words)


def slope_rows(accuracy: Accuracy) -> list[dict]:
    """One row a case, engine and quantity: p in error ~ dt^p with its standard error, or why there is none."""
    return [
        {"case": t.case, "engine": t.engine, "quantity": q, "slope": fit.slope if fit else None,
         "standard error": fit.error if fit else None, "rungs": fit.rungs if fit else None,
         "why": _why(t, q, fit)}
        for t in accuracy.tracks for q, fit in t.fits.items()
    ]


def _why(track: Track, quantity: str, fit: Fit | None) -> str:
    """Say why there is no order, or why one tells little; "" of one that is known."""
    if fit is None:
        return f"no order: {track.why_no_fit(quantity)}"
    if fit.error <= VAGUE:
        return ""
    sizes = [p.size(quantity) for p in track.known(quantity) if p.resolved]
    bends = ", as the error does not fall from rung to rung" if sizes != sorted(sizes, reverse=True) else ""
    return f"standard error above {VAGUE:g}{bends}: first and second order cannot be told apart"


def front_rows(accuracy: Accuracy) -> list[dict]:
    """One row a setting than which no other is both faster and better."""
    quantity = accuracy.asked.quantity
    return [
        {"engine": t.engine, "dt_fraction": p.value, "steps": p.steps, "CPU (ms)": 1e3 * p.seconds,
         "error": p.size(quantity)}
        for t, p in front(accuracy.declared, quantity)
    ]


def point_rows(accuracy: Accuracy) -> list[dict]:
    """One row a rung: error of the asked quantity with its range over phases, the others' errors, time, fate."""
    return [_point_row(accuracy, t, p) for t in accuracy.tracks for p in t.points]


def _point_row(accuracy: Accuracy, track: Track, point: Point) -> dict:
    quantity = accuracy.asked.quantity
    low, high = point.range(quantity) if quantity in point.errors else (None, None)
    sizes = {q: point.size(q) if q in point.errors else None for q in ("exit", "velocity", "spin")}
    return {
        "case": track.case, "engine": track.engine, "rung": point.rung, "dt_fraction": point.value, "dt (s)": point.dt,
        "steps": point.steps, "status": point.status, BEYOND: point.beyond, **sizes,
        f"{quantity}, 10 % of phases below": low,
        f"{quantity}, 90 % of phases below": high, "CPU (ms)": None if point.seconds is None else 1e3 * point.seconds,
        "reason": point.reason,
    }


def cost_rows(accuracy: Accuracy) -> list[dict]:
    """One row a case and engine: a step, the set-up of the session, and the whole process of its finest run."""
    return [_cost_row(t) for t in accuracy.tracks]


def _cost_row(track: Track) -> dict:
    cost, us = track.cost, [1e6 * s for s in track.cost.seconds]
    finest = next((p for p in reversed(track.points) if p.process_seconds is not None), None)
    return {
        "case": track.case, "engine": track.engine, "CPU per step (us)": None if not us else 1e6 * cost.step,
        "least (us)": min(us, default=None), "largest (us)": max(us, default=None), "repeats": len(us),
        "steps timed": cost.steps, "set-up, CPU (ms)": 1e3 * sorted(cost.setup)[len(us) // 2] if us else None,
        "process of the finest run, CPU (ms)": 1e3 * finest.process_seconds if finest else None, "reason": cost.reason,
    }


def oracle_rows(accuracy: Accuracy) -> list[dict]:
    """One row a case and engine: what errors are measured against, how well that is known, how far laws are apart."""
    quantity = accuracy.asked.quantity
    return [
        {"case": t.case, "engine": t.engine, "oracle": t.oracle_says, "its error": t.oracle.get(quantity),
         "round-off in it": t.round_off, "growth of a disturbance": t.growth,
         "limit from that of the talks' laws": t.parted.get(quantity)}
        for t in accuracy.tracks
    ]


def percent(value: float) -> str:
    """Write a share for people.

    >>> percent(0.01234)
    '1.2 %'
    """
    return f"{100.0 * value:.2g} %"
