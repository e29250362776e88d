"""What is said of times: ratios within rounds, and how cost grows with the number of particles."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

LEAST_COUNT = 1000
"""Particles from which cost is expected to grow in proportion; below, each operation's own cost shows."""


class Spread(NamedTuple):
    """Median, least and largest of a few values."""

    median: float
    low: float
    high: float


class Exponent(NamedTuple):
    """p in t ~ N^p, its standard error, and the number of sizes it comes from."""

    value: float
    error: float
    sizes: int


def spread(values: np.ndarray) -> Spread:
    """Return the spread of (R,) values, one at least."""
    return Spread(float(np.median(values)), float(values.min()), float(values.max()))


def ratio(seconds: np.ndarray, other: np.ndarray) -> Spread | None:
    """Return the spread of seconds/other, both (R,) by round; None where either is empty.

    >>> ratio(np.array([1.0, 2.0, 6.0]), np.array([2.0, 2.0, 2.0]))
    Spread(median=1.0, low=0.5, high=3.0)
    """
    return spread(seconds / other) if len(seconds) and len(other) else None


def exponent(counts: Sequence[int], seconds: Sequence[float]) -> Exponent | None:
    """Fit ln t = p ln N + c by least squares over the sizes N >= LEAST_COUNT; None with fewer than three of them.

    The error is the standard error of the slope from the scatter about the line, sqrt(RSS/(n-2)/Sxx).
    """
    points = [(math.log(n), math.log(t)) for n, t in zip(counts, seconds, strict=True) if n >= LEAST_COUNT]
    if len(points) < 3:
        return None
    x, y = np.array(points).T
    dx = x - x.mean()
    slope = float(dx @ y / (dx @ dx))
    rest = y - y.mean() - slope * dx
    return Exponent(slope, math.sqrt(float(rest @ rest / (len(x) - 2) / (dx @ dx))), len(x))


def growth(counts: Sequence[int], amounts: Sequence[float]) -> float | None:
    """Return b in amount = a + b N by least squares over the sizes N >= LEAST_COUNT; None with fewer than two."""
    points = [(n, a) for n, a in zip(counts, amounts, strict=True) if n >= LEAST_COUNT]
    if len({n for n, _ in points}) < 2:
        return None
    x, y = np.array(points, float).T
    dx = x - x.mean()
    return float(dx @ y / (dx @ dx))
