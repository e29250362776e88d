"""Plastic loading and adhesion in straight lines, with one unloading stiffness.

The law of the talks; without adhesion that of Walton & Braun, J. Rheol. 30, 949 (1986).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from reference.kernel.laws.contact import Touching
from reference.kernel.laws.law import Memory, NormalLaw


@dataclass(frozen=True, kw_only=True)
class PlasticNormal(NormalLaw):
    """What the laws with plastic loading share: f_n = f_el - gamma_n v_n, memory delta_max, (1, M) in m."""

    onset: ClassVar[tuple[float, float] | None] = (1.0, 0.0)
    first_order: ClassVar[str] = "with friction: branches meet in kinks within a step, which are not looked for"

    loading_stiffness: float
    adhesion_stiffness: float
    normal_damping: float

    def memory_rows(self, dimension: int) -> int:
        """One: the largest overlap."""
        del dimension
        return 1

    def damping(self, contact: Touching) -> float | None:
        """Return gamma_n, kg/s."""
        del contact
        return self.normal_damping or None

    def adhesion(self, contact: Touching) -> np.ndarray | None:
        """Return k_c delta, (M,) in N."""
        return self.adhesion_stiffness * contact.overlap if self.adhesion_stiffness else None

    def loading(self, contact: Touching) -> np.ndarray:
        """Return k_1 delta, (M,) in N."""
        return self.loading_stiffness * contact.overlap


@dataclass(frozen=True, kw_only=True)
class HystereticNormal(PlasticNormal):
    """f_el = k_1 delta on first loading, k_2 (delta - delta_0) below the largest overlap, never below -k_c delta.

    delta_0 = (1 - k_1/k_2) delta_max. On the branch -k_c delta the largest overlap is drawn back, to
    delta_max = (k_2 + k_c)/(k_2 - k_1) delta, so that it loads again along k_2.
    """

    unloading_stiffness: float

    def elastic(self, contact: Touching, memory: Memory) -> tuple[np.ndarray, Memory]:
        """Return f_el, (M,) in N, and the largest overlaps."""
        largest = np.maximum(memory[0], contact.overlap)
        k_2 = self.unloading_stiffness
        force = k_2 * (contact.overlap - largest) + self.loading_stiffness * largest
        return with_adhesion(force, contact.overlap, largest, self.loading_stiffness, k_2, self.adhesion_stiffness)


def with_adhesion(force, overlap, largest, k_1, k_2, k_c) -> tuple[np.ndarray, np.ndarray]:
    """Return max(force, -k_c delta), (M,), and the largest overlaps, (1, M), drawn back where that is the branch."""
    pull = -k_c * overlap
    adhesive = (force <= pull) & (k_2 > k_1)
    drawn_back = np.divide((k_2 + k_c) * overlap, k_2 - k_1, out=largest.copy(), where=adhesive)
    return np.where(adhesive, pull, force), drawn_back[None]
