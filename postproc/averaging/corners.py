"""How much of a sphere lies in a corner of three planes at right angles: closed form.

The part of the unit ball with X > u, Y > v, Z > w, all three >= 0 and the corner inside, is bounded by three pieces
of planes and a triangle on the sphere. By Gauss and Bonnet the triangle has the area::

    Omega = 2 pi - sum over its 3 vertices (pi - alpha) - u phi_u - v phi_v - w phi_w

with alpha the angles at its vertices, tan alpha_uv = sqrt(1 - u^2 - v^2)/(u v), and phi_u the angle of the arc in the
plane X = u, whose geodesic curvature is u. The divergence theorem for the field x/3 gives the volume::

    V = (Omega - u A_u - v A_v - w A_w)/3,     A_u the area of the piece of plane X = u

Negative u, v, w are reflected: beyond u < 0 lies all that is beyond v and w, less the mirror image beyond -u.
Derived here; Strobl, Formella and Poeschel, J. Comput. Phys. 311, 158 (2016), for bodies with any planes.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from postproc.averaging.fractions import disc_below_corner, sphere_below_plane

SPHERE = 4.0 / 3.0 * np.pi


def sphere_below_corner(u: np.ndarray, v: np.ndarray, w: np.ndarray) -> np.ndarray:
    """Fraction of a sphere with X <= u, Y <= v and Z <= w, distances from its centre in radii; absolute 1e-15."""
    places = np.array(np.broadcast_arrays(u, v, w), dtype=np.float64)
    flat = -np.clip(places, -1.0, 1.0).reshape(3, -1)
    return _beyond(flat).reshape(places.shape[1:])


def _beyond(places: np.ndarray) -> np.ndarray:
    """Fraction beyond 1, 2 or 3 planes at the distances `places` (planes, n), -1 to 1."""
    if len(places) == 1:
        return sphere_below_plane(-places[0])
    places = places.copy()
    fraction, sign = np.zeros((2, places.shape[1]))
    sign += 1.0
    for axis in range(len(places)):
        negative = places[axis] < 0
        fraction[negative] += sign[negative] * _beyond(np.delete(places, axis, axis=0)[:, negative])
        sign[negative] *= -1.0
        places[axis] = np.abs(places[axis])
    inside = (places**2).sum(axis=0) < 1.0
    fraction[inside] += sign[inside] * _bounded(places[:, inside])
    return fraction


def _bounded(places: np.ndarray) -> np.ndarray:
    """The same for planes at distances >= 0 whose corner (edge) is inside the sphere."""
    area = np.full(places.shape[1], 2.0 * np.pi)
    pieces = 0.0
    for axis, u in enumerate(places):
        others = np.delete(places, axis, axis=0)
        radius = np.sqrt((1.0 - u) * (1.0 + u))
        v, w = others if len(others) == 2 else (others[0], -radius)
        half = np.arctan2(_root(radius, v), v)  # of the arc beyond v
        arc = half - np.arctan2(w, _root(radius, w)) if len(others) == 2 else 2.0 * half
        area -= u * arc
        pieces = pieces + u * radius**2 * np.pi * disc_below_corner(-v / radius, -w / radius)
    return (area - _turns(places) - pieces) / 3.0 / SPHERE


def _turns(places: np.ndarray) -> np.ndarray:
    """Sum of the outer angles: of three vertices, or of two alike on an edge."""
    pairs: Sequence[tuple[int, int]] = ((0, 1), (0, 2), (1, 2)) if len(places) == 3 else ((0, 1), (0, 1))
    inner = [
        np.arctan2(np.sqrt(np.maximum(1.0 - places[a] ** 2 - places[b] ** 2, 0.0)), places[a] * places[b])
        for a, b in pairs
    ]
    return len(pairs) * np.pi - np.sum(inner, axis=0)


def _root(radius: np.ndarray, v: np.ndarray) -> np.ndarray:
    return np.sqrt(np.maximum((radius - v) * (radius + v), 0.0))
