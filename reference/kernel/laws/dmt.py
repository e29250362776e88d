"""Elastic spheres that attract each other around the contact (Derjaguin, Muller & Toporov 1975).

B. V. Derjaguin, V. M. Muller, Y. P. Toporov, J. Colloid Interface Sci. 53, 314 (1975).
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from reference.kernel.laws.contact import Touching
from reference.kernel.laws.law import Memory, NormalLaw
from reference.kernel.laws.spheres import effective_modulus


@dataclass(frozen=True, kw_only=True)
class DmtNormal(NormalLaw):
    """f_n = 4/3 E* sqrt(a* delta) delta - f_a - gamma_n v_n with the constant pull f_a = 4 pi w a*; w: surface energy.

    The pull begins and ends with the overlap.
    """

    first_order: ClassVar[str] = "the pull jumps where a contact begins and ends, which no impulse corrects"

    youngs_modulus: float
    poisson_ratio: float
    surface_energy: float
    normal_damping: float

    @property
    def needs(self) -> frozenset[str]:
        """a*."""
        return frozenset({"reduced_radius"})

    def elastic(self, contact: Touching, memory: Memory) -> tuple[np.ndarray, Memory]:
        """Return f_n without its dashpot, (M,) in N."""
        hertz = self._hertz_stiffness(contact) * contact.overlap
        return hertz - self.adhesion(contact), memory

    def damping(self, contact: Touching) -> float | None:
        """Return gamma_n, kg/s."""
        del contact
        return self.normal_damping or None

    def adhesion(self, contact: Touching) -> np.ndarray:
        """Return f_a = 4 pi w a*, (M,) in N."""
        return 4.0 * math.pi * self.surface_energy * contact.reduced_radius

    def gripping(self, contact: Touching, total: np.ndarray, elastic: np.ndarray) -> np.ndarray:
        """Return f_el + 2 f_a, without dashpot, (M,) in N (C. Thornton, J. Phys. D 24, 1942 (1991))."""
        del total
        return elastic + 2.0 * self.adhesion(contact)

    def energy(self, contact: Touching) -> np.ndarray:
        """Return the stored energy 8/15 E* sqrt(a* delta) delta^2 - f_a delta, (M,), in J."""
        hertz = 0.4 * self._hertz_stiffness(contact) * contact.overlap**2
        return hertz - self.adhesion(contact) * contact.overlap

    def _hertz_stiffness(self, contact: Touching) -> np.ndarray:
        modulus = effective_modulus(self.youngs_modulus, self.poisson_ratio)
        return 4.0 / 3.0 * modulus * np.sqrt(contact.reduced_radius * contact.overlap)
