"""Friction without spring: a dashpot with a Coulomb limit.

M. Laetzel, S. Luding, H. J. Herrmann, Granular Matter 2, 123 (2000).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from reference.kernel.laws.contact import Pressing, Touching
from reference.kernel.laws.law import Memory, SlidingLaw
from reference.kernel.vectors import norm


@dataclass(frozen=True, kw_only=True)
class ViscousSliding(SlidingLaw):
    """f_t = -min(gamma_t |v_t|, mu f) v_t/|v_t|; at rest it carries nothing. No memory.

    limit: f is the "base" of `Pressing`, or the size of the "total" normal force, also where an adhesive
    contact pulls (LIGGGHTS' no_history).
    """

    choices: ClassVar[dict[str, str]] = {"limit": "viscous_limit"}

    shear_friction: float
    shear_damping: float
    limit: str

    def force(
        self, contact: Touching, pressing: Pressing, memory: Memory, dt: float, *, advance: bool
    ) -> tuple[np.ndarray, Memory]:
        """Return the force on i, (dim, M) in N."""
        del dt, advance
        base = pressing.base if self.limit == "base" else np.abs(pressing.total)
        limit, drag = self.shear_friction * base, self.shear_damping * norm(contact.v_t)
        cut = np.divide(limit, drag, out=np.ones_like(drag), where=drag > limit)
        return -self.shear_damping * cut * contact.v_t, memory

    def spring(self, contact: Touching) -> tuple[np.ndarray, np.ndarray]:
        """Return no stiffness, (M,) in N/m, and gamma_t, (M,) in kg/s: what acts below the limit."""
        return np.zeros_like(contact.overlap), np.full_like(contact.overlap, self.shear_damping)
