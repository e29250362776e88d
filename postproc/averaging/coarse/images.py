"""Periodic images: everything that reaches the points, from this period of the box and from others."""

from __future__ import annotations

import numpy as np

from postproc.averaging.words import WrongSetting
from postproc.geometry import box_bounds, box_lengths, periodic_axes
from postproc.snapshot import Snapshot

MOST_PERIODS = 5.0
"""A kernel that reaches farther than this many periods sees nothing but copies."""


def wrapped(x: np.ndarray, snapshot: Snapshot) -> np.ndarray:
    """Return places (n, dim) moved into the box along its periodic axes. MissingColumn when it is not known."""
    periodic = periodic_axes(snapshot)
    if not periodic.any():
        return x
    low, length = box_bounds(snapshot)[:, 0], box_lengths(snapshot)
    return np.where(periodic, low + np.mod(x - low, np.where(periodic, length, 1.0)), x)


def images(
    low: np.ndarray, high: np.ndarray, bounds: np.ndarray, snapshot: Snapshot
) -> tuple[np.ndarray, np.ndarray]:
    """Return rows (m,) and shifts (m, dim), m, of all periodic images that overlap `bounds` (dim, 2).

    low, high: (n, dim) extent of each thing, with the kernel's reach. Without periodic axes every thing comes once, as
    it is. When reach and bounds are short against a period these are the minimum images; a wider kernel counts a
    particle with several of its images, so that fields are those of the infinite, periodic system.
    """
    rows, shifts = np.arange(len(low)), np.zeros_like(low)
    for axis in np.flatnonzero(periodic_axes(snapshot)):
        length = box_lengths(snapshot)[axis]
        first = np.ceil((bounds[axis, 0] - high[rows, axis]) / length).astype(int)
        last = np.floor((bounds[axis, 1] - low[rows, axis]) / length).astype(int)
        count = np.maximum(last - first + 1, 0)
        pick = np.repeat(np.arange(len(rows)), count)
        step = np.arange(len(pick)) - np.repeat(np.cumsum(count) - count, count)
        rows, shifts = rows[pick], shifts[pick]
        shifts[:, axis] = (first[pick] + step) * length
    return rows, shifts


def check_reach(reach: float, snapshot: Snapshot) -> None:
    """Refuse a kernel that reaches over many periods. Raises WrongSetting."""
    periodic = periodic_axes(snapshot)
    if not periodic.any():
        return
    most = MOST_PERIODS * box_lengths(snapshot)[periodic].min()
    if reach > most:
        raise WrongSetting(
            f"width: expected a kernel that reaches no farther than {MOST_PERIODS:g} periods of the box, {most:g} m, "
            f"got one that reaches {reach:g} m; take a smaller width"
        )
