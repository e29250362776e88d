"""Rows of the effects report: with all digits for CSV and JSON, the same for people."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

from harness.studies.effects.study import REDUCED
from harness.studies.effects.variants import BASE

if TYPE_CHECKING:
    from harness.studies.effects.changes import Change
    from harness.studies.effects.footprint import Footprint
    from harness.studies.effects.study import EffectsStudy

SHOWN_LINES = 2
"""Deck lines of one effect that the page quotes; the others are counted, and stand in the CSV table."""

LONGEST_LINE = 60
"""Characters of a line on the page."""

LONGEST_WHY = 200
"""Characters of a reason on the page."""

BETWEEN = " | "
"""Between lines in one cell."""


def tables(study: EffectsStudy) -> dict[str, list[dict]]:
    """Return rows by table name."""
    return {
        "effects": effect_rows(study), "smallest": smallest_rows(study), "trials": trial_rows(study),
        "chosen": [_change_row(c) for c in study.chosen], "costs": cost_rows(study), "traces": trace_rows(study),
        "zeros": zero_rows(study), "changes": [_change_row(c) for c in study.changes],
    }


def effect_rows(study: EffectsStudy) -> list[dict]:
    """One row an effect: on or off, why, and how it was switched, or why it was not."""
    by_name = {v.effect.name: v for v in study.variants}
    rows = []
    for effect in study.effects:
        variant = by_name.get(effect.name)
        switched = "not asked for" if variant is None else variant.says or f"not switched: {variant.reason}"
        also = ", ".join(variant.also) if variant else ""
        rows.append({
            "effect": effect.name, "is": "on" if effect.on else "off", "where": effect.place, "why": effect.reason,
            "that means": effect.brings, "switched": switched, "with it come or go": also or None,
        })
    return rows


def trace_rows(study: EffectsStudy) -> list[dict]:
    """One row an effect and engine: what is there with it only, and what is left while it is off, in full."""
    return [_trace_row(f) for f in study.footprints]


def traces_in_short(study: EffectsStudy) -> list[dict]:
    """The same rows for people: a few lines quoted, the others counted."""
    return [
        _trace_row(f) | {
            "why": _cut(f.why, LONGEST_WHY), "these lines": _quoted(f.added), "left while off": _quoted(f.left),
        }
        for f in study.footprints
    ]


def _trace_row(f: Footprint) -> dict:
    return {
        "effect": f.effect, "engine": f.engine, "off leaves nothing": f.verdict, "why": f.why,
        "deck lines with it": len(f.added) if f.verdict != "not_checked" else None,
        "these lines": BETWEEN.join(f.added) or None, "operations": _counted(f.operations),
        "a contact remembers": _counted(f.memory),
        "output columns": None if f.columns is None else ", ".join(f.columns) or "none",
        "left while off": BETWEEN.join(f.left) or None,
    }


def zero_rows(study: EffectsStudy) -> list[dict]:
    """One row an effect and engine: off against the coefficient at zero."""
    return [
        {"effect": z.effect, "engine": z.engine, "coefficient as run": z.says or None, "verdict": z.verdict,
         "off from that": z.deviation, "off from on": z.acts, "steps": z.steps or None, "why": z.why}
        for z in study.zeros
    ]


def cost_rows(study: EffectsStudy) -> list[dict]:
    """One row an engine and variant: a step, over that of the scene as declared, and a whole run over its."""
    return [_cost_row(study, engine, variant) for engine, variant in study.costs]


def _cost_row(study: EffectsStudy, engine: str, variant: str) -> dict:
    cost = study.costs[engine, variant]
    low, high = cost.range or (None, None)
    return {
        "engine": engine, "scene": variant, "CPU per step (us)": None if cost.step is None else 1e6 * cost.step,
        "over as declared": cost.ratio, "least": low, "largest": high, "stretches": len(cost.ratios),
        "steps of a stretch": cost.steps or None, "bodies timed": cost.bodies or None,
        "steps of a run": study.steps[variant], "whole run over as declared": study.whole_ratio(engine, variant),
        "set-up, CPU (ms)": None if cost.setup is None else 1e3 * cost.setup, "reason": cost.reason,
    }


def _change_row(c: Change) -> dict:
    return {
        "scene": c.variant, "quantity": c.quantity, "unit": c.unit, "as declared": c.base, "switched": c.value,
        "change (%)": _percent(c.relative), "change is over": c.over, "standard error (%)": _percent(c.error),
        "error bar (%)": _percent(c.bar),
        "change in error bars": c.in_bars, "within the tolerance": c.verdict, "why": c.why, "packings": c.packings,
        "packings needed": c.needed,
    }


def smallest_rows(study: EffectsStudy) -> list[dict]:
    """One row an effect that is on: whether it may go, and why not."""
    rows, along = [], _along(study)
    for v in (v for v in study.variants if v.effect.on):
        name, why = v.effect.name, ""
        if name in study.smallest.left_out:
            quick = ", ".join(e for e in _engines(study) if study.faster(e, v.name))
            why = f"the reduced scene keeps the tolerance without it; every stretch is faster on {quick}"
        elif name in along:
            why = f"it goes with {along[name]}"
        rows.append({
            "effect": name, "in the smallest set": "no" if why else "yes", "why": why or study.smallest.kept[name],
            **{f"time of a run without it, {e}": study.whole_ratio(e, v.name) for e in _engines(study)},
        })
    if study.smallest.left_out:
        rows.append({
            "effect": f"all without {', '.join(study.smallest.left_out)}", "in the smallest set": "verified",
            "why": "run and timed together",
            **{f"time of a run without it, {e}": study.whole_ratio(e, REDUCED) for e in _engines(study)},
        })
    return rows


def _along(study: EffectsStudy) -> dict[str, str]:
    """Return effects that are gone because another one is, by name: with which."""
    out = [v for v in study.variants if v.effect.name in study.smallest.left_out]
    return {also[1:]: v.effect.name for v in out for also in v.also if also.startswith("-")}


def trial_rows(study: EffectsStudy) -> list[dict]:
    """One row a combination that was run and a quantity, the chosen ones first."""
    return [
        {"trial": number, "holds": "yes" if t.holds else "no", **_change_row(c)}
        for number, t in enumerate(study.smallest.trials, start=1) for c in (*t.changes, *t.others)
    ]


def visible_trials(study: EffectsStudy) -> list[dict]:
    """The same rows without quantities that nobody chose and that do not visibly change."""
    wanted = study.asked.quantities
    return [r for r in trial_rows(study) if r["quantity"] in wanted or r["within the tolerance"] == "differs"]


def saved(study: EffectsStudy) -> dict[str, float]:
    """Return the part of a run's time that the smallest set saves, by engine; of engines that were timed.

    0 where the stretches scatter about no difference.
    """
    found = {e: study.whole_ratio(e, REDUCED) for e in _engines(study)}
    known = {e: ratio for e, ratio in found.items() if ratio is not None}
    longer = study.steps[REDUCED] / study.steps[BASE] if known else 1.0
    return {e: 1.0 - r if study.costs[e, REDUCED].differs(longer) else 0.0 for e, r in known.items()}


def _engines(study: EffectsStudy) -> list[str]:
    return [e for e, variant in study.costs if variant == BASE]


def _quoted(lines: tuple[str, ...]) -> str | None:
    shown = [_cut(line) for line in lines[:SHOWN_LINES]]
    more = [f"and {len(lines) - SHOWN_LINES} more"] if len(lines) > SHOWN_LINES else []
    return BETWEEN.join([*shown, *more]) or None


def _cut(line: str, longest: int = LONGEST_LINE) -> str:
    return line if len(line) <= longest else f"{line[:longest - 3]}..."


def _counted(found: Mapping[str, int] | None) -> str | None:
    """Say how often each name occurs, names of one effect together; "none" of an empty one, None of one not told."""
    if found is None:
        return None
    totals: dict[str, int] = {}
    for name, count in found.items():
        family = name.partition(":")[0]
        totals[family] = totals.get(family, 0) + count
    return ", ".join(f"{count} {name}" for name, count in totals.items()) or "none"


def _percent(value: float | None) -> float | None:
    return None if value is None else 100.0 * value
