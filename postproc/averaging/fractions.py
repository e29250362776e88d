"""How much of a disc or sphere lies on one side of a line, a plane, a corner, or in a circle: closed forms.

All are fractions of the whole, 0 to 1, exact to round-off (absolute 1e-15; thin slivers keep their relative
digits too, since no formula takes the difference of nearly equal areas). Lengths are in units of the disc's
own radius where it says t, u, v. Differences of two of them at the two borders of a cell telescope: over cells
that cover a particle they add up to 1. Plane geometry (segments of circles), derived here.
"""

from __future__ import annotations

import numpy as np

SMALL_ANGLE = 0.5
"""Below it x - sin x is summed as a series: the difference would lose its digits."""


def disc_below_line(t: np.ndarray) -> np.ndarray:
    """Fraction of a disc with X <= t, t the signed distance of the line from the centre in radii."""
    t = np.clip(t, -1.0, 1.0)
    half_angle = np.arctan2(np.sqrt((1.0 - t) * (1.0 + t)), -t)
    return _segment(half_angle) / np.pi


def sphere_below_plane(t: np.ndarray) -> np.ndarray:
    """Fraction of a sphere with X <= t: its cap, (1 + t)^2 (2 - t)/4."""
    t = np.clip(t, -1.0, 1.0)
    return (1.0 + t) ** 2 * (2.0 - t) / 4.0


def disc_below_corner(u: np.ndarray, v: np.ndarray) -> np.ndarray:
    """Fraction of a disc with X <= u and Y <= v.

    With the corner inside the disc: (u v + (u sqrt(1-u^2) + v sqrt(1-v^2) + asin u + asin v)/2 + pi/4)/pi.
    Outside, the lines cut off segments that do not meet, or all of the disc.
    """
    u, v = np.clip(u, -1.0, 1.0), np.clip(v, -1.0, 1.0)
    below_u, below_v = disc_below_line(u), disc_below_line(v)
    inside = u * u + v * v < 1.0
    area = u * v + (_half_segment(u) + _half_segment(v)) / 2.0 + np.pi / 4.0
    upper_right = below_u + below_v - 1.0
    outside = np.select([(u >= 0) & (v >= 0), u >= 0, v >= 0], [upper_right, below_v, below_u], 0.0)
    return np.where(inside, area / np.pi, outside)


def disc_in_circle(circle: np.ndarray, radius: np.ndarray, distance: np.ndarray) -> np.ndarray:
    """Fraction of discs of this radius, their centres at this distance from the centre of a circle, inside it.

    The lens: a segment of the disc and one of the circle, half angles from the common chord. All in m, broadcast
    against each other; a circle of radius 0 holds nothing, one inside the disc (R/a)^2.
    """
    R, a, c = np.broadcast_arrays(*(np.asarray(v, dtype=np.float64) for v in (circle, radius, distance)))
    fraction = np.where(c + a <= R, 1.0, np.where(c + R <= a, (R / a) ** 2, 0.0))
    cut = (np.abs(R - a) < c) & (c < R + a) & (R > 0)
    fraction[cut] = _lens(R[cut], a[cut], c[cut])
    return fraction


def _lens(R: np.ndarray, a: np.ndarray, c: np.ndarray) -> np.ndarray:
    chord = np.sqrt((c + (a + R)) * ((a + R) - c) * (c - (a - R)) * (c + (a - R)))
    at_disc = np.arctan2(chord, (c - R) * (c + R) + a * a)
    at_circle = np.arctan2(chord, (c - a) * (c + a) + R * R)
    return (_segment(at_disc) + (R / a) ** 2 * _segment(at_circle)) / np.pi


def _segment(half_angle: np.ndarray) -> np.ndarray:
    """Area of a segment of the unit circle, (x - sin x)/2 with x twice the half angle."""
    x = 2.0 * np.asarray(half_angle, dtype=np.float64)
    y = np.minimum(x, SMALL_ANGLE) ** 2
    series = x * y / 6 * (1 - y / 20 * (1 - y / 42 * (1 - y / 72 * (1 - y / 110 * (1 - y / 156)))))
    small = x < SMALL_ANGLE
    return (series if small.all() else np.where(small, series, x - np.sin(x))) / 2.0


def _half_segment(u: np.ndarray) -> np.ndarray:
    return u * np.sqrt((1.0 - u) * (1.0 + u)) + np.arcsin(u)
