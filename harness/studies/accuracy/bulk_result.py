"""What a bulk ladder gave: values with errors, times, limits; what tables, figures, words and advice are made of."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np

from harness.studies.accuracy.asked import Knob
from harness.studies.accuracy.limit import Limit, Order, standard_error

ROUNDING = 1e-9
"""Share of a quantity that is no error."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Rung:
    """One setting on one engine, over K packings.

    status: "completed" if every packing did, else what became of the first that did not, and reason why. x: what tends
    to 0. dt (s) and steps are the first packing's. values: (K, S) by quantity, NaN where a packing has none; empty
    unless completed. seconds: median CPU time of a whole test, None if not timed; each: (K,); set-up and output apart.
    beyond: the largest dt_fraction that the scene takes, if this one is larger; such a rung is shown and not advised.
    """

    knob: str
    value: float
    x: float
    label: str
    own: bool
    status: str
    reason: str
    particles: int
    dt: float
    steps: int
    values: Mapping[str, np.ndarray]
    seconds: float | None
    each: tuple[float, ...] = ()
    setup: float | None = None
    output: float | None = None
    beyond: float | None = None

    @property
    def good(self) -> bool:
        """Whether it passed its checks."""
        return self.status == "completed"

    @property
    def offered(self) -> bool:
        """Whether it has a time, and a scene with this setting can be run."""
        return self.seconds is not None and self.beyond is None


@dataclass(frozen=True, kw_only=True)
class Error:
    """Distance of a setting from a limit, both over the quantity's scale. bar: one standard error, of both sides.

    signed: of a single number, with its sign; of a curve its rms. packings: how many it was formed of.
    """

    size: float
    bar: float
    signed: float
    packings: int

    @property
    def seen(self) -> bool:
        """Whether it stands out of its own error."""
        return self.size > 2.0 * self.bar

    @property
    def most(self) -> float:
        """What it may be: with one standard error."""
        return self.size + self.bar


@dataclass(frozen=True, kw_only=True)
class Floor:
    """Scatter of a quantity over packings at the scene's own setting, over its scale.

    spread: standard deviation, what one packing may be off by. mean: spread/sqrt(packings), what their mean may.
    value, unit: mean over packings (rms of a curve) in the quantity's unit; packings: those that have the quantity.
    """

    value: float
    spread: float
    mean: float
    packings: int
    unit: str

    def needed(self, target: float) -> int:
        """Return how many packings bring the mean's scatter down to a target."""
        return max(2, int(np.ceil((self.spread / target) ** 2)))


@dataclass(frozen=True, kw_only=True, eq=False)
class Ladder:
    """All rungs of one knob on one engine, cheapest first.

    limits, orders, scales: by quantity; a scale is what errors are measured by. A knob of words (`law`) has no limits:
    its errors are told against the scene as declared. orderless: why there is no order, by quantity without one.
    """

    knob: Knob
    engine: str
    rungs: tuple[Rung, ...]
    limits: Mapping[str, Limit | None]
    orders: Mapping[str, Order | None]
    scales: Mapping[str, float]
    orderless: Mapping[str, str] = field(default_factory=dict)

    @property
    def own(self) -> Rung | None:
        """The scene as declared, None if it has no values."""
        return next((r for r in self.rungs if r.own and r.good), None)

    def error(self, rung: Rung, quantity: str) -> Error | None:
        """Return a rung's error against this knob's limit; None where either side is missing."""
        return self._distance(rung, quantity, others=())

    def whole_error(self, rung: Rung, quantity: str, others: Sequence[Ladder]) -> Error | None:
        """Return a rung's error against the limit of all knobs: with what the other knobs leave at the scene's setting.

        To first order knobs add: y - y_0 and, of every other knob, y_declared - y_0 of it, packing by packing.
        """
        return self._distance(rung, quantity, others=others)

    def known(self, quantity: str) -> list[tuple[Rung, Error]]:
        """Return the rungs that have an error, with it."""
        return [(r, e) for r in self.rungs if (e := self.error(r, quantity)) is not None]

    def _distance(self, rung: Rung, quantity: str, others: Sequence[Ladder]) -> Error | None:
        if quantity not in rung.values or quantity not in self.scales:
            return None
        parts = [self._apart(rung, quantity)]
        for other in others:
            parts.append(None if other.own is None else other._apart(other.own, quantity))
        if any(p is None for p in parts):
            return None
        each = sum(p[0] for p in parts)
        each = each[np.isfinite(each).all(axis=1)]
        return None if len(each) < 2 else _error(each, [p[1] for p in parts], self.scales[quantity])

    def _apart(self, rung: Rung, quantity: str) -> tuple[np.ndarray, np.ndarray] | None:
        """Return y - y_0, (K, S), NaN where a packing is not in both, and the limit's systematic error (S,)."""
        values = rung.values.get(quantity)
        if values is None:
            return None
        if self.knob.words:
            own = self.own
            return None if own is None or quantity not in own.values else (
                values - own.values[quantity], np.zeros(values.shape[1])
            )
        limit = self.limits.get(quantity)
        if limit is None:
            return None
        base = np.full(values.shape, np.nan)
        base[limit.packings] = limit.each
        return values - base, limit.systematic


def _error(each: np.ndarray, systematic: Sequence[np.ndarray], scale: float) -> Error:
    mean, bar = each.mean(axis=0), np.hypot(standard_error(each), np.sqrt(sum(s**2 for s in systematic)))
    size, spread = (_unrounded(float(np.sqrt((a**2).mean())) / scale) for a in (mean, bar))
    signed = float(np.copysign(size, mean[0])) if len(mean) == 1 else size
    return Error(size=size, bar=spread, signed=signed, packings=len(each))


def _unrounded(share: float) -> float:
    return share if share > ROUNDING else 0.0


def scale_of(limit: Limit | None, own: np.ndarray | None, declared: float | None) -> float | None:
    """Return what errors of a quantity are measured by: as declared, else the rms of its limit, else of its values."""
    if declared is not None:
        return declared
    base = limit.value if limit is not None else None if own is None else np.nanmean(own, axis=0)
    if base is None or not np.isfinite(base).all():
        return None
    size = float(np.sqrt((base**2).mean()))
    return size or None


def floor_of(own: Rung | None, quantity: str, scale: float | None, unit: str) -> Floor | None:
    """Return the scatter over packings, None with fewer than two that have the quantity."""
    if own is None or scale is None or quantity not in own.values:
        return None
    values = own.values[quantity]
    values = values[np.isfinite(values).all(axis=1)]
    if len(values) < 2:
        return None
    spread = float(np.sqrt((values.std(axis=0, ddof=1) ** 2).mean()))
    value = float(values.mean()) if values.shape[1] == 1 else float(np.sqrt((values.mean(axis=0) ** 2).mean()))
    return Floor(
        value=value, spread=spread / scale, mean=spread / scale / np.sqrt(len(values)), packings=len(values), unit=unit
    )


# --- choosing ----------------------------------------------------------------------------------------


@dataclass(frozen=True, kw_only=True)
class Offer:
    """A setting and its error. ladder, rung, error: None if no setting keeps the target; why: then why not."""

    target: float
    ladder: Ladder | None
    rung: Rung | None
    error: Error | None
    why: str = ""


def cheapest(ladder: Ladder, quantity: str, target: float, floor: Floor | None) -> Offer:
    """Return the first rung from which on all errors, one standard error added, stay below the target.

    Of a knob of words, where nothing is finer than anything, the fastest one. No rung that scenes refuse.
    """
    known, found = [(r, e) for r, e in ladder.known(quantity) if r.beyond is None], None
    if ladder.knob.words:
        near = [(r, e) for r, e in known if e.most <= target and r.offered]
        found = min(near, key=lambda re: re[0].seconds, default=None)
        known = [] if found else known
    for rung, error in reversed(known):
        if error.most > target or not rung.offered:
            break
        found = (rung, error)
    if found is None:
        return Offer(target=target, ladder=None, rung=None, error=None, why=_why(known, target, floor))
    return Offer(target=target, ladder=ladder, rung=found[0], error=found[1])


def _why(known: Sequence[tuple[Rung, Error]], target: float, floor: Floor | None) -> str:
    if not known:
        return "no rung has an error"
    best = min((e for _, e in known), key=lambda e: e.most)
    if best.size > target and best.seen:
        return f"the finest rungs are off by {100 * best.size:.2g} %"
    packings = int(np.ceil(best.packings * (best.bar / target) ** 2))
    floored = f", the floor is {100 * floor.mean:.2g} %" if floor is not None else ""
    return (
        f"not to be told: errors of this knob are known to {100 * best.bar:.2g} %{floored}; about {packings} packings "
        "would tell them"
    )


def front(ladders: Sequence[Ladder], quantity: str) -> list[tuple[Ladder, Rung, Error]]:
    """Return the settings than which no other is both faster and surely better, fastest first.

    Errors are those of whole settings: all knobs of an engine are held against the limit of all. They are compared with
    their standard errors added, so that a setting that is near by chance does not win.
    """
    points = []
    for ladder in ladders:
        others = [o for o in ladders if o.engine == ladder.engine and o is not ladder and not o.knob.words]
        for rung in ladder.rungs:
            error = ladder.whole_error(rung, quantity, others)
            if error is not None and rung.offered:
                points.append((ladder, rung, error))
    kept: list[tuple[Ladder, Rung, Error]] = []
    for point in sorted(points, key=lambda p: (p[1].seconds, p[2].most)):
        if not kept or point[2].most < kept[-1][2].most:
            kept.append(point)
    return kept
