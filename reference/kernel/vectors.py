"""Products of component-major vectors, (dim, M), for 2D and 3D alike.

Only elementwise multiplication, addition and square roots: these are exact to the last bit by IEEE
754 on every machine, while `einsum`, `@` and `abs` of complex numbers change bits with the CPU's
vector units.

In 2D a spin is a scalar about z (counter-clockwise positive) and is stored with shape (1, M).
"""

from __future__ import annotations

import numpy as np


def dot(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """Return a.b of each column, shape (M,).

    >>> dot(np.array([[1.0], [2.0]]), np.array([[3.0], [4.0]]))
    array([11.])
    """
    product = a[0] * b[0]
    for p, q in zip(a[1:], b[1:], strict=True):
        product += p * q
    return product


def norm(a: np.ndarray) -> np.ndarray:
    """Return |a| of each column, shape (M,)."""
    return np.sqrt(dot(a, a))


def spin_cross(spin: np.ndarray, a: np.ndarray) -> np.ndarray:
    """Return omega x a, shape (dim, M)."""
    if len(a) == 2:
        return np.stack([-spin[0] * a[1], spin[0] * a[0]])
    return _cross3(spin, a)


def torque_cross(a: np.ndarray, f: np.ndarray) -> np.ndarray:
    """Return a x f as a spin-like quantity: (1, M) in 2D, (3, M) in 3D."""
    if len(a) == 2:
        return (a[0] * f[1] - a[1] * f[0])[None]
    return _cross3(a, f)


def across(spin: np.ndarray, n: np.ndarray) -> np.ndarray:
    """Return omega - n (n.omega), the part at right angles to n; all of it in 2D. Shape (1|3, M)."""
    return spin if len(n) == 2 else spin - dot(n, spin) * n


def spin_components(dimension: int) -> int:
    """Return 1 in 2D, 3 in 3D."""
    return 1 if dimension == 2 else 3


def _cross3(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    return np.stack([a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]])
