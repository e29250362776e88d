"""Waves along an axis: means of layers, their modes, and the frequencies in a mode.

The layers n = 0 .. N-1 of a periodic column, a distance l apart, have the mean velocities (or spins) V_n(t). Mode m::

    a_m(t) = (1/N) sum_n V_n(t) exp(-2 pi i m n/N),      wavenumber k = 2 pi m/(N l)

A mode of a linear column is a sum of a few oscillations. Their frequencies are those for which least squares of
cosines and sines (times exp(-G t) where decay is asked for) leave the smallest residual; amplitudes are linear and are
solved for at every trial (variable projection: G. H. Golub, V. Pereyra, SIAM J. Numer. Anal. 10, 413 (1973)). The start
is the least-squares spectrum, which needs no whole number of periods (N. R. Lomb, Astrophys. Space Sci. 39, 447, 1976).
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from postproc.macro.fits.least_squares import Parameter, fit_line, points
from postproc.results import Unavailable
from postproc.trajectory import Trajectory

PER_LINE = 4
"""Trial frequencies of the spectrum in each 1/(2 T) of it, T the length of the signal."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Oscillation:
    """frequency: w (J,), rad/s, ascending; decay: G (J,), 1/s, zeros where none was asked for; errors likewise.

    One standard error each, from the covariance of the fit with the residual as noise. amplitude: (J,), root of the
    power at t = 0. residual: rms of what the fit leaves over the rms of the signal.
    """

    frequency: np.ndarray
    frequency_error: np.ndarray
    decay: np.ndarray
    decay_error: np.ndarray
    amplitude: np.ndarray
    residual: float


def layer_means(trajectory: Trajectory, column: str, layer: np.ndarray) -> np.ndarray:
    """Return the mean of a column of the particles over each layer in each frame, (F, layers).

    layer: (N,) number of each particle's layer, from 0, in the order of ids 1..N.
    """
    count = np.bincount(layer)
    means = []
    for frame in trajectory:
        of = layer[frame.particles["id"].astype(int) - 1]
        means.append(np.bincount(of, frame.particles[column], minlength=len(count)) / count)
    return np.array(means)


def modes(means: np.ndarray) -> np.ndarray:
    """Return a_m(t) of layers (F, N), complex (F, N//2 + 1)."""
    return np.fft.rfft(means, axis=-1) / means.shape[-1]


def oscillations(signals: np.ndarray, time: np.ndarray, count: int, *, decaying: bool = False) -> Oscillation:
    """Return the `count` oscillations that channels (C, F), complex or real, share; time (F,) is evenly spaced.

    decaying: each falls with exp(-G t) (grows where G < 0). Raises ValueError for fewer frames than unknowns.
    """
    from scipy.optimize import least_squares

    signals = np.atleast_2d(signals)
    data = np.concatenate([signals.real, signals.imag]) if np.iscomplexobj(signals) else signals
    if len(time) <= 2 * count * (2 if decaying else 1):
        raise ValueError(f"{len(time)} frames cannot tell {count} oscillations apart")
    scale, power = float(time[-1] - time[0]), float(np.sqrt((data**2).mean()))
    guess = _spectral_lines(data, time, count) * scale
    start = np.concatenate([guess, np.zeros(count)]) if decaying else guess
    found = least_squares(
        lambda p: _left(data, time, p / scale, count)[0].ravel() / power, start, method="lm", xtol=1e-15, ftol=1e-15,
        gtol=1e-15,
    )
    return _oscillation(found, data, time, scale, count)


def long_wave_speed(
    wavenumber: np.ndarray, frequency: np.ndarray, error: np.ndarray | None = None
) -> Parameter | Unavailable:
    """Return the speed of long waves (m/s): (w/k)^2 against k^2 by a straight line, extrapolated to k = 0.

    wavenumber: (K,), rad/m, > 0; frequency, error: (K,), rad/s. Without errors the scatter about the line tells them.
    """
    square = (frequency / wavenumber) ** 2
    spread = None if error is None else 2 * square * error / frequency
    line = fit_line(points(wavenumber**2, square, spread))
    if isinstance(line, Unavailable):
        return line
    offset = line.parameter(1)
    if not offset.value > 0:
        return Unavailable(reason="the long waves have no real speed")
    speed = float(np.sqrt(offset.value))
    return Parameter(value=speed, error=offset.error / (2 * speed))


def _spectral_lines(data: np.ndarray, time: np.ndarray, count: int) -> np.ndarray:
    """Return starting frequencies (count,): the highest line, then that of what it leaves."""
    trials = _trials(len(time), float(time[0]), float(time[1] - time[0]))
    found: list[float] = []
    left = data
    for _ in range(count):
        found.append(float(trials.frequency[np.argmax(trials.captured(left))]))
        left, _, _ = _left(data, time, np.array(found), len(found))
    return np.array(found)


@dataclass(frozen=True, kw_only=True, eq=False)
class _Trials:
    """Trial frequencies (trials,) up to half the sampling rate, rad/s; their cosines and sines (trials, F)."""

    frequency: np.ndarray
    cosine: np.ndarray
    sine: np.ndarray

    def captured(self, data: np.ndarray) -> np.ndarray:
        """Return the power (trials,) that a cosine and a sine of each trial frequency take of channels (C, F)."""
        cc, ss, cs = ((a * b).sum(1)[:, None] for a, b in (
            (self.cosine, self.cosine), (self.sine, self.sine), (self.cosine, self.sine)))
        c, s = self.cosine @ data.T, self.sine @ data.T
        return ((ss * c**2 - 2 * cs * c * s + cc * s**2) / (cc * ss - cs**2)).sum(1)


@lru_cache(maxsize=4)
def _trials(frames: int, start: float, step: float) -> _Trials:
    """Return the trials of signals of evenly spaced frames; those of one run are shared by all its modes."""
    count = PER_LINE * frames
    frequency = np.pi / step * (np.arange(count) + 0.5) / count
    phase = np.outer(frequency, start + step * np.arange(frames))
    return _Trials(frequency=frequency, cosine=np.cos(phase), sine=np.sin(phase))


def _left(data: np.ndarray, time: np.ndarray, parameters: np.ndarray, count: int):
    """Return what the best amplitudes leave of channels (C, F), those amplitudes (2 J, C), and the shapes (F, 2 J)."""
    frequency, decay = parameters[:count], parameters[count:]
    falling = np.exp(-np.outer(time, decay)) if len(decay) else 1.0
    shapes = np.hstack([falling * np.cos(np.outer(time, frequency)), falling * np.sin(np.outer(time, frequency))])
    amplitudes, *_ = np.linalg.lstsq(shapes, data.T, rcond=None)
    return data - (shapes @ amplitudes).T, amplitudes, shapes


def _oscillation(found, data: np.ndarray, time: np.ndarray, scale: float, count: int) -> Oscillation:
    left, amplitudes, _ = _left(data, time, found.x / scale, count)
    free = data.size - found.x.size - amplitudes.size
    noise = float((found.fun**2).sum()) / max(free, 1)
    error = np.sqrt(noise * np.diag(np.linalg.pinv(found.jac.T @ found.jac))) / scale
    order = np.argsort(np.abs(found.x[:count]))
    zeros, decaying = np.zeros(count), found.x.size > count
    return Oscillation(
        frequency=np.abs(found.x[:count])[order] / scale, frequency_error=error[:count][order],
        decay=(found.x[count:] / scale)[order] if decaying else zeros,
        decay_error=error[count:][order] if decaying else zeros,
        amplitude=np.sqrt((amplitudes.reshape(2, count, -1) ** 2).sum(axis=(0, 2)))[order],
        residual=float(np.sqrt((left**2).mean() / (data**2).mean())),
    )


