"""How much of a sphere lies in a cylinder about the z axis: the exact lens of every slice, summed by quadrature.

The closed form is in elliptic integrals (Lamarche and Leroy, Comput. Phys. Commun. 59, 359 (1990)); summing
slices is simpler and as exact: where a slice begins to leave the cylinder, the integrand goes with the power
3/2 of the distance, which the substitution z = z_1 sin(chi) (or its like between two such places) makes analytic.
Absolute error below 1e-12.
"""

from __future__ import annotations

import numpy as np

from postproc.averaging.fractions import disc_in_circle

NODES = 64
GRADES = 30
"""Halvings towards the middle of the sphere when a cylinder just about fits into it, for 1e-12 and less."""

CLOSE = 0.2
"""Square of the distance of the second singular place, in that of the first, below which the interval is graded."""


def sphere_in_cylinder(circle: np.ndarray, radius: np.ndarray, distance: np.ndarray) -> np.ndarray:
    """Fraction of spheres, their centres at this distance from the axis, inside a cylinder of radius `circle`.

    All in m, broadcast against each other.
    """
    R, a, c = np.broadcast_arrays(*(np.asarray(v, dtype=np.float64) for v in (circle, radius, distance)))
    R, c = R / a, c / a
    fraction = np.where(c + 1.0 <= R, 1.0, 0.0)
    cut = (R > 0) & (np.abs(R - c) < 1.0) & (c + 1.0 > R)
    fraction[cut] = _cut(R[cut], c[cut])
    return fraction


def _cut(R: np.ndarray, c: np.ndarray) -> np.ndarray:
    """Slices at |z| > outer lie inside or outside as a whole, at |z| < inner they hold the whole circle."""
    outer = np.sqrt((1.0 - (R - c)) * (1.0 + (R - c)))
    inner2 = (1.0 - (R + c)) * (1.0 + (R + c))  # negative: no slice holds the circle
    inner = np.sqrt(np.maximum(inner2, 0.0))
    caps = np.where(c < R, (1.0 - outer) ** 2 * (2.0 + outer) / 3.0, 0.0)
    volume = R**2 * inner + caps
    graded = (np.abs(inner2) < CLOSE * outer**2) & (c > 0)
    for choice, bounds in ((~graded, _whole), (graded, _graded)):
        if choice.any():
            low, high = bounds(inner[choice], outer[choice])
            volume[choice] += _slices(low, high, R[choice], c[choice])
    return 1.5 * volume  # of both halves, over the sphere: 2 pi volume / (4/3 pi)


def _whole(inner: np.ndarray, outer: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """From inner to outer in one; without an inner place from -outer, where the other singular place is."""
    return np.where(inner > 0, inner, -outer)[:, None], outer[:, None]


def _graded(inner: np.ndarray, outer: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """From inner to outer in intervals that halve towards inner."""
    parts = np.append(0.0, 0.5 ** np.arange(GRADES, -1.0, -1.0))
    places = inner[:, None] + (outer - inner)[:, None] * parts
    return places[:, :-1], places[:, 1:]


def _slices(low: np.ndarray, high: np.ndarray, R: np.ndarray, c: np.ndarray) -> np.ndarray:
    """Integral of the area of the slices in the cylinder over z, over pi; low, high: (rows, intervals)."""
    node, weight = np.polynomial.legendre.leggauss(NODES)
    chi = np.pi / 2.0 * node
    middle, half = (high + low)[..., None] / 2.0, (high - low)[..., None] / 2.0
    z = middle + half * np.sin(chi)
    radius2 = np.maximum((1.0 - z) * (1.0 + z), np.finfo(float).tiny)
    R, c = R[:, None, None], c[:, None, None]
    area = disc_in_circle(R, np.sqrt(radius2), c) * radius2
    total = (area * half * np.cos(chi) * weight).sum(axis=(1, 2)) * np.pi / 2.0
    symmetric = low[:, 0] < 0
    return np.where(symmetric, total / 2.0, total)
