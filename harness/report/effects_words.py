"""What switching every effect says, in plain words made from its numbers."""

from __future__ import annotations

from typing import TYPE_CHECKING

from harness.report.effects_tables import saved
from harness.studies.effects.of_normal import NEXT_TO_NOTHING
from harness.studies.effects.variants import BASE

if TYPE_CHECKING:
    from collections.abc import Iterable

    from harness.studies.effects.changes import Change
    from harness.studies.effects.study import EffectsStudy


MOST_TOLD = 3
"""Quantities beside the chosen ones that are named; the others are counted, and stand in the tables."""


def paragraph(study: EffectsStudy) -> str:
    """Return the findings, a sentence each, leaving out what was not found."""
    sentences = [_what_matters(study), _what_does_not(study), _not_told(study), _missing(study), _dear(study),
                 _smallest(study), _proof(study), _zero(study)]
    return " ".join(s for s in sentences if s)


def _worst(study: EffectsStudy, variant: str) -> Change | None:
    """Return the chosen quantity that a variant changes most; one that is gone before all."""
    mine = [c for c in study.chosen if c.variant == variant]
    return max(mine, key=lambda c: float("inf") if c.relative is None else abs(c.relative), default=None)


def _what_matters(study: EffectsStudy) -> str:
    found = [(v, w) for v in study.variants if v.effect.on and v.scene is not None
             and (w := _worst(study, v.name)) is not None and w.verdict == "differs"]
    if not found:
        return "No effect that can be switched off is shown to change a chosen quantity beyond the tolerance."
    told = [f"{v.effect.name} ({_told(w)})" for v, w in sorted(found, key=lambda f: -_size(f[1]))]
    kept = f"{', '.join(study.asked.quantities)} within {_percent(study.asked.tolerance)}"
    return f"Needed to keep {kept} (in brackets what changes without): {'; '.join(told)}."


def _what_does_not(study: EffectsStudy) -> str:
    found = [v for v in study.variants if v.effect.on and v.scene is not None and _all(study, v.name, "agrees")]
    told = [f"{v.effect.name} ({_told(_worst(study, v.name))})" for v in found]
    if not told:
        return ""
    beside = [f" Without {v.effect.name}{more}." for v in found if (more := _visible(study, _others(study, v.name)))]
    return f"Not needed for that: {'; '.join(told)}.{''.join(beside)}"


def _others(study: EffectsStudy, variant: str) -> list[Change]:
    return [c for c in study.changes if c.variant == variant and c.quantity not in study.asked.quantities]


def _visible(study: EffectsStudy, changes: Iterable[Change]) -> str:
    """Say which quantities that nobody chose differ, the largest changes first; "" if none does."""
    found = sorted((c for c in changes if c.verdict == "differs"), key=_size, reverse=True)
    if not found:
        return ""
    told = [f"{c.quantity} {_with_error(c)}" for c in found[:MOST_TOLD]]
    told += [f"and {len(found) - MOST_TOLD} more"] if len(found) > MOST_TOLD else []
    return f" other quantities differ by more than {_percent(study.asked.tolerance)}: {', '.join(told)}"


def _not_told(study: EffectsStudy) -> str:
    open_ = [c for c in study.chosen if c.verdict == "inconclusive"]
    if not open_:
        return ""
    told = ", ".join(f"{c.quantity} {c.variant} ({_open(c)})" for c in open_)
    return f"Not to be told from {study.asked.packings} packing{'s' * (study.asked.packings > 1)}: {told}."


def _open(change: Change) -> str:
    needed = f"; about {change.needed} packings would tell" if change.needed else ""
    return f"{_with_error(change)}{needed}"


def _missing(study: EffectsStudy) -> str:
    """Effects that are off and would change the answer."""
    found = [(v, w) for v in study.variants if not v.effect.on and v.scene is not None
             and (w := _worst(study, v.name)) is not None and w.verdict == "differs"]
    told = [f"{v.effect.name} ({v.says}: {_told(w)})" for v, w in found]
    return f"Off, and it would matter were it on: {'; '.join(told)}." if told else ""


def _dear(study: EffectsStudy) -> str:
    """What the dearest effect that is on costs, by engine, needed or not."""
    told = []
    for engine in [e for e, name in study.costs if name == BASE]:
        known = {
            v.effect.name: study.whole_ratio(engine, v.name) for v in study.variants
            if v.effect.on and v.scene and study.faster(engine, v.name)
        }
        if known:
            name = min(known, key=known.get)
            told.append(f"{name} on {engine} ({_percent(1.0 - known[name])} of a run)")
    return f"Most time, of the effects that were switched, whether needed or not, is taken by {'; '.join(told)}." if (
        told
    ) else ""


def _smallest(study: EffectsStudy) -> str:
    out, tolerance = study.smallest.left_out, _percent(study.asked.tolerance)
    quantities = ", ".join(study.asked.quantities)
    if not out:
        return f"The smallest set that keeps {quantities} within {tolerance} is the scene as declared."
    trials, time = len(study.smallest.trials), _saving(study)
    more = _visible(study, study.smallest.trials[-1].others)
    return (
        f"The smallest set that keeps {quantities} within {tolerance} leaves out {', '.join(out)}; a run of the "
        f"reduced scene shows it ({trials} combination{'s' * (trials > 1)} run)."
        f"{f' What else changes:{more}.' if more else ''} {time}"
    )


def _saving(study: EffectsStudy) -> str:
    """Say what the reduced scene saves, and where the scatter of the stretches hides it."""
    found = saved(study)
    if not found:
        return "The time that saves was not measured."
    hidden = [e for e, s in found.items() if s == 0.0]
    told = [f"{_percent(s)} of a run on {e}" for e, s in found.items() if s != 0.0]
    told += [f"nothing that stands out of the scatter on {', '.join(hidden)}"] if hidden else []
    return f"Timed again, that saves {'; '.join(told)}."


def _proof(study: EffectsStudy) -> str:
    verdicts = [f.verdict for f in study.footprints]
    if not verdicts:
        return ""
    counts = {word: verdicts.count(word) for word in ("agrees", "known_difference", "differs", "not_checked")}
    return (
        f"Off leaves nothing behind in {counts['agrees']} of {len(verdicts)} pairs of effect and engine; in "
        f"{counts['known_difference']} a word or a number stands in its place, for a stated reason; "
        f"{counts['differs']} differ, {counts['not_checked']} cannot be asked."
    )


def _zero(study: EffectsStudy) -> str:
    checks = [z for z in study.zeros if z.verdict == "agrees"]
    if not study.zeros:
        return ""
    size = max((z.deviation for z in checks), default=0.0)
    worst = (f", they part by {size:.2g} at most" if size else ", to the last bit") if checks else ""
    faint = [z for z in checks if not z.exact]
    next_to = f" ({len(faint)} of them at {NEXT_TO_NOTHING:g} of itself, where 0 is how the scene says off)" if (
        faint
    ) else ""
    other = [z for z in study.zeros if z.verdict in ("differs", "known_difference")]
    told = "".join(f"; {z.effect} on {z.engine} does not (they part by {z.deviation:.2g})" for z in other)
    missing = sum(z.verdict == "not_checked" for z in study.zeros)
    return (
        f"Off gives what the coefficient at zero gives in {len(checks)} of {len(study.zeros)} pairs{next_to}{worst}"
        f"{told}; {missing} were not checked, with the reason beside each."
    )


def _all(study: EffectsStudy, variant: str, verdict: str) -> bool:
    mine = [c for c in study.chosen if c.variant == variant]
    return bool(mine) and all(c.verdict == verdict for c in mine)


def _told(change: Change) -> str:
    if change.relative is None:
        return f"{change.quantity}: none"
    bars = f", {abs(change.in_bars):.2g} error bars" if change.in_bars is not None else ""
    return f"{change.quantity} {100.0 * change.relative:+.3g} %{bars}"


def _with_error(change: Change) -> str:
    if change.relative is None:
        return change.why
    error = f" +- {100.0 * change.error:.2g}" if change.error else ""
    return f"{100.0 * change.relative:+.3g}{error} %"


def _size(change: Change) -> float:
    return float("inf") if change.relative is None else abs(change.relative)


def _percent(value: float) -> str:
    return f"{100.0 * value:.2g} %"
