"""Verdicts on many quantities of several pairs of codes at once, from replicates or time averages (level L3).

For every quantity and pair: the difference with its error (`difference`), whether it is one at all (Student's t, one
false-alarm rate for the whole family: `multiple`), whether it is shown to be small (`power`), and what the number of
replicates can tell::

    differs       it is not zero: adjusted p <= the declared rate; between codes of different conventions only if it
                  is not shown to be smaller than the margin, as conventions may differ by a little
    agrees        it is shown to be smaller than the margin (equivalence), and no difference is seen
    inconclusive  neither: no evidence of a difference is no evidence of none; more replicates would tell

Codes that compute the same thing differ by round-off before chaos and by nothing on average after it; what is below
ROUND_OFF is no difference for them.

Equivalence is adjusted for the number of checks as differences are (Holm): with the declared probability or more *no*
check that says "agrees" is wrong. Without that each would be right for itself at the declared level, and of 72 whose
true difference is just the margin 3.6 would falsely agree at 5 %. (A claim that all checks of a report hold at once
would need no adjustment: R. L. Berger, Technometrics 24, 295 (1982), doi 10.1080/00401706.1982.10487790. But here
those that hold are picked out and believed one by one.)

The levels are those of one look at a number of replicates. Who adds replicates until something passes looks several
times: each further look is made at half the level of the one before (`harness.studies.statistics.looks`), which keeps
all together below twice the declared rate. The number of replicates that is proposed is that of a further look, at half
the level (`SECOND_LOOK`), and it stands with what it could as well be: the scatter is known from few replicates.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Protocol

import numpy as np

from harness.studies.statistics.difference import (
    FEWEST,
    Difference,
    half_width,
    independent_difference,
    p_value,
    paired_difference,
)
from harness.studies.statistics.multiple import Corrected, correct_together
from harness.studies.statistics.power import (
    MOST,
    POWER,
    equivalence_p,
    replicates_to_equate,
    replicates_to_see,
    smallest_difference,
)
from harness.studies.verdict import Check, Rerun, Verdict

ROUND_OFF = 1e-6
"""Of a quantity's scale: what the shipped scenes allow pointwise between runs that part by round-off alone."""

SECOND_LOOK = 0.5
"""Of the levels: what a look at more replicates is made at."""

SURE = 0.9
"""Probability with which the scatter lies in the interval that a proposed number of replicates is given for."""

DESIGNS = {
    "time averages": "one run each, errors of time averages", "paired": "{} replicates, paired by packing",
    "independent": "{} replicates, independent",
}
"""How two sides were compared, in more words."""

SAME = ("same_conventions", "same_code")
"""Kinds of pairs that compute the same thing."""


class Pair(Protocol):
    """Two engines by name, and what they have in common: see `harness.studies.compare.pairs`."""

    @property
    def left(self) -> str:
        """An engine."""

    @property
    def right(self) -> str:
        """Another."""

    @property
    def kind(self) -> str:
        """One of SAME, or another."""


@dataclass(frozen=True, kw_only=True)
class Measured:
    """One quantity of every run: values and, of time averages, each run's own standard error, by engine and replicate.

    scale: what a margin is a part of, in the quantity's unit; None for the mean of both sides. Runs without a value
    (no peak, say) are left out or NaN.
    """

    quantity: str
    unit: str
    values: Mapping[str, Mapping[int, float]]
    errors: Mapping[str, Mapping[int, float]] = field(default_factory=dict)
    scale: float | None = None

    def of(self, engine: str) -> dict[int, float]:
        """Return the finite values of an engine by replicate."""
        return {k: v for k, v in self.values.get(engine, {}).items() if math.isfinite(v)}

    def run_error(self, engine: str) -> float | None:
        """Return the rms over replicates of one run's own standard error; None where it is no time average."""
        errors = [e for e in self.errors.get(engine, {}).values() if math.isfinite(e)]
        return float(np.sqrt(np.mean(np.square(errors)))) if errors else None


@dataclass(frozen=True, kw_only=True)
class Terms:
    """What is declared: the family-wise rate of false alarms, the margin of equivalence (of a quantity's scale).

    paired: whether replicate k of all engines starts from one packing.
    """

    false_alarms: float
    margin: float
    paired: bool


@dataclass(frozen=True, kw_only=True)
class Tested:
    """One quantity of one pair. left, right: mean and its standard error over replicates; scale: see `Measured`.

    A difference of one run each (its count is 1) has the errors of time averages. doubt: why the error is not to be
    trusted, "" if it is: then nothing is concluded.
    """

    measured: Measured
    pair: Pair
    difference: Difference
    left: tuple[float, float]
    right: tuple[float, float]
    scale: float
    p: float
    doubt: str = ""

    @property
    def counted(self) -> float:
        """The p-value that counts: 1 where the error is not to be trusted, as such a test sees nothing."""
        return 1.0 if self.doubt else self.p

    def equivalence(self, terms: Terms) -> float:
        """Return the p-value of "the margin or more" that counts in the same way."""
        return 1.0 if self.doubt else equivalence_p(self.difference, margin_of(self, terms))

    @property
    def design(self) -> str:
        """How the two sides were compared, in a word."""
        if self.difference.count < FEWEST:
            return "time averages"
        return "paired" if self.difference.paired else "independent"


@dataclass(frozen=True, kw_only=True)
class Replicates:
    """How many replicates would settle a check; low, high: the same for a scatter at the ends of its interval (SURE).

    None: more than anybody would make.
    """

    count: int
    low: int | None
    high: int | None


@dataclass(frozen=True, kw_only=True)
class Judged:
    """A verdict and all that it rests on.

    adjusted, equivalence: Holm's p-values, of "no difference" and of "the margin or more"; level, equivalence_level: of
    this check within its family. among: number of tests that share the rate of false alarms.
    """

    tested: Tested
    adjusted: float
    level: float
    equivalence: float
    equivalence_level: float
    among: int
    terms: Terms

    @property
    def relative(self) -> float:
        """Difference, left - right, over the scale."""
        return self.tested.difference.value / self.tested.scale

    @property
    def error(self) -> float:
        """Standard error of it."""
        return self.tested.difference.error / self.tested.scale

    @property
    def seen(self) -> bool:
        """Whether there is a difference, at the declared rate of false alarms of the whole family."""
        return self.adjusted <= self.terms.false_alarms

    @property
    def small(self) -> bool:
        """Whether the difference is shown to be smaller than the margin."""
        return self.equivalence <= self.terms.false_alarms

    @property
    def verdict(self) -> Verdict:
        """See the module."""
        if self.tested.doubt:
            return "inconclusive"
        if self.seen and (self.tested.pair.kind in SAME or not self.small):
            return "differs"
        return "agrees" if self.small else "inconclusive"

    @cached_property
    def chance(self) -> float:
        """What may lie between the sides by chance at this level, over the scale."""
        return half_width(self.tested.difference, self.level) / self.tested.scale

    @cached_property
    def resolvable(self) -> float:
        """True difference that would be seen with probability POWER, over the scale."""
        return smallest_difference(self.tested.difference, self.level) / self.tested.scale

    @cached_property
    def settle(self) -> Replicates | None:
        """Replicates that would see a difference as large as this, or show that it is small, whichever are fewer.

        None of a check that is settled, whose errors are not to be trusted, or when neither is known to do. The
        interval is that of the scatter alone, nu s^2/sigma^2 ~ chi^2_nu; the difference is taken as it was found.
        """
        d = self.tested.difference
        if self.verdict != "inconclusive" or self.tested.doubt or d.error == 0.0:
            return None
        count = self._needed(1.0)
        if count is None:
            return None
        return Replicates(count=count, low=self._needed(_scatter(d.dof, 1.0)), high=self._needed(_scatter(d.dof, -1.0)))

    def _needed(self, scatter: float) -> int | None:
        """Replicates at a second look if the true scatter is `scatter` times that found, more than there are."""
        d = replace(self.tested.difference, error=scatter * self.tested.difference.error)
        counts = (
            replicates_to_see(d, SECOND_LOOK * self.level),
            replicates_to_equate(d, margin_of(self.tested, self.terms), SECOND_LOOK * self.equivalence_level),
        )
        least = min((n for n in counts if n is not None), default=None)
        return None if least is None else max(least, d.count + 1)


def margin_of(tested: Tested, terms: Terms) -> float:
    """Return the margin of equivalence in the quantity's unit."""
    return terms.margin * tested.scale


def _scatter(dof: float, side: float) -> float:
    """Return an end of the interval of sigma/s: side 1 the lower one, -1 the upper one."""
    from scipy.stats import chi2

    return float(np.sqrt(dof / chi2.ppf(0.5 + side * 0.5 * SURE, dof)))


def judge_family(quantities: Sequence[Measured], pairs: Sequence[Pair], terms: Terms) -> list[Judged]:
    """Judge every quantity of every pair that has replicates enough, in this order."""
    return judge_tests(
        [t for m in quantities for pair in pairs if (t := _tested(m, pair, paired=terms.paired)) is not None], terms
    )


def judge_tests(tested: Sequence[Tested], terms: Terms, apart: Corrected | None = None) -> list[Judged]:
    """Judge tests as one family: both kinds of p-values are adjusted for all.

    apart: the correction of `counted` that these tests share with others; None if there are no others.
    """
    if apart is None:
        (apart,) = correct_together(terms.false_alarms, [t.counted for t in tested])
    (alike,) = correct_together(terms.false_alarms, [t.equivalence(terms) for t in tested])
    return [
        Judged(
            tested=t, adjusted=float(p), level=apart.level, equivalence=float(q), equivalence_level=alike.level,
            among=apart.among, terms=terms,
        )
        for t, p, q in zip(tested, apart.adjusted, alike.adjusted, strict=True)
    ]


def _tested(m: Measured, pair: Pair, *, paired: bool) -> Tested | None:
    """Return the test of a pair, None with too few replicates or where all values are zero."""
    a, b = m.of(pair.left), m.of(pair.right)
    if paired:
        both = [k for k in a if k in b]
        a, b = {k: a[k] for k in both}, {k: b[k] for k in both}
    left, right = (np.array(list(x.values())) for x in (a, b))
    if min(len(left), len(right)) < FEWEST:
        return None
    scale = 0.5 * abs(left.mean() + right.mean()) if m.scale is None else m.scale
    if not scale > 0:
        return None
    d = paired_difference(left, right) if paired else independent_difference(left, right)
    return Tested(
        measured=m, pair=pair, difference=d, left=_mean(left), right=_mean(right), scale=float(scale),
        p=p_value(d, ROUND_OFF * scale if pair.kind in SAME else 0.0),
    )


def _mean(values: np.ndarray) -> tuple[float, float]:
    return float(values.mean()), float(values.std(ddof=1) / np.sqrt(len(values)))


# --- in words ----------------------------------------------------------------------------------


def family_checks(judged: Sequence[Judged], rerun: Rerun) -> list[Check]:
    """Return a check a verdict. deviation: |difference|; tolerance: the margin; chance: what equal codes may show."""
    return [
        Check(
            level="L3", quantity=j.tested.measured.quantity, left=j.tested.pair.left, right=j.tested.pair.right,
            deviation=abs(j.relative), tolerance=j.terms.margin, chance=j.chance, verdict=j.verdict,
            why=_why(j, len(judged), rerun),
        )
        for j in judged
    ]


def _why(j: Judged, equivalences: int, rerun: Rerun) -> str:
    if j.tested.doubt:
        return f"{_sides(j)}; nothing is concluded, as errors come out too small: {j.tested.doubt}"
    parts = [_sides(j), _apart(j, equivalences)]
    if j.verdict == "inconclusive":
        parts.append(_more(j))
    if j.verdict == "differs":
        parts.append(f"rerun: {rerun(j.tested.pair.left, j.tested.pair.right)}")
    return "; ".join(parts)


def _sides(j: Judged) -> str:
    """Say both sides with their errors, and how they were compared."""
    t, unit = j.tested, "" if j.tested.measured.unit == "1" else f" {j.tested.measured.unit}"
    (a, da), (b, db) = t.left, t.right
    sides = f"{a:.4g} +- {da:.2g} and {b:.4g} +- {db:.2g}{unit}"
    how = DESIGNS[t.design].format(t.difference.count)
    return f"{sides}, {how}: apart by {percent(j.relative)} +- {percent(j.error)} (standard errors)"


def _apart(j: Judged, equivalences: int) -> str:
    among, within = f"p = {j.adjusted:.2g} among {j.among} checks", f"within {percent(j.terms.margin)}"
    if j.seen:
        return f"seen ({among}), {'but shown to be' if j.small else 'not shown to be'} {within}"
    if j.small:
        return f"shown to be {within} (p = {j.equivalence:.2g} among {equivalences})"
    return f"no difference seen ({among}), which is no evidence of none: not shown to be {within}"


def _more(j: Judged) -> str:
    """Say what could have been seen, and what it would take."""
    would = f"{percent(j.resolvable)} would be seen with probability {POWER:g}"
    if j.settle is None:
        return f"{would}; no number of replicates is known to do"
    return f"{would}; about {replicates_in_words(j)} would settle it at half the level, as a second look"


def replicates_in_words(j: Judged) -> str:
    """Write a number of replicates as no better known than it is: two digits, upwards, and its interval."""
    needed = j.settle
    if j.tested.difference.count < FEWEST:
        return f"{rounded_up(needed.count)} replicates or more, as packings scatter, too,"
    high = f"more than {MOST}" if needed.high is None else f"{rounded_up(needed.high)}"
    return f"{rounded_up(needed.count)} replicates ({rounded_up(needed.low or needed.count)} to {high})"


def rounded_up(count: int) -> int:
    """Round up to two digits.

    >>> rounded_up(151), rounded_up(80), rounded_up(7)
    (160, 80, 7)
    """
    step = 10 ** max(0, len(str(count)) - 2)
    return -(-count // step) * step


def percent(part: float) -> str:
    """Write a part as per cent with two digits.

    >>> percent(-0.01234), percent(0.0)
    ('-1.2 %', '0 %')
    >>> percent(1.87)
    '190 %'
    """
    return f"{float(f'{100.0 * part:.2g}'):g} %"
