"""Means of correlated series with error bars: how much do F frames of one run really say?

Neighbouring frames resemble each other, so the standard error of their mean is not sigma/sqrt(F) but::

    error^2 = 2 tau sigma^2 / F,      tau = 1/2 + sum_{t=1}^{W} rho(t)

with tau the integrated autocorrelation time in frames (1/2: independent) and rho the normalised autocorrelation.
Effective number of samples F/(2 tau). The sum is cut at the smallest W >= WINDOW tau(W): beyond, it adds noise only.
The error itself comes from a sum over 2 W + 1 lags, each with a scatter of its own: the relative variance of its square
is 2 (2 W + 1)/F (N. Madras and A. D. Sokal, J. Stat. Phys. 50, 109 (1988), appendix C), so that Student's t has
F/(2 W + 1) degrees of freedom (F. E. Satterthwaite, Biometrics Bull. 2, 110 (1946)), fewer than there are samples.
Measured on AR(1) series with tau = 2, errors to be trusted: at 100, 300 and 1000 tau tests at a level of 1e-3 see what
is not there 1.1, 1.2 and 0.8 times as often as they should; with F/(2 tau) - 1 degrees of freedom 4.5, 1.7 and 1.1.
tau below 1/2 (frames that swing against each other) is taken as 1/2, since such a window cannot measure it: the error
is then an upper bound.
Source: A. D. Sokal, "Monte Carlo Methods in Statistical Mechanics", in Functional Integration (Plenum 1997),
eqs. (3.8), (3.12) and section 3.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

WINDOW = 5.0
"""Sokal's c: the window is c tau. For a decay exp(-t/tau) it leaves out exp(-5) of tau, 0.7 %."""

ENOUGH = 50.0
"""Frames per tau below which tau, and with it the error, is not to be trusted (it comes out too small)."""

ENOUGH_POOLED = 30.0
"""The same where tau is pooled over the cells of a profile, as in `estimate(pooled=True)`. Measured on pairs of AR(1)
profiles of 20 cells whose means are equal, t tests with F/(2 tau) - 1 degrees of freedom: at 30 frames per pooled tau
false alarms at levels of 1e-2, 1e-3, 1e-4 come 1.4, 1.8 and 2.7 times as often as they should, at 50 and beyond as
often or more rarely. With a tau of its own for each cell they come 10 to 36 times as often at 50."""

LEAST_FREEDOM = 0.5
"""Degrees of freedom below which none are counted: Student's t needs some."""

FEWEST = 2
"""Frames without which there is no scatter."""

FINE, CONSTANT, SHORT, FEW = "", "constant", "short", "few"
REASONS = {
    FINE: "",
    CONSTANT: "all frames have the same value: no fluctuation to tell an error from",
    SHORT: f"fewer than {ENOUGH:g} autocorrelation times long: the error is a lower bound",
    FEW: f"fewer than {FEWEST} frames have a value",
}
"""By word: why an error is missing or not to be trusted."""


@dataclass(frozen=True, kw_only=True)
class Estimate:
    """Time averages of F frames of values (...), each field of shape (...).

    mean, error: in the unit of the values; error is one standard error of the mean. tau: in frames. samples: effective
    number F/(2 tau). freedom: degrees of freedom of the error. frames: how many have a value (NaN is none). doubt: ""
    or a word of REASONS. Without frames the mean is NaN; in a constant series the error is 0, tau and freedom NaN.
    """

    mean: np.ndarray
    error: np.ndarray
    tau: np.ndarray
    samples: np.ndarray
    freedom: np.ndarray
    frames: np.ndarray
    doubt: np.ndarray


def estimate(series: np.ndarray, *, pooled: bool = False) -> Estimate:
    """Average series (F, ...) of evenly spaced frames over their first axis; NaN are gaps.

    The mean is that of the frames with a value; pairs of frames with one count in the autocorrelation.
    pooled: the series are cells of one profile, whose autocorrelation times are alike: tau of each is at least
    the mean of all. A short series' own tau scatters, and where it comes out small the error does, too; tests over
    many cells would find just these. The tau of many cells is well known, and freedom F/(2 tau) - 1.
    """
    series = np.asarray(series, dtype=np.float64)
    shape = series.shape[1:]
    if not len(series):
        series = np.full((1, *shape), np.nan)  # no frame is a frame without a value
    flat = series.reshape(len(series), math.prod(shape))
    known = np.isfinite(flat)
    frames = known.sum(axis=0)
    total = np.where(known, flat, 0.0).sum(axis=0)
    mean = np.divide(total, frames, out=np.full(frames.shape, np.nan), where=frames > 0)
    deviation = np.where(known, flat - mean, 0.0)
    covariance = _autocovariance(deviation, known)
    few, constant = frames < FEWEST, _constant(flat, known)
    tau, enough = _times(covariance, few | constant, pooled=pooled)
    error = _standard_error(covariance[0], tau, frames)
    error[constant & ~few] = 0.0
    samples = frames / (2.0 * tau)
    found = {
        "mean": mean, "error": error, "tau": tau, "samples": samples, "frames": frames,
        "freedom": np.maximum(samples - 1.0 if pooled else frames / (2.0 * WINDOW * tau + 1.0), LEAST_FREEDOM),
        "doubt": np.select([few, constant, frames < enough], [FEW, CONSTANT, SHORT], FINE),
    }
    return Estimate(**{name: values.reshape(shape) for name, values in found.items()})


def _times(covariance: np.ndarray, still: np.ndarray, *, pooled: bool) -> tuple[np.ndarray, np.ndarray]:
    """Return tau of every series, NaN where it is `still`, and the frames from which it is believed."""
    tau = np.full(still.shape, np.nan)
    tau[~still] = integrated_time(covariance[:, ~still])
    if not pooled or still.all():
        return tau, ENOUGH * tau
    typical = float(np.mean(tau[~still]))
    return np.maximum(tau, typical), np.full(tau.shape, ENOUGH_POOLED * typical)


def _standard_error(variance: np.ndarray, tau: np.ndarray, frames: np.ndarray) -> np.ndarray:
    """Return that of the mean: the sample variance misses the variance of the mean, sigma^2 = C(0)/(1 - 2 tau/F)."""
    with np.errstate(invalid="ignore"):
        spread = 2.0 * tau / frames
        return np.sqrt(variance * spread / np.maximum(1.0 - spread, 1.0 / np.maximum(frames, 1)))


def integrated_time(covariance: np.ndarray, window: float = WINDOW) -> np.ndarray:
    """tau in frames, 1/2 or more, from autocovariances C(t), (F, series), cut by Sokal's window: (series,)."""
    rho = covariance / covariance[0]
    tau = np.cumsum(rho, axis=0) - 0.5
    enough = np.arange(len(tau))[:, None] >= window * tau
    cut = np.where(enough.any(axis=0), np.argmax(enough, axis=0), len(tau) - 1)
    return np.maximum(np.take_along_axis(tau, cut[None], axis=0)[0], 0.5)


def _autocovariance(deviation: np.ndarray, known: np.ndarray) -> np.ndarray:
    """C(t) = mean of d(s) d(s + t) over the pairs of frames that both have a value, (F, series); by FFT."""
    products, pairs = (_correlate(values) for values in (deviation, known.astype(np.float64)))
    pairs = np.round(pairs)
    return np.divide(products, pairs, out=np.zeros_like(products), where=pairs > 0)


def _correlate(values: np.ndarray) -> np.ndarray:
    count = len(values)
    length = 1 << (2 * count - 1).bit_length()
    spectrum = np.fft.rfft(values, n=length, axis=0)
    return np.fft.irfft(np.abs(spectrum) ** 2, n=length, axis=0)[:count]


def _constant(flat: np.ndarray, known: np.ndarray) -> np.ndarray:
    low = np.where(known, flat, np.inf).min(axis=0, initial=np.inf)
    high = np.where(known, flat, -np.inf).max(axis=0, initial=-np.inf)
    return low >= high
