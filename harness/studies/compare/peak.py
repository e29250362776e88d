"""The peak of a stress curve: the top of the first loading branch, where one packing still decides.

After the first drop a box moves in bursts, and runs that differ by round-off have bursts of their own; the
largest stress of the whole test lies in any of them (measured on runs that part by round-off alone: at 0.9 %
strain in one, at 5.4 % in another). What can be repeated is the first branch: the smoothed stress rises to a
maximum from which it then falls clearly, and the peak is that maximum, whatever comes later.

Clearly: by `DROP` of the maximum and by `SCATTERS` times the rms of the curve about its smoothed self so far.
Measured with friction, where runs followed each other within 1 % when the drop was complete: first drops of 8 to
11 %, scatter 1.4 to 2.1 %. Without friction, where the stress creeps up to a plateau, the scatter is 4 % and no dip
is so deep: such a test has no peak.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

DROP = 0.05
"""Of the largest stress so far: half of what was measured after the peak of the shipped boxes with friction."""

SCATTERS = 3.0
"""A dip below three times the scatter may be one of the fluctuations that smoothing leaves."""

TOP = 0.03
"""The top of a curve is where it is within 3 % of its peak: between once and twice its scatter, so that anywhere
there another packing might peak."""


@dataclass(frozen=True, kw_only=True)
class Peak:
    """Sample of the peak, its axial strain, and the first and last strain of the curve's top: its uncertainty."""

    sample: int
    strain: float
    low: float
    high: float

    @property
    def where(self) -> str:
        """Say the strain and its uncertainty.

        >>> Peak(sample=7, strain=0.009, low=0.0072, high=0.0152).where
        '0.9 % strain (top from 0.72 to 1.52 %)'
        """
        return f"{100 * self.strain:.3g} % strain (top from {100 * self.low:.3g} to {100 * self.high:.3g} %)"


def first_peak(strain: np.ndarray, stress: np.ndarray, smooth: np.ndarray, *, settled: float) -> Peak | None:
    """Return the peak of the first loading branch, None of a curve that never falls clearly.

    strain, stress, smooth: (S,), `smooth` being `stress` smoothed. settled: strain from which on the scatter
    counts; before, the smoothed curve is lower than a steep one.
    """
    highest = np.maximum.accumulate(smooth)
    fallen = np.flatnonzero(highest - smooth > _clear(strain > settled, stress - smooth, highest))
    if not fallen.size:
        return None
    branch = smooth[: fallen[0]]
    k, top = int(np.argmax(branch)), np.flatnonzero(branch.max() - branch <= TOP * abs(branch.max()))
    return Peak(sample=k, strain=float(strain[k]), low=float(strain[top[0]]), high=float(strain[top[-1]]))


def _clear(counts: np.ndarray, apart: np.ndarray, highest: np.ndarray) -> np.ndarray:
    """Return the fall that is clear, sample by sample, from what was seen until then."""
    squares, number = np.cumsum(np.where(counts, apart**2, 0.0)), np.cumsum(counts)
    scatter = np.sqrt(squares / np.maximum(number, 1))
    return np.maximum(DROP * np.abs(highest), SCATTERS * scatter)
