"""Invariants and directions of symmetric tensors."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

ISOTROPIC = 1e-10
"""Principal values closer than this part of the largest have no direction of their own."""


@dataclass(frozen=True, kw_only=True)
class Principal:
    """Parts of K tensors, each of the symmetric part (T + T^t)/2.

    isotropic: (K,) tr T / dim.
    deviator: (K,) sqrt(T':T'/2), T' the deviatoric part: in 2D (T_1 - T_2)/2, the radius of Mohr's
        circle; in 3D sqrt(J_2).
    values: (K, dim) principal values, largest first.
    major: (K, dim) unit vector along the largest; its last component that is not 0 is positive.
        NaN where the largest value is not single (an isotropic tensor has no direction).
    """

    isotropic: np.ndarray
    deviator: np.ndarray
    values: np.ndarray
    major: np.ndarray


def principal(tensor: np.ndarray) -> Principal:
    """Decompose tensors of shape (K, dim, dim). Rows with NaN give NaN."""
    dim = tensor.shape[-1]
    symmetric = (tensor + tensor.swapaxes(-1, -2)) / 2.0
    known = np.isfinite(symmetric).all(axis=(-1, -2))
    values = np.full(symmetric.shape[:-1], np.nan)
    vectors = np.full(symmetric.shape, np.nan)
    values[known], vectors[known] = np.linalg.eigh(symmetric[known])
    isotropic = np.trace(symmetric, axis1=-2, axis2=-1) / dim
    deviatoric = symmetric - isotropic[:, None, None] * np.eye(dim)
    return Principal(
        isotropic=isotropic,
        deviator=np.sqrt((deviatoric**2).sum(axis=(-1, -2)) / 2.0),
        values=values[:, ::-1],
        major=_direction(values, vectors[..., -1]),
    )


def _direction(ascending: np.ndarray, vector: np.ndarray) -> np.ndarray:
    """Fix the sign of `vector`; NaN where the two largest of the `ascending` values coincide."""
    scale = np.abs(ascending).max(axis=-1)
    single = ascending[..., -1] - ascending[..., -2] > ISOTROPIC * scale
    clean = np.where(np.abs(vector) > ISOTROPIC, vector, 0.0)
    from_last = np.sign(clean[:, ::-1])
    sign = np.take_along_axis(from_last, np.argmax(from_last != 0.0, axis=1)[:, None], axis=1)
    return np.where(single[:, None], clean * sign, np.nan)
