"""Lengths and volumes of a snapshot: the box, the particles, the nearest image."""

from __future__ import annotations

import numpy as np

from postproc.snapshot import Columns, MissingColumn, Snapshot

CONCENTRIC = 1e-9
"""Distance of the centres of ring walls, in the largest radius, up to which they count as one."""


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


def region(snapshot: Snapshot) -> np.ndarray:
    """Bounds of the rectangle around the sample, (dim, 2), m: the box, in 2D else the square around the ring walls."""
    if snapshot.box is not None or not ring_walls(snapshot).size or snapshot.dimension == 3:
        return box_bounds(snapshot).copy()
    outermost = ring_bounds(snapshot)[1]
    return centre(snapshot)[:, None] + outermost * np.array([-1.0, 1.0])


def box_lengths(snapshot: Snapshot) -> np.ndarray:
    """Edge lengths of the box, shape (dim,), m."""
    return np.diff(box_bounds(snapshot), axis=1)[:, 0]


def volume_between(bounds: np.ndarray, snapshot: Snapshot) -> float:
    """Volume of the region `bounds` (dim, 2), m^3; in 2D its area times the thickness."""
    volume = float(np.prod(np.diff(bounds, axis=1)))
    return volume * snapshot.thickness if snapshot.dimension == 2 else volume


def ring_walls(snapshot: Snapshot) -> np.ndarray:
    """Return rows of the walls that are rings, (W,): those with a radius."""
    if snapshot.walls is None or "radius" not in snapshot.walls:
        return np.empty(0, dtype=int)
    return np.flatnonzero(np.isfinite(snapshot.walls["radius"]))


def centre(snapshot: Snapshot) -> np.ndarray:
    """Centre of the ring walls, (dim,), m; without any the one given, else the origin. MissingColumn for several."""
    rings = ring_walls(snapshot)
    if not rings.size:
        return np.zeros(snapshot.dimension) if snapshot.centre is None else np.array(snapshot.centre)
    middles = vector(snapshot.walls, "p", snapshot)[rings]
    apart = np.abs(middles - middles[0])[:, :2].max()
    if apart > CONCENTRIC * snapshot.walls["radius"][rings].max():
        raise MissingColumn(f"the ring walls have centres up to {apart:g} m apart, so there is no one centre")
    return middles[0]


def ring_bounds(snapshot: Snapshot) -> np.ndarray:
    """Inner and outer radius of the sample between ring walls, (2,), m.

    With one ring wall from 0, as in a drum. MissingColumn without ring walls, or when one is left that the
    particles are not inside of.
    """
    rings = ring_walls(snapshot)
    if not rings.size:
        raise MissingColumn("the state has no ring walls (column radius)")
    radii = snapshot.walls["radius"][rings]
    if len(radii) > 1:
        return np.array([radii.min(), radii.max()])
    arms = (positions(snapshot) - centre(snapshot))[:, :2]
    if np.hypot(*arms.T).max(initial=0.0) > radii[0]:
        raise MissingColumn(f"there is one ring wall, of radius {radii[0]:g} m, and particles outside it")
    return np.array([0.0, radii[0]])


def sample_volume(snapshot: Snapshot) -> float:
    """Volume between the walls, m^3: the annulus between ring walls, else the box; in 2D times the thickness.

    The annulus is the bare one: discs glued on the rings are not taken out of it.
    """
    if not ring_walls(snapshot).size:
        return volume_between(box_bounds(snapshot), snapshot)
    return float(ring_volumes(ring_bounds(snapshot), snapshot)[0])


def ring_volumes(radii: np.ndarray, snapshot: Snapshot) -> np.ndarray:
    """Volumes between neighbouring radii (K+1,), (K,), m^3: pi (R_k+1^2 - R_k^2) times thickness or height."""
    height = snapshot.thickness if snapshot.dimension == 2 else box_lengths(snapshot)[2]
    return np.pi * np.diff(radii) * (radii[1:] + radii[:-1]) * height


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
