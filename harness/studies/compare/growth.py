"""How two runs from identical data part: rms difference of positions, frame by frame."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from postproc.trajectory import Trajectory


@dataclass(frozen=True, kw_only=True)
class Growth:
    """rms |x_a - x_b| over the mean diameter, one entry a frame; times in s."""

    time: np.ndarray
    difference: np.ndarray

    def parted(self, level: float) -> float | None:
        """Return the first time at which the difference exceeds `level`, None if it never does."""
        beyond = np.flatnonzero(~(self.difference <= level))
        return float(self.time[beyond[0]]) if beyond.size else None


def difference_growth(a: Trajectory, b: Trajectory) -> Growth:
    """Compare two trajectories of the same system, particle by particle.

    Raises ValueError when their frames are not of the same steps: then there is nothing to compare.
    """
    if a.steps != b.steps:
        raise ValueError(f"frames at different steps: {a.steps[:3]}... and {b.steps[:3]}...")
    axes = a.frames[0].axes
    diameter = 2.0 * float(a.frames[0].particles["radius"].mean())
    rms = [_rms(p.particles, q.particles, axes) / diameter for p, q in zip(a, b, strict=True)]
    return Growth(time=np.array([f.time for f in a]), difference=np.array(rms))


def _rms(p, q, axes) -> float:
    return float(np.sqrt(sum(np.mean((p[c] - q[c]) ** 2) for c in axes)))
