"""What switching every effect says, in plain words made from its numbers."""

from __future__ import annotations

from typing import TYPE_CHECKING

from harness.report.effects_tables import saved
from harness.studies.effects.study import REDUCED
from harness.studies.effects.variants import BASE

if TYPE_CHECKING:
    from harness.studies.effects.changes import Change
    from harness.studies.effects.study import EffectsStudy


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
        return "No effect that can be switched off changes a chosen quantity beyond the tolerance."
    told = [f"{v.effect.name} ({_told(w)})" for v, w in sorted(found, key=lambda f: -_size(f[1]))]
    return f"What the scene cannot do without: {'; '.join(told)}."


def _what_does_not(study: EffectsStudy) -> str:
    found = [v for v in study.variants if v.effect.on and v.scene is not None and _all(study, v.name, "agrees")]
    told = [f"{v.effect.name} ({_told(_worst(study, v.name))})" for v in found]
    return f"Within {_percent(study.asked.tolerance)} without: {'; '.join(told)}." if told else ""


def _not_told(study: EffectsStudy) -> str:
    open_ = [c for c in study.chosen if c.verdict == "inconclusive"]
    if not open_:
        return ""
    needed = [c.needed for c in open_ if c.needed]
    more = f"; {min(needed)} to {max(needed)} packings would settle most of it" if needed else ""
    told = ", ".join(dict.fromkeys(f"{c.quantity} {c.variant}" for c in open_))
    return f"Not to be told from {study.asked.packings} packing{'s' * (study.asked.packings > 1)}: {told}{more}."


def _missing(study: EffectsStudy) -> str:
    """Effects that are off and would change the answer."""
    found = [(v, w) for v in study.variants if not v.effect.on and v.scene is not None
             and (w := _worst(study, v.name)) is not None and w.verdict == "differs"]
    told = [f"{v.effect.name} ({v.says}: {_told(w)})" for v, w in found]
    return f"Off, and it would matter were it on: {'; '.join(told)}." if told else ""


def _dear(study: EffectsStudy) -> str:
    """What the dearest effect that is on costs, by engine."""
    told = []
    for engine in [e for e, name in study.costs if name == BASE]:
        ratios = {v.effect.name: study.whole_ratio(engine, v.name) for v in study.variants if v.effect.on and v.scene}
        known = {name: r for name, r in ratios.items() if r is not None}
        if known:
            name = min(known, key=known.get)
            if known[name] < 1.0:
                told.append(f"{engine} {name}, {_percent(1.0 - known[name])} of a run")
    return f"The dearest effect that can be switched off: {'; '.join(told)}." if told else ""


def _smallest(study: EffectsStudy) -> str:
    out, tolerance = study.smallest.left_out, _percent(study.asked.tolerance)
    quantities = ", ".join(study.asked.quantities)
    if not out:
        return f"The smallest set that keeps {quantities} within {tolerance} is the scene as declared."
    trials, time = len(study.smallest.trials), _saving(study)
    return (
        f"The smallest set that keeps {quantities} within {tolerance} leaves out {', '.join(out)}; a run of the "
        f"reduced scene shows it ({trials} combination{'s' * (trials > 1)} run). {time}"
    )


def _saving(study: EffectsStudy) -> str:
    """Say what the reduced scene saves, and where the scatter of the stretches hides it."""
    found = saved(study)
    if not found:
        return "The time that saves was not measured."
    ratio = study.steps[REDUCED] / study.steps[BASE]
    clear = {e: s for e, s in found.items() if study.costs[e, REDUCED].differs(ratio)}
    hidden = [e for e in found if e not in clear]
    told = [f"{_percent(s)} of a run on {e}" for e, s in clear.items()]
    told += [f"nothing that stands out of the scatter on {', '.join(hidden)}"] if hidden else []
    return f"That saves {'; '.join(told)}."


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
    worst = f", at worst {max(z.deviation for z in checks):.2g}" if checks else ""
    other = [z for z in study.zeros if z.verdict in ("differs", "known_difference")]
    told = "".join(f"; {z.effect} on {z.engine} is not ({z.deviation:.2g})" for z in other)
    missing = sum(z.verdict == "not_checked" for z in study.zeros)
    return (
        f"Off is the coefficient at zero in {len(checks)} of {len(study.zeros)}{worst}{told}; {missing} were not "
        "checked, with the reason beside each."
    )


def _all(study: EffectsStudy, variant: str, verdict: str) -> bool:
    mine = [c for c in study.chosen if c.variant == variant]
    return bool(mine) and all(c.verdict == verdict for c in mine)


def _told(change: Change) -> str:
    if change.relative is None:
        return f"{change.quantity}: none"
    bars = f", {abs(change.in_bars):.2g} error bars" if change.in_bars is not None else ""
    return f"{change.quantity} {100.0 * change.relative:+.3g} %{bars}"


def _size(change: Change) -> float:
    return float("inf") if change.relative is None else abs(change.relative)


def _percent(value: float) -> str:
    return f"{100.0 * value:.2g} %"
