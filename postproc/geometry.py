"""Lengths and volumes of a snapshot: the box, the particles, the nearest image."""

from __future__ import annotations

import numpy as np

from postproc.snapshot import Columns, MissingColumn, Snapshot


def positions(snapshot: Snapshot) -> np.ndarray:
    """Particle centres x^p, shape (N, dim), m."""
    return snapshot.particles.vector(*snapshot.axes)


def vector(table: Columns, letter: str, snapshot: Snapshot) -> np.ndarray:
    """Columns <letter>x, <letter>y[, <letter>z] of a group as one array (rows, dim)."""
    return table.vector(*(letter + a for a in snapshot.axes))


def particle_volumes(snapshot: Snapshot) -> np.ndarray:
    """V^p, shape (N,), m^3: spheres 4/3 pi a^3; in 2D discs, pi a^2 times the thickness."""
    a = snapshot.particles["radius"]
    if snapshot.dimension == 2:
        return np.pi * a**2 * snapshot.thickness
    return 4.0 / 3.0 * np.pi * a**3


def box_bounds(snapshot: Snapshot) -> np.ndarray:
    """Lower and upper bound of each axis, shape (dim, 2), m. MissingColumn without a box."""
    if snapshot.box is None:
        raise MissingColumn("the state has no box: give the attribute box, or walls on every side")
    return np.asarray(snapshot.box, dtype=np.float64)


def box_lengths(snapshot: Snapshot) -> np.ndarray:
    """Edge lengths of the box, shape (dim,), m."""
    return np.diff(box_bounds(snapshot), axis=1)[:, 0]


def volume_between(bounds: np.ndarray, snapshot: Snapshot) -> float:
    """Volume of the region `bounds` (dim, 2), m^3; in 2D its area times the thickness."""
    volume = float(np.prod(np.diff(bounds, axis=1)))
    return volume * snapshot.thickness if snapshot.dimension == 2 else volume


def periodic_axes(snapshot: Snapshot) -> np.ndarray:
    """Which axes are periodic, bool (dim,)."""
    return np.array(snapshot.periodic or (False,) * snapshot.dimension, dtype=bool)


def nearest_image(vectors: np.ndarray, snapshot: Snapshot) -> np.ndarray:
    """Shift difference vectors (rows, dim) by whole periods to their shortest form.

    Right as long as a true difference is shorter than half a period, which holds for the vector
    from a particle to its contact point when the box is wider than two particles.
    MissingColumn when an axis is periodic but the box is not known.
    """
    periodic = periodic_axes(snapshot)
    if not periodic.any():
        return vectors
    length = np.where(periodic, box_lengths(snapshot), np.inf)
    shift = np.where(periodic, np.round(vectors / length), 0.0)
    return vectors - shift * np.where(periodic, length, 0.0)
