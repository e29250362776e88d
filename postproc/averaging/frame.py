"""Frames that vectors and tensors are given in: Cartesian, or polar about a centre.

Polar (2D: r, phi; 3D: r, phi, z about the z axis through the centre): each particle's vectors are turned by
its own angle before averaging, so that a mean over a ring is one of radial and tangential parts.
Source: Laetzel, Luding, Herrmann, Granular Matter 2, 123 (2000), section 3. At points (coarse graining) the
average is turned by the point's angle instead. Angles count counter-clockwise from the x axis; at the centre
itself, where there is none, r points along x.
"""

from __future__ import annotations

import numpy as np

CARTESIAN, POLAR = "cartesian", "polar"
FRAMES = (CARTESIAN, POLAR)


def axes_of(frame: str, dimension: int) -> tuple[str, ...]:
    """Names of the components: ("x", "y"[, "z"]) or ("r", "phi"[, "z"])."""
    names = ("r", "phi", "z") if frame == POLAR else ("x", "y", "z")
    return names[:dimension]


def polar_turn(arms: np.ndarray) -> np.ndarray:
    """Matrices (rows, dim, dim) that take Cartesian components to polar ones at `arms` (rows, dim) from the centre.

    Rows of a matrix are the unit vectors e_r = (cos, sin), e_phi = (-sin, cos)[, e_z].
    """
    r = np.hypot(arms[:, 0], arms[:, 1])
    cos = np.divide(arms[:, 0], r, out=np.ones_like(r), where=r > 0)
    sin = np.divide(arms[:, 1], r, out=np.zeros_like(r), where=r > 0)
    turn = np.zeros((*arms.shape, arms.shape[1]))
    turn[:, 0, 0], turn[:, 0, 1] = cos, sin
    turn[:, 1, 0], turn[:, 1, 1] = -sin, cos
    if arms.shape[1] == 3:
        turn[:, 2, 2] = 1.0
    return turn


def turn_vectors(turn: np.ndarray, vectors: np.ndarray) -> np.ndarray:
    """Components of vectors (rows, dim) in frames `turn` (rows, dim, dim)."""
    return np.einsum("nab,nb->na", turn, vectors)


def turn_tensors(turn: np.ndarray, tensors: np.ndarray) -> np.ndarray:
    """Components of tensors of any rank, (rows, dim, ..., dim), in frames `turn` (rows, dim, dim)."""
    for axis in range(1, tensors.ndim):
        tensors = np.moveaxis(np.einsum("nab,nb...->na...", turn, np.moveaxis(tensors, axis, 1)), 1, axis)
    return tensors
