"""Curves over replicates: the mean, and how well it is known.

    mean = sum q_k/n, error = s/sqrt(n), s^2 = sum (q_k - mean)^2/(n - 1) over n packings, place by place

One packing has no error: its curve has no band, which is not a band of width zero.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

SAME_PLACE = 1e-9
"""Places of two runs that differ by less, of the whole way, are one place."""


@dataclass(frozen=True, kw_only=True)
class Band:
    """place, mean, error: (S,), the error None of a single curve. count: curves."""

    place: np.ndarray
    mean: np.ndarray
    error: np.ndarray | None
    count: int


def band_over(places: Sequence[np.ndarray], values: Sequence[np.ndarray]) -> Band:
    """Return the band of n >= 1 curves, values (S_k,) at places (S_k,) that grow, at the places of the first.

    A curve sampled elsewhere is interpolated linearly between its samples; where it has none, NaN.
    """
    first = places[0]
    rows = np.array([_at(first, p, v) for p, v in zip(places, values, strict=True)])
    n = len(rows)
    error = rows.std(axis=0, ddof=1) / np.sqrt(n) if n > 1 else None
    return Band(place=first, mean=rows.mean(axis=0), error=error, count=n)


def _at(wanted: np.ndarray, place: np.ndarray, value: np.ndarray) -> np.ndarray:
    way = float(np.ptp(wanted))
    if len(place) == len(wanted) and np.abs(place - wanted).max(initial=0.0) <= SAME_PLACE * way:
        return value
    return np.interp(wanted, place, value, left=np.nan, right=np.nan)
