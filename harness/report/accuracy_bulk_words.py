"""What bulk ladders say, in plain words made from their numbers."""

from __future__ import annotations

from typing import TYPE_CHECKING

from harness.report.accuracy_bulk_tables import EVERY, budget_rows, time_exponent
from harness.report.accuracy_tables import percent
from harness.studies.accuracy.bulk_quantities import BULK
from harness.studies.accuracy.bulk_result import front
from harness.studies.accuracy.result import TARGETS

if TYPE_CHECKING:
    from harness.studies.accuracy.bulk import BulkAccuracy
    from harness.studies.accuracy.bulk_result import Ladder, Rung


def bulk_paragraph(done: BulkAccuracy) -> str:
    """Return the findings, a sentence each, leaving out what was not found."""
    sentences = [
        _floor(done), *(_knob(done, knob) for knob in done.knobs), *(_budget(done, t) for t in TARGETS), _front(done),
        _beyond(done), _failed(done), _lacking(done), _own(done),
    ]
    return " ".join(s for s in sentences if s)


def what(done: BulkAccuracy) -> str:
    """Return the asked quantity in words."""
    return next(b.says for b in BULK[type(done.scene)] if b.name == done.quantity)


def _floor(done: BulkAccuracy) -> str:
    floors = [(e, f) for (e, name), f in done.floors.items() if name == done.quantity]
    if not floors:
        return f"No setting gives the {what(done)} on two packings: there is no error to tell."
    told = ", ".join(
        f"{e} {f.value:.4g}{_unit(f.unit)} ({percent(f.spread)}, {f.packings} packings)" for e, f in floors
    )
    most = max(f.mean for _, f in floors)
    return (
        f"{what(done).capitalize()} at the scene's own setting, with the scatter of one packing: {told}. The mean over "
        f"packings is known to {percent(most)}: below that no knob buys anything, more packings do."
    )


def _unit(unit: str) -> str:
    return "" if unit == "1" else f" {unit}"


def _knob(done: BulkAccuracy, knob: str) -> str:
    ladders = [la for la in done.ladders if la.knob.name == knob]
    told = [t for la in ladders if (t := _ladder(done, la))]
    return f"{knob.capitalize()}: {'; '.join(told)}." if told else ""


def _ladder(done: BulkAccuracy, ladder: Ladder) -> str:
    known = ladder.known(done.quantity)
    if not known:
        return ""
    if ladder.knob.words:
        return f"{ladder.engine} {', '.join(_off(r.label, e) for r, e in known if not r.own)}"
    rung, error = next(((r, e) for r, e in known if r.beyond is None), known[0])
    if all(e.size == 0.0 and e.bar == 0.0 for _, e in known):
        return f"{ladder.engine} does not depend on it"
    order = ladder.orders.get(done.quantity)
    if order is not None and order.error <= 0.5 * order.value:
        price = time_exponent(ladder)
        buys = "" if price is None else f", slope {-order.value / price:.2f} against time"
        falls = f"falling with order {order.value:.2f} ± {order.error:.2f}{buys}"
        return f"{ladder.engine} {_off(rung.label, error)}, {falls}"
    return f"{ladder.engine} {_off(rung.label, error)}"


def _off(label: str, error) -> str:
    if not error.seen:
        return f"at {label} shows no error above {percent(error.most)}"
    return f"at {label} is off by {percent(error.size)} ± {percent(error.bar)}"


def _budget(done: BulkAccuracy, target: float) -> str:
    rows = [r for r in budget_rows(done) if r["of"] == EVERY and r["error below"] == target]
    found = [r for r in rows if r["cheapest"] is not None and r["times faster than declared"] not in (None, 1.0)]
    if not any(r["cheapest"] for r in rows):
        return f"Below {percent(target)} nothing can be promised with {done.packings} packings."
    best = max(found, key=lambda r: r["times faster than declared"], default=None)
    if best is None or best["times faster than declared"] < 1.0:
        return ""
    return (
        f"For {percent(target)} the most time is saved by {best['knob']} = {best['setting']} "
        f"({best['cheapest']}, {best['CPU (s)']:.2g} s a test, {best['times faster than declared']:.2g} times faster)."
    )


def _front(done: BulkAccuracy) -> str:
    points = front(done.ladders, done.quantity)
    if not points:
        return ""
    told = ", ".join(
        f"{la.engine} with {la.knob.name} = {r.label} ({r.seconds:.2g} s, {percent(e.size)} ± {percent(e.bar)})"
        for la, r, e in points
    )
    return f"On the front of all knobs together: {told}."


def _beyond(done: BulkAccuracy) -> str:
    """Name the steps that no scene can have, by knob."""
    sentences = []
    for knob in done.knobs:
        found = [r for la in done.ladders if la.knob.name == knob for r in la.rungs if r.beyond is not None]
        if found:
            labels = ", ".join(dict.fromkeys(r.label for r in found))
            sentences.append(
                f"{knob.capitalize()} = {labels}: beyond the scene's limit of {found[0].beyond:.3g}, so measured and "
                "shown, but in no budget and on no front."
            )
    return " ".join(sentences)


def _failed(done: BulkAccuracy) -> str:
    told = [f"{la.knob.name} = {r.label} on {la.engine} ({_fate(r)})" for la in done.ladders for r in la.rungs
            if r.status not in ("completed", "unavailable", "unsupported")]
    return f"No answer: {', '.join(told)}." if told else ""


def _fate(rung: Rung) -> str:
    return f"{rung.status}: {rung.reason}" if rung.reason else rung.status


def _lacking(done: BulkAccuracy) -> str:
    lacking = [f"{la.knob.name} = {r.label} on {la.engine}" for la in done.ladders for r in la.rungs
               if r.good and done.quantity not in r.values]
    return f"Without a {what(done)} on two packings: {', '.join(lacking)}." if lacking else ""


def _own(done: BulkAccuracy) -> str:
    if done.own_share is None:
        return f"All {done.runs} runs were there already."
    return (
        f"{done.runs - done.kept} of {done.runs} runs were made in {done.wall_seconds / 60:.1f} minutes; the study "
        f"itself took {percent(done.own_share)} of all CPU time, making packings {done.packing_seconds:.2g} s besides."
    )
