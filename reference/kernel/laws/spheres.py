"""Elastic constants of two touching spheres of one material, and the damping that goes with a restitution."""

from __future__ import annotations

import math

import numpy as np


def effective_modulus(youngs_modulus: float, poisson_ratio: float) -> float:
    """Return E* = E/(2 (1 - nu^2)), Pa (Hertz 1882); a wall is of the same material as the particles."""
    return youngs_modulus / (2.0 * (1.0 - poisson_ratio**2))


def effective_shear_modulus(youngs_modulus: float, poisson_ratio: float) -> float:
    """Return G* = E/(4 (2 - nu)(1 + nu)), Pa (Mindlin, J. Appl. Mech. 16, 259 (1949))."""
    return youngs_modulus / (4.0 * (2.0 - poisson_ratio) * (1.0 + poisson_ratio))


def damping(restitution: float, stiffness: np.ndarray, mass: np.ndarray) -> np.ndarray:
    """Return sqrt(10/3) beta sqrt(S m), kg/s, beta = -ln e/sqrt(ln^2 e + pi^2), for tangent stiffnesses S, N/m.

    On the normal stiffness of Hertz it gives the restitution e at any speed (Antypov & Elliott, EPL 94,
    50004 (2011); Tsuji, Tanaka & Ishida, Powder Technol. 71, 239 (1992)).
    """
    beta = -math.log(restitution) / math.hypot(math.log(restitution), math.pi)
    return math.sqrt(10.0 / 3.0) * beta * np.sqrt(stiffness * mass)
