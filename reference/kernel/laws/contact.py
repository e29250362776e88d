"""What a contact law sees: the touching contacts of one moment."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True, kw_only=True)
class Touching:
    """M contacts with overlap > 0.

    i, j: (M,) node numbers (walls follow the particles). n: (dim, M) unit normal from j to i.
    overlap: (M,) m. v_n: (M,) rate of separation (v_i - v_j).n, m/s.
    v_t: (dim, M) slip velocity of i relative to j at the contact, m/s; None without tangential law.
    torque_arm_i, torque_arm_j: (M,) lever arms, m; None without tangential law.
    """

    i: np.ndarray
    j: np.ndarray
    n: np.ndarray
    overlap: np.ndarray
    v_n: np.ndarray
    v_t: np.ndarray | None = None
    torque_arm_i: np.ndarray | None = None
    torque_arm_j: np.ndarray | None = None
