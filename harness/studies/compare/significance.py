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

POWER = 0.8
"""Probability with which a difference that "would be seen" is seen, as in `harness.studies.statistics.power`."""

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

    def p_values(self) -> np.ndarray:
        """Return the two-sided p-value of "no difference", (K,): 2 P(t_nu > |d|/error), NaN where nu is unknown."""
        from scipy.stats import t

        freedom = np.maximum(np.nan_to_num(self.freedom, nan=1.0), 1e-3)
        return np.where(np.isnan(self.freedom), np.nan, 2.0 * t.sf(self.sizes, freedom))

    @property
    def trusted(self) -> np.ndarray:
        """(K,), cells that are used and whose errors are to be trusted: only they can differ."""
        return self.used & ~self.short

    def seen_from(self, level: float) -> np.ndarray:
        """Return the true difference that a test at this level sees with probability POWER, (K,).

        The noncentral t by N. L. Johnson and B. L. Welch, Biometrika 31, 362 (1940): the error s that is found has the
        mean c sigma and the variance (1 - c^2) sigma^2, so that with the limit h = t(1 - level/2, nu) it is
        [c h + z(POWER) sqrt(1 + h^2 (1 - c^2))] error. Within 0.5 % of the exact one for nu >= 4 and levels >= 1e-6.
        """
        from scipy.stats import norm

        limit = self.limit(level)
        c = _mean_scatter(np.maximum(np.nan_to_num(self.freedom, nan=1.0), 1e-3))
        steps = c * limit + norm.ppf(POWER) * np.sqrt(1.0 + limit**2 * (1.0 - c**2))
        with np.errstate(invalid="ignore"):
            return np.where(self.error == 0, 0.0, steps * self.error)

    def longer(self, factor: float) -> Difference:
        """Return what averages `factor` times as long would be expected to give: smaller errors, better known."""
        return replace(self, error=self.error / np.sqrt(factor), freedom=self.freedom * factor)

    def over_packings(self, number: float, now: int = 1) -> Difference:
        """Return what `number` packings would be expected to give, if `now` of them have these errors."""
        return replace(
            self, error=self.error * np.sqrt(now / number), freedom=np.full(self.error.shape, number - 1.0)
        )

    @property
    def sizes(self) -> np.ndarray:
        """|difference| in standard errors, (K,): 0 for equal values, infinite without any scatter."""
        apart = np.abs(self.value)
        with np.errstate(divide="ignore", invalid="ignore"):
            return np.where(apart == 0, 0.0, apart / self.error)


def _mean_scatter(freedom: np.ndarray) -> np.ndarray:
    """Return E[s]/sigma, sqrt(2/nu) Gamma((nu + 1)/2)/Gamma(nu/2); 1 - 1/(4 nu) for many."""
    from scipy.special import gammaln

    few = np.minimum(freedom, 1e6)
    exact = np.sqrt(2.0 / few) * np.exp(gammaln((few + 1.0) / 2.0) - gammaln(few / 2.0))
    return np.where(freedom < 1e3, exact, 1.0 - 0.25 / freedom)


def of_times(a: Profile, b: Profile, runs: Sequence[Profile]) -> Difference:
    """Difference of two runs' time averages, a - b, with the errors of all runs, these two among them."""
    known = np.array([_used(p) for p in runs])
    variance = np.where(known, [p.error**2 for p in runs], 0.0)
    freedom = np.array([p.known for p in runs])
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
        freedom=np.where(constant, np.inf, profile.known),
    )


def _used(p: Profile) -> np.ndarray:
    return np.isfinite(p.mean) & np.isfinite(p.error) & (p.frames >= p.frames.max(initial=0) / 2.0)


def difference_of(sides: Sequence[tuple[Profile, Profile]], pool: Sequence[Profile]) -> Difference:
    """Difference of two codes: of a single packing's time averages, with the errors of all runs, else over packings."""
    return of_times(*sides[0], pool or sides[0]) if len(sides) == 1 else of_packings(sides)
