"""What a contact law sees: the touching contacts of one moment."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True, kw_only=True)
class Touching:
    """M contacts with overlap > 0; what no law of theirs needs is None.

    i, j: (M,) node numbers (walls follow the particles). n: (dim, M) unit normal from j to i.
    overlap: (M,) m. v_n: (M,) rate of separation (v_i - v_j).n, m/s.
    v_t: (dim, M) slip velocity of i relative to j at the contact, m/s. mean_v_t: its mean over the step, by which
    springs are stretched, in schemes that know it; else v_t does. torque_arm_i, torque_arm_j:
    (M,) lever arms of the tangential force, m. spin: (1|3, M) omega_i - omega_j, rad/s.
    reduced_radius: (M,) a* = a_i a_j/(a_i + a_j), a_i at a wall, m. reduced_mass: likewise m*, kg.
    """

    i: np.ndarray
    j: np.ndarray
    n: np.ndarray
    overlap: np.ndarray
    v_n: np.ndarray
    v_t: np.ndarray | None = None
    mean_v_t: np.ndarray | None = None
    torque_arm_i: np.ndarray | None = None
    torque_arm_j: np.ndarray | None = None
    spin: np.ndarray | None = None
    reduced_radius: np.ndarray | None = None
    reduced_mass: np.ndarray | None = None


@dataclass(frozen=True, kw_only=True)
class Pressing:
    """The normal force of M contacts as friction, rolling and torsion see it, (M,) each, in N.

    total: f_n, positive in compression. elastic: f_n without its dashpot. base: what the coefficients of
    friction are multiplied by, never negative: f_n counted from where an adhesive contact pulls most.
    """

    total: np.ndarray
    elastic: np.ndarray
    base: np.ndarray
