"""Verdicts on many quantities of several pairs of codes at once, from replicates (level L3).

For every quantity and pair: the difference with its error (`difference`), whether it is one at all (Student's t, one
false-alarm rate for the whole family: `multiple`), whether it is shown to be small (`power`), and what the number of
replicates can tell::

    differs       it is not zero: adjusted p <= the declared rate; between codes of different conventions only if it
                  is not shown to be smaller than the margin, as conventions may differ by a little
    agrees        it is shown to be smaller than the margin (equivalence), and no difference is seen
    inconclusive  neither: no evidence of a difference is no evidence of none; more replicates would tell

Codes that compute the same thing differ by round-off before chaos and by nothing on average after it; what is below
ROUND_OFF is no difference for them. That all of several agreements hold is as sure as each (R. L. Berger, Technometrics
24, 295 (1982), doi 10.1080/00401706.1982.10487790), so equivalence is not adjusted.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
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
from harness.studies.statistics.multiple import holm
from harness.studies.statistics.power import (
    POWER,
    equivalence_p,
    replicates_to_equate,
    replicates_to_see,
    smallest_difference,
)
from harness.studies.verdict import Check, Rerun, Verdict

ROUND_OFF = 1e-6
"""Of a quantity's scale: what the shipped scenes allow pointwise between runs that part by round-off alone."""

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
    """One quantity of one pair. left, right: mean and its standard error over replicates; scale: see `Measured`."""

    measured: Measured
    pair: Pair
    difference: Difference
    left: tuple[float, float]
    right: tuple[float, float]
    scale: float
    p: float


@dataclass(frozen=True, kw_only=True)
class Judged:
    """A verdict and all that it rests on. adjusted: Holm's p-value. level: of this check within its family."""

    tested: Tested
    adjusted: float
    level: float
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
        if self.seen and (self.tested.pair.kind in SAME or not self.small):
            return "differs"
        return "agrees" if self.small else "inconclusive"

    @cached_property
    def equivalence(self) -> float:
        """p-value of "the margin or more"."""
        return equivalence_p(self.tested.difference, self._margin)

    @cached_property
    def chance(self) -> float:
        """What may lie between the sides by chance at this level, over the scale."""
        return half_width(self.tested.difference, self.level) / self.tested.scale

    @cached_property
    def resolvable(self) -> float:
        """True difference that would be seen with probability POWER, over the scale."""
        return smallest_difference(self.tested.difference, self.level) / self.tested.scale

    @cached_property
    def settle(self) -> int | None:
        """Replicates that would see a difference as large as this, or show that it is small, whichever are fewer.

        None of a check that is settled, or when neither is known to do.
        """
        if self.verdict != "inconclusive":
            return None
        d = self.tested.difference
        counts = (
            replicates_to_see(d, self.level), replicates_to_equate(d, self._margin, self.terms.false_alarms)
        )
        return min((n for n in counts if n is not None), default=None)

    @property
    def _margin(self) -> float:
        return self.terms.margin * self.tested.scale


def judge_family(quantities: Sequence[Measured], pairs: Sequence[Pair], terms: Terms) -> list[Judged]:
    """Judge every quantity of every pair that has replicates enough, in this order."""
    tested = [t for m in quantities for pair in pairs if (t := _tested(m, pair, paired=terms.paired)) is not None]
    adjusted = holm([t.p for t in tested]).tolist()
    level = terms.false_alarms / max(1, sum(p > terms.false_alarms for p in adjusted))
    return [Judged(tested=t, adjusted=p, level=level, terms=terms) for t, p in zip(tested, adjusted, strict=True)]


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
    """Return a check a verdict. deviation: |difference|; tolerance: the margin where it agrees, else chance."""
    return [
        Check(
            level="L3", quantity=j.tested.measured.quantity, left=j.tested.pair.left, right=j.tested.pair.right,
            deviation=abs(j.relative), tolerance=j.terms.margin if j.verdict == "agrees" else j.chance,
            verdict=j.verdict, why=_why(j, len(judged), rerun),
        )
        for j in judged
    ]


def _why(j: Judged, tests: int, rerun: Rerun) -> str:
    parts = [_sides(j), _apart(j, tests)]
    if j.verdict == "inconclusive":
        parts.append(_more(j))
    if j.verdict == "differs":
        parts.append(f"rerun: {rerun(j.tested.pair.left, j.tested.pair.right)}")
    return "; ".join(parts)


def _sides(j: Judged) -> str:
    """Say both sides with their errors, and how they were compared."""
    t, unit = j.tested, "" if j.tested.measured.unit == "1" else f" {j.tested.measured.unit}"
    how = "paired by packing" if t.difference.paired else "independent"
    (a, da), (b, db) = t.left, t.right
    sides = f"{a:.4g} +- {da:.2g} and {b:.4g} +- {db:.2g}{unit}"
    return f"{sides}, {t.difference.count} replicates, {how}: apart by {percent(j.relative)} +- {percent(j.error)}"


def _apart(j: Judged, tests: int) -> str:
    among, within = f"p = {j.adjusted:.2g} among {tests} checks", f"within {percent(j.terms.margin)}"
    if j.seen:
        return f"seen ({among}), {'but shown to be' if j.small else 'not shown to be'} {within}"
    if j.small:
        return f"shown to be {within} (p = {j.equivalence:.2g})"
    return f"no difference seen ({among}), which is no evidence of none: not shown to be {within}"


def _more(j: Judged) -> str:
    would = f"{percent(j.resolvable)} would be seen with probability {POWER:g}"
    return f"{would}; about {j.settle} replicates would settle it" if j.settle else f"{would}; no number is known to do"


def percent(part: float) -> str:
    """Write a part as per cent with two digits.

    >>> percent(-0.01234), percent(0.0)
    ('-1.2 %', '0 %')
    """
    return f"{100.0 * part:.2g} %"
