"""Error bars of what is formed from time averages: ratios, deviators, angles of mean tensors.

The mean of a ratio is not the ratio of means, and the deviator of a noisy tensor is never 0; so quantities that are
not linear are formed from averages over all frames, g(<x>), not averaged themselves. Their error follows to first
order from the frames' influence on g (the infinitesimal jackknife: B. Efron, The Jackknife, the Bootstrap and Other
Resampling Plans, SIAM 1982, chapter 6)::

    g_t = g(<x>) + d/dh g(<x> + h (x_t - <x>)) at h = 0

is a series over frames with the mean g(<x>) whose own error, autocorrelation and all, is that of g(<x>).
"""

from __future__ import annotations

import warnings
from collections.abc import Callable, Mapping

import numpy as np

STEP = 1e-4
"""h of the difference, in deviations: truncation and round-off both stay near 1e-8 of the derivative or below."""

Means = Mapping[str, np.ndarray]
"""Time averages by name, (K, ...)."""


def linearised(formula: Callable[[Means], np.ndarray], series: Mapping[str, np.ndarray]) -> np.ndarray:
    """Return the series g_t, (F, ...), of a formula of means, from its inputs' series (F, ...); NaN are gaps.

    For a linear formula these are its values in the frames. First order only: where an average is not
    large against its error, g is not even nearly linear and the error an indication.
    """
    means = {name: _mean(values) for name, values in series.items()}
    value = np.asarray(formula(means), dtype=np.float64)
    frames = len(next(iter(series.values())))
    return np.array([
        value + _derivative(formula, means, {n: x[t] - means[n] for n, x in series.items()}) for t in range(frames)
    ])


def _derivative(formula: Callable[[Means], np.ndarray], means: Means, deviation: Means) -> np.ndarray:
    ahead, behind = (
        np.asarray(formula({n: m + h * deviation[n] for n, m in means.items()})) for h in (STEP, -STEP)
    )
    return (ahead - behind) / (2.0 * STEP)


def _mean(values: np.ndarray) -> np.ndarray:
    """Mean over frames, gaps left out; of a constant series exactly its value."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", RuntimeWarning)  # a cell without any value has the mean NaN
        first = np.where(np.isnan(values[0]), np.nanmean(values, axis=0), values[0])
        return first + np.nanmean(values - first, axis=0)
