"""The difference of a quantity between two codes, from replicates, with its standard error.

Replicates of both codes that start from one packing are compared packing by packing::

    d_k = a_k - b_k,   d = mean of d_k,   error = s_d/sqrt(n),   nu = n - 1

What a packing does to both codes alike cancels, so the error is that of what the codes do differently (W. S. Gosset,
"The probable error of a mean", Biometrika 6, 1 (1908), section IX). Before chaos that is thousands of times less than
the spread over packings. Replicates without a common packing are two samples of their own::

    error^2 = s_a^2/n_a + s_b^2/n_b,   nu = error^4 / sum (s^2/n)^2/(n - 1)

(B. L. Welch, Biometrika 34, 28 (1947), doi 10.1093/biomet/34.1-2.28). s is the scatter over replicates: whatever makes
runs scatter is in it, also that a time average is of a finite time. The autocorrelation-aware error of one run
(`postproc.uncertainty`) is therefore shown beside it and not added to it.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

FEWEST = 2
"""Replicates without which there is no scatter."""


@dataclass(frozen=True, kw_only=True)
class Difference:
    """value and error in the unit of the quantity, error > 0 or 0 where all replicates say the same.

    dof: nu of Student's t. count: replicates a side. paired: whether packings were shared.
    """

    value: float
    error: float
    dof: float
    count: int
    paired: bool

    def with_count(self, count: int) -> Difference:
        """Return what `count` replicates would be expected to say: the same scatter, a smaller error."""
        each = 1 if self.paired else 2
        return Difference(
            value=self.value, error=self.error * (self.count / count) ** 0.5, dof=float(each * (count - 1)),
            count=count, paired=self.paired,
        )


def paired_difference(a: np.ndarray, b: np.ndarray) -> Difference:
    """Return the mean of a - b, replicates (n,) of one packing beside each other. Raises ValueError for n < 2."""
    d = _finite(a) - _finite(b)
    return Difference(
        value=float(d.mean()), error=float(d.std(ddof=1) / np.sqrt(len(d))), dof=len(d) - 1.0, count=len(d), paired=True
    )


def independent_difference(a: np.ndarray, b: np.ndarray) -> Difference:
    """Return mean a - mean b of independent replicates (n_a,), (n_b,). Raises ValueError for fewer than 2 of either."""
    a, b = _finite(a), _finite(b)
    squares = np.array([x.var(ddof=1) / len(x) for x in (a, b)])
    free = np.array([len(a) - 1.0, len(b) - 1.0])
    total = float(squares.sum())
    dof = total**2 / float((squares**2 / free).sum()) if total > 0 else float(free.sum())
    return Difference(
        value=float(a.mean() - b.mean()), error=total**0.5, dof=dof, count=min(len(a), len(b)), paired=False
    )


def p_value(difference: Difference, negligible: float = 0.0) -> float:
    """Return the two-sided p-value of "the codes differ by no more than `negligible`", in the quantity's unit.

    2 P(t_nu > (|d| - negligible)/error), 1 at most: Student's t test for negligible = 0, else on the safe side of it.
    Without an error (all replicates alike) 1 where |d| <= negligible, else 0.
    """
    from scipy.stats import t

    beyond = abs(difference.value) - negligible
    if beyond <= 0.0:
        return 1.0
    return float(2.0 * t.sf(beyond / difference.error, difference.dof)) if difference.error > 0 else 0.0


def half_width(difference: Difference, level: float) -> float:
    """Return h so that d +- h misses the true difference with probability `level`: t(1 - level/2, nu) error."""
    from scipy.stats import t

    return float(t.isf(level / 2.0, difference.dof) * difference.error)


def _finite(values: np.ndarray) -> np.ndarray:
    values = np.asarray(values, dtype=float)
    if len(values) < FEWEST or not np.isfinite(values).all():
        raise ValueError(f"{FEWEST} finite replicates or more are needed, got {values}")
    return values
