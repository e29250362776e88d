"""How two runs from identical data part, frame by frame and over the whole trajectory."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from postproc.trajectory import Trajectory

Lengths = Sequence[float] | None
"""Lengths of the periodic axes in m, 0 for open ones; None when no axis is periodic."""


@dataclass(frozen=True, kw_only=True)
class Growth:
    """rms |x_a - x_b| over the mean diameter, one entry a frame; times in s."""

    time: np.ndarray
    difference: np.ndarray


def difference_growth(a: Trajectory, b: Trajectory, periodic: Lengths = None) -> Growth:
    """Compare two trajectories of the same system, particle by particle, by their nearest images.

    Raises ValueError when their frames are not of the same steps: then there is nothing to compare.
    """
    _require_same_steps(a, b)
    apart = nearest_image(_places(a) - _places(b), periodic)
    diameter = 2.0 * float(a.frames[0].particles["radius"].mean())
    rms = np.sqrt((apart**2).sum(axis=2).mean(axis=1)) / diameter
    return Growth(time=np.array([f.time for f in a]), difference=rms)


@dataclass(frozen=True, kw_only=True)
class Compared:
    """A quantity of two runs over all frames and bodies, in its own unit; NaN if one of its values is.

    difference: largest between the runs. size: largest in either. change: largest since the start in either.
    """

    difference: float
    size: float
    change: float

    @property
    def relative(self) -> float | None:
        """The difference over the size; None if all is zero."""
        return None if self.size == 0.0 else self.difference / self.size


def compared_displacements(a: Trajectory, b: Trajectory, periodic: Lengths = None) -> Compared:
    """Compare what bodies moved since the start.

    Relative to a coordinate far from the origin any two paths would agree, hence displacements. An
    engine may fold particles back into a periodic box at another step: images are taken as nearest.
    Raises ValueError when the frames are not of the same steps.
    """
    _require_same_steps(a, b)
    left, right = _places(a), _places(b)
    moved = _largest(*(nearest_image(x - x[0], periodic) for x in (left, right)))
    return Compared(difference=_largest(nearest_image(left - right, periodic)), size=moved, change=moved)


def compared_columns(a: Trajectory, b: Trajectory, columns: Sequence[str]) -> Compared:
    """Compare columns of the particles, such as velocities.

    Columns that there are not, such as vz in 2D, are left out. Raises ValueError when the frames are
    not of the same steps.
    """
    _require_same_steps(a, b)
    present = [c for c in columns if c in a.frames[0].particles]
    left, right = (np.array([[f.particles[c] for c in present] for f in t]) for t in (a, b))
    return Compared(
        difference=_largest(left - right), size=_largest(left, right), change=_largest(left - left[0], right - right[0])
    )


def displacement_deviation(a: Trajectory, b: Trajectory, periodic: Lengths = None) -> float | None:
    """Return max |x_a - x_b| over the largest displacement; None if nothing moves, see `compared_displacements`."""
    return compared_displacements(a, b, periodic).relative


def column_deviation(a: Trajectory, b: Trajectory, columns: Sequence[str]) -> float | None:
    """Return max |a - b| / max(|a|, |b|); None if all is zero, see `compared_columns`."""
    return compared_columns(a, b, columns).relative


def nearest_image(apart: np.ndarray, periodic: Lengths) -> np.ndarray:
    """Return differences of places (..., dim) with whole periods taken out, within half a period of 0."""
    if periodic is None:
        return apart
    box = np.asarray(periodic, dtype=float)
    return apart - box * np.round(apart / np.where(box > 0, box, np.inf))


def _places(trajectory: Trajectory) -> np.ndarray:
    """Return the centres, (F, N, dim)."""
    return np.array([f.particles.vector(*f.axes) for f in trajectory])


def _require_same_steps(a: Trajectory, b: Trajectory) -> None:
    if a.steps != b.steps:
        raise ValueError(f"frames at different steps: {a.steps[:3]}... and {b.steps[:3]}...")


def _largest(*values: np.ndarray) -> float:
    """Return max |values|, NaN if there is one among them, 0 of nothing."""
    return float(np.max([np.abs(v).max(initial=0.0) for v in values]))
