"""Plastic loading and adhesion with an unloading stiffness that grows with the largest overlap.

S. Luding, Granular Matter 10, 235 (2008), eqs. 6-8.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from reference.kernel.laws.contact import Touching
from reference.kernel.laws.hysteretic import PlasticNormal, with_adhesion
from reference.kernel.laws.law import Memory


@dataclass(frozen=True, kw_only=True)
class VariableHystereticNormal(PlasticNormal):
    """As `HystereticNormal` with k_2 = k_1 + (k_p - k_1) delta_max/delta*, and k_p from delta_max = delta* on.

    delta* = k_p/(k_p - k_1) phi_f 2 a*. Beyond delta* the contact loads and unloads along
    k_p (delta - delta*) + k_1 delta*. On the adhesive branch k_2 is that of the overlap remembered from before.
    """

    largest_unloading_stiffness: float
    plasticity_depth: float

    @property
    def needs(self) -> frozenset[str]:
        """a*."""
        return frozenset({"reduced_radius"})

    def elastic(self, contact: Touching, memory: Memory) -> tuple[np.ndarray, Memory]:
        """Return f_el, (M,) in N, and the largest overlaps."""
        k_1, k_p = self.loading_stiffness, self.largest_unloading_stiffness
        largest = np.maximum(memory[0], contact.overlap)
        limit = k_p / (k_p - k_1) * self.plasticity_depth * 2.0 * contact.reduced_radius
        turning_point = np.minimum(largest, limit)
        k_2 = k_1 + (k_p - k_1) * (turning_point / limit)
        force = k_2 * (contact.overlap - turning_point) + k_1 * turning_point
        return with_adhesion(force, contact.overlap, largest, k_1, k_2, self.adhesion_stiffness)
