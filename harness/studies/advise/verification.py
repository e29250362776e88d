"""What came of an advice that was put to the test, and its verdict.

d is the quantity as advised less that of the reference, over the smallest scale of the ladders whose knobs are turned;
of a free scene the rms error against the oracle. s is its standard error, t Student's one-sided 95 % point of as many
degrees of freedom, T the tolerance::

    agrees        |d| + t s <= T
    differs       |d| - t s > T
    inconclusive  neither; so many packings would be expected to tell, were the difference the one that was measured
    not_checked   a run failed, or there is nothing to hold the advised setting against

Packings are paired by their seeds, so that what a packing does to both settings alike cancels (and with it the part
of E(P) that is the user's own scatter); where the number of particles differs the packings do, and the standard errors
are those of two samples. See `harness.studies.statistics.difference`.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np

from harness.studies.effects.changes import LEVEL, judged
from harness.studies.statistics.difference import (
    FEWEST,
    Difference,
    half_width,
    independent_difference,
    p_value,
    paired_difference,
)
from harness.studies.verdict import Verdict


@dataclass(frozen=True, kw_only=True, eq=False)
class Side:
    """One setting that was run. settings: values by knob; without: effects left out.

    status: "completed" if every run did, else what became of the first that did not, and reason why. values: (K, S),
    over packings, NaN where one has none; of a free scene the errors by phase, (K, 1). mean, error: of the quantity and
    its standard error in the unit (of a curve the rms over its places; of a free scene the rms error); None without.
    seconds: CPU time of one test, median over packings, None where it was not timed; foretold_seconds: by the ladders.
    """

    name: str
    settings: Mapping[str, float]
    without: tuple[str, ...]
    particles: int
    steps: int
    status: str
    reason: str
    values: np.ndarray = field(default_factory=lambda: np.empty((0, 1)))
    mean: float | None = None
    error: float | None = None
    seconds: float | None = None
    foretold_seconds: float | None = None

    @property
    def good(self) -> bool:
        """Whether all its runs completed."""
        return self.status == "completed"


@dataclass(frozen=True, kw_only=True, eq=False)
class Verification:
    """reference: None of a free scene, and where the advised setting has every knob at its finest rung.

    count: packings, of a free scene phases. scale: in the unit; over: what it is, in words. difference: over the scale,
    None where there is none. expected: E(count) of `combine`. remaining: what the reference is expected to be off
    itself, by the ladders' limits; of a free scene the oracle's own error. untested: knobs that are the same in both.
    singly: what the ladders say of the difference, the knobs' own ones added up. together: what was measured less that,
    packing by packing: what knobs do to each other. Both over the scale, None where the ladders do not tell.
    joint: whether any of both settings turns two knobs; else they are rungs of the ladders, on packings of their own.
    """

    quantity: str
    unit: str
    engine: str
    free: bool
    advised: Side
    reference: Side | None
    count: int
    scale: float
    over: str
    tolerance: float
    difference: Difference | None
    expected: float
    remaining: float | None
    verdict: Verdict
    why: str
    needed: int | None = None
    untested: tuple[str, ...] = ()
    singly: Difference | None = None
    together: Difference | None = None
    joint: bool = True

    @property
    def bar(self) -> float | None:
        """t s, over the scale."""
        return None if self.difference is None else one_sided(self.difference)

    @property
    def multiple(self) -> float | None:
        """t."""
        return None if self.difference is None else multiple_of(self.difference.dof)

    @property
    def from_limit(self) -> float | None:
        """|d| + t s and what the reference is expected to be off itself; of a free scene the oracle is the limit."""
        if self.free or self.difference is None or self.remaining is None:
            return None
        return abs(self.difference.value) + self.bar + self.remaining

    @property
    def knobs_act(self) -> bool:
        """Whether what knobs do to each other stands out of its error (Student's t, two-sided 5 %)."""
        return self.together is not None and p_value(self.together) < LEVEL

    @property
    def time_ratio(self) -> float | None:
        """CPU time of one test as advised over that of the reference; of a free scene over what the ladder says."""
        below = self.advised.foretold_seconds if self.free else self.reference and self.reference.seconds
        return self.advised.seconds / below if self.advised.seconds and below else None

    @property
    def foretold_ratio(self) -> float | None:
        """The same by the ladders; of a free scene 1."""
        if self.free:
            return 1.0
        below = self.reference and self.reference.foretold_seconds
        return self.advised.foretold_seconds / below if below else None

    @property
    def sides(self) -> tuple[Side, ...]:
        """What was run."""
        return tuple(s for s in (self.advised, self.reference) if s is not None)

    @property
    def exit_status(self) -> int:
        """1 when it differs or a run failed."""
        return 1 if self.verdict == "differs" or not all(s.good for s in self.sides) else 0


def multiple_of(dof: float) -> float:
    """Return Student's one-sided 95 % point."""
    from scipy.stats import t

    return float(t.isf(LEVEL, dof))


def one_sided(difference: Difference) -> float:
    """Return t s."""
    return half_width(difference, 2.0 * LEVEL)


def verdict_of(difference: Difference, tolerance: float, each: str) -> tuple[Verdict, str, int | None]:
    """Return the verdict of a difference over its scale, why, and how many packings would tell; each: what they are."""
    verdict, _, needed = judged(difference, tolerance)
    size, bar = abs(difference.value), one_sided(difference)
    many = f"{multiple_of(difference.dof):.3g} standard errors"
    if verdict == "agrees":
        return verdict, f"{percent(size)} and {many} are {percent(size + bar)}, within {percent(tolerance)}", None
    if verdict == "differs":
        return verdict, f"{percent(size)} less {many} is {percent(size - bar)}, beyond {percent(tolerance)}", None
    side = "within" if size < tolerance else "beyond"
    more = f"about {needed} {each} would be expected to show that it is {side}" if needed else (
        f"no number of {each} is known to tell"
    )
    return verdict, (
        f"{percent(size)} +- {percent(bar)} ({many}) is shown neither within {percent(tolerance)} nor beyond; {more}"
    ), needed


def difference_of(a: np.ndarray, b: np.ndarray, scale: float, *, paired: bool) -> Difference | None:
    """Return a - b, (K, S) each, over the scale; of several numbers the rms of differences and of standard errors.

    NaN where a packing has none. None with fewer than two packings. Degrees of freedom: the fewest of all places.
    """
    good = [np.isfinite(v).all(axis=1) for v in (a, b)]
    if paired:
        good = [good[0] & good[1]] * 2
    if min(g.sum() for g in good) < FEWEST:
        return None
    a, b = (v[g] / scale for v, g in zip((a, b), good, strict=True))
    form = paired_difference if paired else independent_difference
    places = [form(a[:, k], b[:, k]) for k in range(a.shape[1])]
    return places[0] if len(places) == 1 else _together(places)


def _together(places: Sequence[Difference]) -> Difference:
    return Difference(
        value=_rms([p.value for p in places]), error=_rms([p.error for p in places]), dof=min(p.dof for p in places),
        count=places[0].count, paired=places[0].paired,
    )


def mean_and_error(values: np.ndarray) -> tuple[float | None, float | None]:
    """Return the mean over packings of values (K, S) and its standard error, of a curve their rms; None without two."""
    good = values[np.isfinite(values).all(axis=1)] if len(values) else values
    if len(good) < FEWEST:
        return None, None
    mean, error = good.mean(axis=0), good.std(axis=0, ddof=1) / math.sqrt(len(good))
    return (float(mean[0]), float(error[0])) if len(mean) == 1 else (_rms(mean), _rms(error))


def _rms(values: Sequence[float] | np.ndarray) -> float:
    return float(np.sqrt(np.mean(np.square(values))))


def percent(value: float, form: str = "") -> str:
    """Write a share with two digits, and no power of ten where they are enough.

    >>> percent(2.184), percent(-0.0172, "+")
    ('220 %', '-1.7 %')
    """
    return f"{float(f'{100.0 * value:.2g}'):{form}g} %"
