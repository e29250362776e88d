"""The cheapest setting that keeps a quantity within a tolerance: all engines, all rungs of all knobs together.

Only settings that were run are looked at first. If none will do, ladders whose errors fall like a power are followed
further, at most `FARTHEST` times beyond their finest rung, and what comes of it is called extrapolated.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, replace

from harness.studies.accuracy.asked import KNOBS
from harness.studies.accuracy.limit import LEAST
from harness.studies.advise.combine import Part, Total, time_ratio, total
from harness.studies.advise.evidence import DECIDED, Evidence, KnobLadder, Rung
from harness.studies.advise.scene import Settings

FINER = (2.0, 4.0, 8.0)
FARTHEST = FINER[-1]
"""Times beyond the finest rung, in the knob's value: further nothing is foretold."""

TIME = {"dt": 1.0, "stiffness": 0.5, "rate": 1.0, "size": 1.0}
"""Least power of the value by which the time of a run grows or falls: steps go with 1/dt, sqrt(k), 1/rate, and each
with the particles. Small systems show less, as other costs hide it; further out they do not."""

EFFECTS = "effects"


@dataclass(frozen=True, kw_only=True)
class Choice:
    """A setting of all knobs on one engine. rungs: by knob. without: effects left out.

    packings: P of `combine`, None if no number keeps the tolerance. seconds: CPU time of one test. declared_seconds: of
    one test of the scene as declared on this engine, None if its setting is on no ladder.
    """

    engine: str
    rungs: Mapping[str, Rung]
    parts: tuple[Part, ...]
    without: tuple[str, ...]
    total: Total
    packings: int | None
    seconds: float
    declared_seconds: float | None

    @property
    def settings(self) -> Settings:
        """Values by knob, and effects left out."""
        return Settings(values={k: r.value for k, r in self.rungs.items()}, without=self.without)

    @property
    def extrapolated(self) -> tuple[str, ...]:
        """Knobs whose setting was not run."""
        return tuple(k for k, r in self.rungs.items() if r.origin == "extrapolated")

    @property
    def whole_seconds(self) -> float:
        """CPU time of all packings; infinite if no number of them will do."""
        return math.inf if self.packings is None else self.seconds * self.packings


Allowed = Callable[[Settings], bool]
"""Whether a setting makes a scene that can be run."""


def choose(evidence: Evidence, tolerance: float, allowed: Allowed) -> Choice | None:
    """Return the cheapest setting that keeps the tolerance, measured ones before extrapolated ones; None for none."""
    for farther in (False, True):
        able = [c for c in choices(evidence, tolerance, farther=farther) if c.packings is not None]
        found = _first_allowed(sorted(able, key=_cost), allowed)
        if found is not None:
            return found
    return None


def best_known(evidence: Evidence, tolerance: float, allowed: Allowed) -> Choice | None:
    """Return the measured setting with the smallest error, whatever it costs; None without ladders."""
    made = choices(evidence, tolerance, farther=False)
    return _first_allowed(sorted(made, key=lambda c: (c.total.error(evidence.packings), c.seconds)), allowed)


def choices(evidence: Evidence, tolerance: float, *, farther: bool) -> Iterator[Choice]:
    """Yield every combination of rungs on every engine, with and without the effects that may go."""
    for engine, ladders in evidence.ladders.items():
        turned = {k: _rungs(evidence, ladders[k], farther=farther) for k in DECIDED if k in ladders}
        for picked in itertools.product(*turned.values()) if turned else ():
            for effects in _effects(evidence, engine):
                yield choice_of(evidence, engine, dict(zip(turned, picked, strict=True)), effects, tolerance)


def parts_of(evidence: Evidence, engine: str, rungs: Mapping[str, Rung]) -> list[Part]:
    """Return what each knob brings, its time over that of its own ladder's reference."""
    made = []
    for knob, rung in rungs.items():
        ladder = evidence.ladders[engine][knob]
        counted = counted_rung(ladder, rung)
        ratio = rung.seconds / ladder.reference.seconds
        made.append(Part(name=knob, error=counted.error, bar=counted.bar, ratio=ratio))
    return made


def spread_at(evidence: Evidence, engine: str, size: Rung | None) -> float:
    """Return the scatter of one packing, over the scale: s sqrt(N) of all sizes together, over sqrt(N).

    Each size tells its scatter from few packings; the one that happens to be smallest is no better known than others.
    """
    ladder = evidence.ladders[engine].get("size")
    told = [(r.value, r.spread) for r in ladder.rungs if r.spread is not None] if ladder is not None else []
    if size is None or not told:
        return evidence.spread[engine] or 0.0
    return math.sqrt(sum(n * s * s for n, s in told) / len(told) / size.value)


def counted_rung(ladder: KnobLadder, rung: Rung) -> Rung:
    """Return the rung whose error counts: the rung itself, or a finer one whose seen error is larger.

    A coarse rung may be right by chance, where its error changes sign; that finer ones are worse says so.
    """
    finer = (r for r in ladder.rungs if r.x < rung.x and r.seen)
    return max((rung, *finer), key=lambda r: abs(r.error))


def choice_of(
    evidence: Evidence, engine: str, rungs: Mapping[str, Rung], effects: Part | None, tolerance: float
) -> Choice:
    """Return what rungs together are expected to bring. effects: what leaving some out does, None for none."""
    ladders = [evidence.ladders[engine][knob] for knob in rungs]
    parts = parts_of(evidence, engine, rungs)
    parts += [effects] if effects is not None else []
    combined = total(parts, spread_at(evidence, engine, rungs.get("size")))
    return Choice(
        engine=engine, rungs=rungs, parts=tuple(parts), total=combined,
        without=evidence.reduced.names if effects is not None else (),
        seconds=ladders[0].reference.seconds * time_ratio(parts), packings=combined.packings_for(tolerance),
        declared_seconds=ladders[0].reference.seconds if all(la.own for la in ladders) else None,
    )


def _effects(evidence: Evidence, engine: str) -> list[Part | None]:
    """Return nothing left out, and what may be; on an engine on which that was not timed it saves nothing."""
    reduced = evidence.reduced
    if reduced is None:
        return [None]
    ratio = reduced.share.get(engine, 1.0)
    return [None, Part(name=EFFECTS, error=reduced.error, bar=reduced.bar, ratio=ratio)]


def _rungs(evidence: Evidence, ladder: KnobLadder, *, farther: bool) -> list[Rung]:
    return [*ladder.rungs, *(finer_rungs(evidence, ladder) if farther else ())]


def finer_rungs(evidence: Evidence, ladder: KnobLadder) -> list[Rung]:
    """Return rungs beyond the finest one: e ~ x^p with the order of the limit, time by a power of the value.

    The power is that of the last two rungs, at least that of TIME. None where the ladder shows no error that falls like
    a power, or no order. The standard error is that of the finest rung's error: the limit is known no better, and the
    power is not assumed to bring it down.
    """
    if len(ladder.rungs) < 2 or ladder.state != "extrapolated" or not ladder.order >= LEAST:
        return []
    seen = [r for r in ladder.rungs if r.seen]
    if not seen:
        return []
    reference, (before, last) = seen[-1], ladder.rungs[-2:]
    shown = math.log(last.seconds / before.seconds) / abs(math.log(last.value / before.value))
    power, x_of = max(shown, TIME[ladder.knob]), KNOBS[type(evidence.scene)][ladder.knob].x
    grows = x_of(2.0 * last.value) < x_of(last.value)
    found = []
    for factor in FINER:
        value = last.value * factor if grows else last.value / factor
        x = x_of(value)
        found.append(replace(
            last, value=value, x=x, declared=False, origin="extrapolated", spread=None, each=(),
            error=reference.error * (x / reference.x) ** ladder.order, seconds=last.seconds * factor**power,
            how=f"error ~ x^{ladder.order:.2g} from {reference.value:.4g}, time by a power {power:.2g} of the value",
        ))
    return found


def _cost(choice: Choice) -> tuple[float, float]:
    return choice.whole_seconds, choice.total.error(choice.packings)


def _first_allowed(ordered: list[Choice], allowed: Allowed) -> Choice | None:
    """Return the first whose scene can be run; many settings share what makes a scene, and are asked once."""
    asked: dict[tuple, bool] = {}
    for choice in ordered:
        key = (tuple(choice.settings.values.items()), choice.without)
        if key not in asked:
            asked[key] = allowed(choice.settings)
        if asked[key]:
            return choice
    return None
