"""How far apart two averages may lie by chance: Student's t with what is known of their errors.

Two runs of one packing are the same numbers until chaos parts them and independent afterwards, so their errors add in
quadrature; what they still share makes that an overestimate, never the reverse. With one packing the errors are those
of the time averages, samples counted by autocorrelation. They are pooled over all runs: if the codes agree, as the test
supposes, all sample one process, and one run may show a slow change that others do not live to see (measured: the
fabric of the first layer turned by 50 degrees in one of four runs within 25 s and stayed within 10 in the others).
Degrees of freedom of the pooled variance: F. E. Satterthwaite, Biometrics Bull. 2, 110 (1946). With several packings
each is compared with itself, and the scatter of the differences is the error.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from harness.studies.compare.profiles import Profile

ROUNDING = 1e-12
"""Relative: what identical numbers, summed in another order, may be apart."""


@dataclass(frozen=True, kw_only=True)
class Difference:
    """Two means in K cells: difference, standard error of it, degrees of freedom, each (K,); NaN where unknown.

    short: (K,), errors that are not to be trusted. used: (K,), cells that have a value in half of all frames at least.
    """

    value: np.ndarray
    error: np.ndarray
    freedom: np.ndarray
    short: np.ndarray
    used: np.ndarray

    def resolved(self, size: float) -> Difference:
        """Return the difference with errors that rounding of numbers of this size accounts for, at least."""
        return replace(self, error=np.maximum(self.error, ROUNDING * size))

    def limit(self, level: float) -> np.ndarray:
        """Return the standard errors within which it lies by chance but for a probability of `level`, (K,)."""
        from scipy.stats import t

        freedom = np.maximum(np.nan_to_num(self.freedom, nan=1.0), 1e-3)
        return np.where(np.isnan(self.freedom), np.nan, t.isf(level / 2.0, freedom))

    @property
    def sizes(self) -> np.ndarray:
        """|difference| in standard errors, (K,): 0 for equal values, infinite without any scatter."""
        apart = np.abs(self.value)
        with np.errstate(divide="ignore", invalid="ignore"):
            return np.where(apart == 0, 0.0, apart / self.error)


def of_times(a: Profile, b: Profile, runs: Sequence[Profile]) -> Difference:
    """Difference of two runs' time averages, a - b, with the errors of all runs, these two among them."""
    known = np.array([_used(p) for p in runs])
    variance = np.where(known, [p.error**2 for p in runs], 0.0)
    freedom = np.maximum(np.nan_to_num([p.samples for p in runs], nan=1.0) - 1.0, 0.5)
    total, shares = variance.sum(axis=0), (variance**2 / freedom).sum(axis=0)
    constant = total == 0
    return Difference(
        value=a.mean - b.mean, error=np.sqrt(2.0 * total / np.maximum(known.sum(axis=0), 1)),
        short=np.fmin(a.frames, b.frames) < frames_needed(runs),
        freedom=np.where(constant, np.inf, total**2 / np.where(constant, 1.0, shares)),
        used=_used(a) & _used(b),
    )


def frames_needed(runs: Sequence[Profile]) -> float:
    """Frames that it takes for the errors to be trusted: mean over the runs, whose own numbers scatter."""
    return float(np.mean([p.needed for p in runs]))


def of_packings(pairs: Sequence[tuple[Profile, Profile]]) -> Difference:
    """Mean difference over packings, each with itself; n - 1 degrees of freedom of n packings."""
    apart = np.array([a.mean - b.mean for a, b in pairs])
    n, cells = apart.shape
    return Difference(
        value=apart.mean(axis=0), error=apart.std(axis=0, ddof=1) / np.sqrt(n), freedom=np.full(cells, n - 1.0),
        short=np.zeros(cells, dtype=bool), used=np.all([_used(p) for ab in pairs for p in ab], axis=0),
    )


def of_mean(profile: Profile, expected: np.ndarray | float = 0.0) -> Difference:
    """Difference of a time average from a number."""
    constant = profile.error == 0
    return Difference(
        value=profile.mean - expected, error=profile.error, short=profile.short, used=_used(profile),
        freedom=np.where(constant, np.inf, np.maximum(profile.samples - 1.0, 0.5)),
    )


def _used(p: Profile) -> np.ndarray:
    return np.isfinite(p.mean) & np.isfinite(p.error) & (p.frames >= p.frames.max(initial=0) / 2.0)
