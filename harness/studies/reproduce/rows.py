"""Rows: our numbers beside the talk's, with a verdict that only a value seen in its source can decide.

What the talk prints is the result of one packing of 1950 discs (or of one ring), and ours scatter. Two kinds of goals:

    spread      the talk's value lies in the 95 % prediction interval of the next packing,
                mean +- t(0.975, n - 1) s sqrt(1 + 1/n), n >= 3 (`harness.studies.compare.published`)
    tolerance   |ours - talk| <= tolerance. It is met, or missed, beyond our own error: with the half width
                h = t(0.975, n - 1) s/sqrt(n) of the mean's 95 % interval, |deviation| + h <= tolerance agrees,
                |deviation| - h > tolerance differs, in between the packings cannot tell.

A value that is recalled, not seen, decides nothing; nor does a small size where the talk's number is one of its own
size.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np

from harness.studies.compare.published import FEWEST, prediction_half_width
from harness.studies.reproduce.protocol import Measured, Row
from harness.studies.verdict import Check, Verdict, not_checked
from reference.values import Published, published_values

SMALL = "a quick size states the deviation; the paper size decides"
RECALLED = "the value is recalled, not seen: no verdict"


@dataclass(frozen=True, kw_only=True)
class Spread:
    """Goal: within the spread of the packings."""


@dataclass(frozen=True, kw_only=True)
class Within:
    """Goal: within so much of the talk's value, in its unit or, `relative`, as a part of it."""

    tolerance: float
    relative: bool = False

    def size(self, talk: float) -> float:
        """Return the tolerance in the unit of the value."""
        return self.tolerance * abs(talk) if self.relative else self.tolerance


Goal = Spread | Within


def over_packings(engine: str, values: Sequence[float]) -> Measured:
    """Return mean and standard error s/sqrt(n) of one value a packing; a packing that has none (NaN) is left out."""
    known = np.array([v for v in values if np.isfinite(v)], dtype=float)
    n = len(known)
    return Measured(
        engine=engine, packings=n, values=tuple(known.tolist()),
        value=float(known.mean()) if n else float("nan"),
        error=float(known.std(ddof=1) / np.sqrt(n)) if n > 1 else None,
    )


def compared(name: str, ours: Measured, goal: Goal, *, quick: bool = False, note: str = "") -> Row:
    """Return the row of a value of `reference.values` by its name. quick: see `SMALL`. note: put behind the reason."""
    return held_against(published_values()[name], ours, goal, quick=quick, note=note)


def held_against(talk: Published, ours: Measured, goal: Goal, *, quick: bool = False, note: str = "") -> Row:
    """Return the row of a value that is not tabulated, as a closed form at the numbers of a scene."""
    deviation, tolerance = ours.value - talk.value, _tolerance(goal, ours, talk)
    verdict, why = _verdict(goal, ours, talk, deviation, tolerance, quick=quick)
    return Row(
        quantity=talk.quantity, unit=talk.unit, ours=ours, talk=talk,
        deviation=deviation if np.isfinite(deviation) else None, tolerance=tolerance, verdict=verdict,
        why="; ".join(w for w in (why, note) if w),
    )


def shown(quantity: str, unit: str, ours: Measured, why: str) -> Row:
    """Return the row of a number of ours for which the talk prints none: nothing to check, and said so."""
    return Row(
        quantity=quantity, unit=unit, ours=ours, talk=None, deviation=None, tolerance=None, verdict="not_checked",
        why=why,
    )


def larger_than(limit: float, ours: Measured, *, quantity: str, against: str) -> Check:
    """Return the check of words without a number: that ours lies above `limit`, its 95 % interval included."""
    facts = {"level": "L3", "quantity": quantity, "left": ours.engine, "right": against}
    half = half_width(ours)
    if not np.isfinite(ours.value):
        return not_checked(**facts, why="no packing gave this number")
    said = f"{ours.value:.3g}, to be above {limit:g}"
    if half is None:
        return Check(**facts, deviation=None, tolerance=None, verdict="inconclusive", why=f"{said}; one packing")
    verdict: Verdict = "inconclusive"
    if abs(ours.value - limit) > half:
        verdict = "agrees" if ours.value > limit else "differs"
    why = f"{said}; +- {half:.2g} (95 % interval over {ours.packings} packings)"
    return Check(**facts, deviation=ours.value, tolerance=None, verdict=verdict, why=why)


def half_width(ours: Measured) -> float | None:
    """Return the half width of the mean's 95 % interval; None without an error.

    Of values formed packing by packing with Student's t of n - 1 degrees of freedom, else 1.96 standard errors.
    """
    if ours.error is None:
        return None
    if len(ours.values) < 2:
        return 1.96 * ours.error
    from scipy.stats import t

    return float(t.ppf(0.975, len(ours.values) - 1)) * ours.error


def _tolerance(goal: Goal, ours: Measured, talk: Published) -> float | None:
    if isinstance(goal, Within):
        return goal.size(talk.value)
    return prediction_half_width(np.array(ours.values)) if len(ours.values) >= FEWEST else None


def _verdict(
    goal: Goal, ours: Measured, talk: Published, deviation: float, tolerance: float | None, *, quick: bool
) -> tuple[Verdict, str]:
    if not np.isfinite(deviation):
        return "not_checked", "no packing gave this number"
    if not talk.decides:
        return "inconclusive", RECALLED
    if quick:
        return "inconclusive", SMALL
    if isinstance(goal, Spread):
        return _by_spread(deviation, tolerance, len(ours.values))
    return _by_tolerance(deviation, goal.size(talk.value), half_width(ours))


def _by_spread(deviation: float, tolerance: float | None, count: int) -> tuple[Verdict, str]:
    if tolerance is None:
        return "inconclusive", f"a spread needs {FEWEST} packings, there are {count}"
    inside = abs(deviation) <= tolerance
    where = "within" if inside else "outside of"
    return ("agrees" if inside else "differs"), f"{where} the 95 % prediction interval of {count} packings"


def _by_tolerance(deviation: float, tolerance: float, half: float | None) -> tuple[Verdict, str]:
    if half is None:
        return "inconclusive", "one packing has no error bar"
    if abs(deviation) + half <= tolerance:
        return "agrees", "within the tolerance, error bar included"
    if abs(deviation) - half > tolerance:
        return "differs", "off by more than the tolerance, error bar included"
    return "inconclusive", f"the 95 % interval of the mean, +- {half:.3g}, reaches across the tolerance"


def spanned(values: Iterable[float], form: str) -> str:
    """Return the least and the largest of one number or more, in words; one number where they read the same.

    >>> spanned([27.58, 22.9], ".1f"), spanned([27.58], ".1f"), spanned([-0.021, 0.3], "+.0%")
    ('22.9 to 27.6', '27.6', '-2% to +30%')
    """
    known = list(values)
    low, high = format(min(known), form), format(max(known), form)
    return low if low == high else f"{low} to {high}"
