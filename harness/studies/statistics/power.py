"""Equivalence, and what a number of replicates can tell.

Absence of evidence is none of absence: that no difference was seen says little unless one would have been. Hence

- equivalence: the difference is shown to be smaller than a margin M where both "d <= -M" and "d >= M" are refuted,
  each at the level: p = P(t_nu > (M - |d|)/error) (two one-sided tests; D. J. Schuirmann, J. Pharmacokinet.
  Biopharm. 15, 657 (1987), doi 10.1007/BF01068419);
- power: with which probability a difference Delta is seen at a level: P(|t'_nu(Delta/error)| > t(1 - level/2, nu)),
  t' Student's noncentral t (J. Cohen, Statistical Power Analysis, 2nd ed., Erlbaum 1988, chapter 2);
- the power of equivalence, where the true difference is Delta: with S^2 = error^2 chi^2_nu/nu
  E[max(0, Phi((M - Delta - t S)/error) - Phi((-M - Delta + t S)/error))] (K. F. Phillips, J. Pharmacokinet.
  Biopharm. 18, 137 (1990), doi 10.1007/BF01063556).

Errors are the measured ones: what is said of more replicates is an estimate.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from harness.studies.statistics.difference import FEWEST, Difference

POWER = 0.8
"""Probability with which a difference that is called resolvable is seen; four in five, Cohen's convention."""

MOST = 10_000
"""Replicates beyond which "more" is no advice."""

NODES = 400
"""Quantiles of chi^2 over which the power of equivalence is meaned: exact to 1e-4 (measured against 20000)."""


def equivalence_p(difference: Difference, margin: float) -> float:
    """Return the p-value of "the codes differ by `margin` or more", in the quantity's unit.

    Without an error 0 where |d| < margin, else 1.
    """
    from scipy.stats import t

    inside = margin - abs(difference.value)
    if difference.error == 0.0:
        return 0.0 if inside > 0.0 else 1.0
    return float(t.sf(inside / difference.error, difference.dof))


def detection_power(delta: float, error: float, dof: float, level: float) -> float:
    """Return the probability with which a true difference `delta` is seen at this two-sided level; error > 0."""
    from scipy.stats import nct, t

    if delta == 0.0:
        return level
    edge, shift = float(t.isf(level / 2.0, dof)), abs(delta) / error
    far, other = nct.sf(edge, dof, shift), nct.cdf(-edge, dof, shift)
    return float(np.nan_to_num(far, nan=float(shift > edge)) + np.nan_to_num(other))


def smallest_difference(difference: Difference, level: float, power: float = POWER) -> float:
    """Return the true difference that as many replicates see with probability `power`, in the quantity's unit."""
    from scipy.optimize import brentq
    from scipy.stats import t

    if difference.error == 0.0:
        return 0.0
    edge = float(t.isf(level / 2.0, difference.dof))
    high = 2.0 * edge + 10.0
    while detection_power(high, 1.0, difference.dof, level) < power:
        high *= 2.0
    found = brentq(lambda x: detection_power(x, 1.0, difference.dof, level) - power, 1e-9, high, rtol=1e-6)
    return float(found) * difference.error


def equivalence_power(delta: float, margin: float, error: float, dof: float, level: float) -> float:
    """Return the probability with which equivalence is shown at this level where the true difference is `delta`."""
    from scipy.stats import chi2, norm, t

    quantiles = (np.arange(NODES) + 0.5) / NODES
    wide = float(t.isf(level, dof)) * np.sqrt(chi2.ppf(quantiles, dof) / dof)
    upper, lower = (margin - delta) / error - wide, (-margin - delta) / error + wide
    return float(np.maximum(0.0, norm.cdf(upper) - norm.cdf(lower)).mean())


def replicates_to_see(difference: Difference, level: float, power: float = POWER) -> int | None:
    """Return how many replicates would see a true difference as large as the measured one; None for too many."""
    if difference.value == 0.0:
        return None

    def sees(n: int) -> bool:
        expected = difference.with_count(n)
        return expected.error == 0 or detection_power(expected.value, expected.error, expected.dof, level) >= power

    return _least(sees)


def replicates_to_equate(difference: Difference, margin: float, level: float, power: float = POWER) -> int | None:
    """Return how many replicates would show equivalence if the true difference is the measured one; None: no number.

    None for a difference that is not smaller than the margin, or for too many.
    """
    delta = abs(difference.value)
    if delta >= margin:
        return None

    def shows(n: int) -> bool:
        expected = difference.with_count(n)
        return expected.error == 0 or equivalence_power(delta, margin, expected.error, expected.dof, level) >= power

    return _least(shows)


def replicates_to_exceed(difference: Difference, margin: float, level: float, power: float = POWER) -> int | None:
    """Return how many replicates would show that the difference is beyond the margin if it is the measured one.

    One-sided: P(t'_nu((|d| - M)/error) > t(1 - level, nu)). None for a difference within the margin, or for too many.
    """
    from scipy.stats import nct, t

    beyond = abs(difference.value) - margin
    if beyond <= 0.0:
        return None

    def shows(n: int) -> bool:
        expected = difference.with_count(n)
        if expected.error == 0:
            return True
        edge, shift = float(t.isf(level, expected.dof)), beyond / expected.error
        return float(np.nan_to_num(nct.sf(edge, expected.dof, shift), nan=float(shift > edge))) >= power

    return _least(shows)


def _least(enough: Callable[[int], bool]) -> int | None:
    """Return the least count from FEWEST to MOST that is enough, as `enough` grows with the count."""
    low, high = FEWEST - 1, FEWEST
    while not enough(high):
        if high == MOST:
            return None
        low, high = high, min(2 * high, MOST)
    while high - low > 1:
        middle = (low + high) // 2
        low, high = (low, middle) if enough(middle) else (middle, high)
    return high
