"""Elastic spheres (H. Hertz, J. reine angew. Math. 92, 156 (1882)) with constant restitution."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from reference.kernel.laws.contact import Touching
from reference.kernel.laws.law import Memory, NormalLaw
from reference.kernel.laws.spheres import damping, effective_modulus, effective_shear_modulus


@dataclass(frozen=True, kw_only=True)
class HertzNormal(NormalLaw):
    """f_n = 4/3 E* sqrt(a* delta) delta - gamma v_n, gamma = sqrt(10/3) beta sqrt(S_n m*), S_n = 2 E* sqrt(a* delta).

    E* and beta: `spheres`. `attraction` "allowed" or "clipped" as in `NormalLaw`; the restitution is `restitution` at
    every speed if it is allowed.
    """

    onset: ClassVar[tuple[float, float] | None] = (1.5, 0.25)

    youngs_modulus: float
    poisson_ratio: float
    restitution: float
    attraction: str

    @property
    def needs(self) -> frozenset[str]:
        """a*, and m* if there is a dashpot."""
        return frozenset({"reduced_radius", "reduced_mass"} if self.restitution < 1.0 else {"reduced_radius"})

    def elastic(self, contact: Touching, memory: Memory) -> tuple[np.ndarray, Memory]:
        """Return 4/3 E* sqrt(a* delta) delta = 2/3 S_n delta, (M,) in N."""
        return 2.0 / 3.0 * self.normal_stiffness(contact) * contact.overlap, memory

    def damping(self, contact: Touching) -> np.ndarray | None:
        """Return gamma, (M,) in kg/s."""
        if self.restitution == 1.0:
            return None
        return damping(self.restitution, self.normal_stiffness(contact), contact.reduced_mass)

    def normal_stiffness(self, contact: Touching) -> np.ndarray:
        """Return S_n = 2 E* sqrt(a* delta), the slope of the elastic force, (M,) in N/m."""
        modulus = effective_modulus(self.youngs_modulus, self.poisson_ratio)
        return 2.0 * modulus * np.sqrt(contact.reduced_radius * contact.overlap)

    def shear_stiffness(self, contact: Touching) -> np.ndarray:
        """Return Mindlin's 8 G* sqrt(a* delta) of a contact that does not slip, (M,) in N/m."""
        modulus = effective_shear_modulus(self.youngs_modulus, self.poisson_ratio)
        return 8.0 * modulus * np.sqrt(contact.reduced_radius * contact.overlap)

    def shear_damping(self, contact: Touching) -> float | np.ndarray:
        """Return sqrt(10/3) beta sqrt(S_t m*), kg/s, (M,), or 0 without dashpot."""
        if self.restitution == 1.0:
            return 0.0
        return damping(self.restitution, self.shear_stiffness(contact), contact.reduced_mass)

    def energy(self, contact: Touching) -> np.ndarray:
        """Return the stored energy 8/15 E* sqrt(a* delta) delta^2, (M,), in J."""
        return 4.0 / 15.0 * self.normal_stiffness(contact) * contact.overlap**2
