"""Mobilised strength of a state of stress."""

from __future__ import annotations

import numpy as np

from postproc.averaging.cells import divide


def stress_ratio(principal_values: np.ndarray) -> np.ndarray:
    """sigma_1/sigma_3 from principal values (K, dim), largest first; NaN unless sigma_3 > 0, (K,)."""
    s1, s3 = principal_values[:, 0], principal_values[:, -1]
    return divide(s1, np.where(s3 > 0, s3, 0.0))


def friction_angle(principal_values: np.ndarray) -> np.ndarray:
    """Secant friction angle in degrees, (K,): sin(phi) = (sigma_1 - sigma_3)/(sigma_1 + sigma_3).

    Mohr-Coulomb without cohesion (the line from the origin that touches Mohr's circle), so it mixes
    cohesion in where there is some. NaN where sigma_3 < 0 (the circle crosses the origin) or
    both stresses are 0.
    """
    s1, s3 = principal_values[:, 0], principal_values[:, -1]
    sine = divide(s1 - s3, np.where(s3 >= 0, s1 + s3, 0.0))
    return np.degrees(np.arcsin(sine))
