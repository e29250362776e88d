"""Rows of advice: with all digits for CSV and JSON, the same for people."""

from __future__ import annotations

from typing import TYPE_CHECKING

from harness.studies.advise.choose import EFFECTS, counted_rung
from harness.studies.advise.study import told_errors

if TYPE_CHECKING:
    from harness.studies.advise.choose import Choice
    from harness.studies.advise.combine import Total
    from harness.studies.advise.study import Advice

WHAT = {
    "dt": "time step (dt_fraction)", "stiffness": "stiffness, times the scene's", "rate": "rate, times the scene's",
    "size": "particles", "width": "averaging width",
}


def tables(advice: Advice) -> dict[str, list[dict]]:
    """Return rows by table name."""
    return {"advice": advice_rows(advice), "sum": sum_rows(advice), "ladders": ladder_rows(advice)}


def advice_rows(advice: Advice) -> list[dict]:
    """One row a knob, and the effects: what to take, what it brings, and where that is known from."""
    choice = advice.answer
    if choice is None:
        return []
    rows = [_engine_row(advice, choice), *(_knob_row(advice, choice, knob) for knob in choice.rungs)]
    rows += [_row(WHAT[k], None, why) for k, why in advice.evidence.absent.items()]
    rows.append(_effects_row(advice, choice))
    rows.append(_packings_row(advice))
    return rows


def _packings_row(advice: Advice) -> dict:
    if advice.evidence.free:
        return _row("runs", advice.packings, "one run")
    if advice.choice is None:
        return _row("packings", advice.packings, "those of the ladders; no number of them is known to be enough")
    return _row("packings", advice.packings, "so that their mean is within the tolerance")


def _row(what: str, value: object, known: str, **more) -> dict:
    empty = {"as declared": None, "error (%)": None, "standard error (%)": None, "counts as": None,
             "time over as declared": None}
    return {"what": what, "take": value, **empty, **more, "known from": known}


def _engine_row(advice: Advice, choice: Choice) -> dict:
    known = "the cheapest of those measured" if advice.choice else "the one with the smallest error of those measured"
    return _row("engine", choice.engine, known)


def _knob_row(advice: Advice, choice: Choice, knob: str) -> dict:
    rung, own = choice.rungs[knob], advice.evidence.ladders[choice.engine][knob].own
    part = next(p for p in choice.parts if p.name == knob)
    known = _known(advice.evidence.ladders[choice.engine][knob], rung)
    return _row(
        WHAT[knob], _number(knob, rung.value), known, **{
            "as declared": None if own is None else _number(knob, own.value), "error (%)": 100.0 * part.error,
            "standard error (%)": 100.0 * part.bar, "counts as": _counts(part.seen),
            "time over as declared": part.ratio if own is not None else None,
        },
    )


def _known(ladder, rung) -> str:
    if rung.origin == "extrapolated":
        return f"extrapolated: {rung.how}"
    counted = counted_rung(ladder, rung)
    worse = "" if counted is rung else (
        f"; its own error of {100.0 * rung.error:.2g} % may be chance: that at {counted.value:.4g} is larger and counts"
    )
    return f"measured: this rung was run, with everything else as declared{worse}"


def _number(knob: str, value: float) -> float | int:
    return round(value) if knob == "size" else value


def _counts(seen: bool) -> str:
    return "seen: adds up" if seen else "noise: in quadrature"


def _effects_row(advice: Advice, choice: Choice) -> dict:
    say = advice.evidence.effects_say
    if not choice.without:
        return _row("effects", "as declared", say)
    part = next(p for p in choice.parts if p.name == EFFECTS)
    return _row(
        "effects", f"without {', '.join(choice.without)}", f"measured: {say}", **{
            "as declared": "all", "error (%)": 100.0 * part.error, "standard error (%)": 100.0 * part.bar,
            "counts as": _counts(part.seen), "time over as declared": part.ratio,
        },
    )


def sum_rows(advice: Advice) -> list[dict]:
    """The advised setting beside the scene as declared: error, packings, time."""
    choice = advice.answer
    if choice is None:
        return []
    setting = "advised" if advice.choice else "best known, does not keep the tolerance"
    rows = [_sum_row(advice, setting, choice.total, advice.packings, choice.seconds)]
    if advice.declared is not None and choice.declared_seconds is not None:
        needed = advice.declared_packings
        setting = "as declared" if needed else "as declared, does not keep the tolerance"
        rows.append(_sum_row(advice, setting, advice.declared, needed or advice.packings, choice.declared_seconds))
    return rows


def _sum_row(advice: Advice, setting: str, total: Total, packings: int, seconds: float) -> dict:
    """Free scenes have one run, and no scatter over packings."""
    row = {
        "setting": setting, "expected error (%)": 100.0 * total.error(packings),
        "of it seen (%)": 100.0 * total.systematic, "noise of the ladders (%)": 100.0 * total.noise,
    }
    if advice.evidence.free:
        return row | {"CPU of all phases (s)": seconds}
    return row | {
        "scatter of one packing (%)": 100.0 * total.spread, "packings": packings, "CPU of one (s)": seconds,
        "CPU of all (s)": seconds * packings,
    }


def ladder_rows(advice: Advice) -> list[dict]:
    """One row a rung of the ladders of the answer's engine."""
    choice = advice.answer
    engine = choice.engine if choice else next(iter(advice.evidence.ladders), None)
    told = told_errors(advice.evidence, engine) if engine else {}
    rows = []
    for knob, ladder in advice.evidence.ladders.get(engine, {}).items():
        for rung in ladder.rungs:
            taken = choice is not None and knob in choice.rungs and choice.rungs[knob].value == rung.value
            rows.append({
                "knob": knob, "setting": _number(knob, rung.value), "error (%)": 100.0 * rung.error,
                "standard error (%)": 100.0 * rung.bar, "CPU (s)": rung.seconds,
                "taken": "told, not counted" if knob in told else "taken" if taken else
                         "refused by `scene`" if rung.value in ladder.beyond else "",
                "as declared": "yes" if rung.declared else "",
            })
    return rows
