"""The antisymmetric part of a tensor and the cross product, as one number in 2D and a vector in 3D.

Everything that turns (spin, rotation, couple, antisymmetric stress) is axial: in 2D its component out of the
plane, counter-clockwise positive, without a frame; in 3D three components.
"""

from __future__ import annotations

import numpy as np


def axial(tensor: np.ndarray) -> np.ndarray:
    """a_c = e_cab T_ab/2: (K, 2, 2) -> (K,), (T_12 - T_21)/2; (K, 3, 3) -> (K, 3). Unit of T."""
    odd = (tensor - tensor.swapaxes(-1, -2)) / 2.0
    if tensor.shape[-1] == 2:
        return odd[..., 0, 1]
    return np.stack([odd[..., 1, 2], odd[..., 2, 0], odd[..., 0, 1]], axis=-1)


def cross(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """a x b of rows (E, dim): in 2D (E,), a_1 b_2 - a_2 b_1; in 3D (E, 3)."""
    if a.shape[-1] == 2:
        return a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0]
    return np.cross(a, b)


def dyads(axials: np.ndarray, vectors: np.ndarray) -> np.ndarray:
    """Axial quantities (E,) or (E, 3) times vectors (E, dim): a_A l_b, (E, 2) or (E, 3, 3)."""
    return axials[..., None] * (vectors if axials.ndim == 1 else vectors[:, None, :])
