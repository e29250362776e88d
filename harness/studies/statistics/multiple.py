"""Many checks, one false-alarm rate: Holm's step-down procedure.

Of m checks in which nothing differs each raises a false alarm at its level; at 5 % one of twenty would. Holm's
adjusted p-values are compared with one level for all, and the probability of one false alarm or more among all checks
of a report stays below it, however the checks depend on each other::

    p~_(i) = max_{j <= i} min(1, (m - j + 1) p_(j)),   p_(1) <= ... <= p_(m)

S. Holm, "A simple sequentially rejective multiple test procedure", Scand. J. Statist. 6, 65 (1979).

Checks of different kinds share the rate if all of them hand in their p-values together (`correct_together`).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np


def holm(p_values: Sequence[float]) -> np.ndarray:
    """Return the adjusted p-values (m,) in the order given. Raises ValueError for what is no probability.

    >>> holm([0.01, 0.04, 0.03]).tolist()
    [0.03, 0.06, 0.06]
    """
    p = np.asarray(p_values, dtype=float)
    if not ((p >= 0.0) & (p <= 1.0)).all():
        raise ValueError(f"p-values lie between 0 and 1, got {p}")
    order = np.argsort(p, kind="stable")
    stepped = np.maximum.accumulate(np.minimum(1.0, np.arange(len(p), 0, -1) * p[order]))
    adjusted = np.empty_like(p)
    adjusted[order] = stepped
    return adjusted


@dataclass(frozen=True, kw_only=True)
class Corrected:
    """What tests of one kind are told by a correction that they share with all others.

    adjusted: (k,) p-values. level: that each test is made at: p <= level just where its adjusted one is <= the rate.
    among: number of all tests.
    """

    adjusted: np.ndarray
    level: float
    among: int


def correct_together(rate: float, *kinds: Sequence[float]) -> list[Corrected]:
    """Correct the p-values of all kinds of tests of a report at one rate of false alarms; return each kind's part.

    The level is rate/(m - R) if R of m tests see a difference: R is the number at which Holm's procedure stops.

    >>> [c.level for c in correct_together(0.06, [0.001, 0.5], [0.2])]
    [0.03, 0.03]
    """
    every = holm([p for kind in kinds for p in kind])
    level = rate / max(1, int((every > rate).sum()))
    parts = np.split(every, np.cumsum([len(kind) for kind in kinds])[:-1])
    return [Corrected(adjusted=part, level=level, among=len(every)) for part in parts]
