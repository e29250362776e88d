"""How two runs part: how fast their difference grows, when it reaches a size, and what else grows alike.

In a chaotic system a small difference grows like exp(lambda t) until it is as large as the fluctuations. It does so in
bursts: wherever contacts open and close it jumps, in between it rests. ln D is thus a random walk with a drift, and::

    lambda = mean of d(ln D)/dt, its error that of the mean of the increments (autocorrelation-aware)
    D reaches a level at t, with an error of (t - t_0) error(lambda)/lambda from where it begins to rise at t_0

(the second is the first-passage time of such a walk; E. Schroedinger, Phys. Z. 16, 289 (1915): variance L s^2/lambda^3
for a way of L = lambda (t - t_0), with s^2 = error(lambda)^2 (t - t_0)). D is the largest difference so far: the
difference of two signals passes zero now and then without being any smaller for it.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from postproc.uncertainty import estimate

RISING, SATURATED = 1e-9, 1e-3
"""Relative differences between which growth is fitted: above the rounding of forces, below that of all fluctuations."""

LOST = 1e-13
"""Relative difference of forces below which nothing is told: a place is known to 1.1e-16, and an overlap is a
thousandth of a place or less."""

FEWEST = 4
"""Samples on the way up without which no rate is fitted."""


@dataclass(frozen=True, kw_only=True)
class Rise:
    """rate, error: 1/s. start: time from which on the growth was fitted, s."""

    rate: float
    error: float
    start: float


@dataclass(frozen=True, kw_only=True)
class Excess:
    """Largest ratio of a difference to a response, and the sample it was found at."""

    ratio: float
    sample: int


def largest_so_far(difference: np.ndarray) -> np.ndarray:
    """Return the running maximum of |difference| (S,); from a NaN on it is infinite, as nothing is known any more."""
    return np.maximum.accumulate(np.nan_to_num(np.abs(difference), nan=np.inf, posinf=np.inf))


def rise_of(time: np.ndarray, so_far: np.ndarray) -> Rise | None:
    """Return how `so_far` (S,) grows between RISING and SATURATED, None with too few samples there."""
    above, below = so_far > RISING, so_far <= SATURATED
    way = np.flatnonzero(above & below)
    if len(way) < FEWEST:
        return None
    increments = np.diff(np.log(so_far[way])) / np.diff(time[way])
    found = estimate(increments)
    if not found.mean > 0:
        return None
    return Rise(rate=float(found.mean), error=float(found.error), start=float(time[way[0]]))


def reached(so_far: np.ndarray, level: float) -> int | None:
    """Return the first sample at which `so_far` (S,) exceeds a level, None if it never does."""
    beyond = np.flatnonzero(so_far > level)
    return int(beyond[0]) if beyond.size else None


def reaching_error(rise: Rise, time: float) -> float:
    """Return the standard error of the time at which a level is reached, s."""
    return max(time - rise.start, 0.0) * rise.error / rise.rate


def excess(so_far: np.ndarray, response: np.ndarray, ceiling: float) -> Excess | None:
    """Return where a difference (S,) is largest beside a response (S,), both largest so far, both small still.

    Samples count while neither has reached the ceiling before: the one in which it is reached does, so that a
    difference that is large at once is seen. A response below LOST counts as LOST. None without samples.
    """
    if not so_far.size:
        return None
    before = np.concatenate([[True], (so_far[:-1] <= ceiling) & (response[:-1] <= ceiling)])
    ratio = np.where(before, so_far / np.maximum(response, LOST), -np.inf)
    sample = int(np.argmax(ratio))
    return Excess(ratio=float(ratio[sample]), sample=sample)
