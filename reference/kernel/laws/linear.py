"""Linear spring and dashpot along the normal (Cundall & Strack, Geotechnique 29, 47 (1979))."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from reference.kernel.laws.contact import Touching
from reference.kernel.laws.law import Memory, NormalLaw


@dataclass(frozen=True, kw_only=True)
class LinearNormal(NormalLaw):
    """f_n = k_n delta - gamma_n v_n; `attraction` "allowed" or "clipped" as in `NormalLaw`."""

    onset: ClassVar[tuple[float, float] | None] = (1.0, 0.0)

    normal_stiffness: float
    normal_damping: float
    attraction: str

    def elastic(self, contact: Touching, memory: Memory) -> tuple[np.ndarray, Memory]:
        """Return k_n delta, (M,) in N."""
        return self.normal_stiffness * contact.overlap, memory

    def damping(self, contact: Touching) -> float | None:
        """Return gamma_n, kg/s."""
        del contact
        return self.normal_damping or None

    def energy(self, contact: Touching) -> np.ndarray:
        """Return the stored energy k_n delta^2 / 2, shape (M,), in J."""
        return 0.5 * self.normal_stiffness * contact.overlap**2
