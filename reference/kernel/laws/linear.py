"""Linear spring and dashpot along the normal (Cundall & Strack, Geotechnique 29, 47 (1979))."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from reference.kernel.laws.contact import Touching


@dataclass(frozen=True, kw_only=True)
class LinearNormal:
    """f_n = k_n delta - gamma_n v_n, positive in compression; v_n > 0 when the partners separate.

    With `clip_attraction` f_n is never negative: the contact then ends in force before it ends in
    overlap, which is another law with another restitution (Schwager & Poeschel, Granular Matter 9,
    465 (2007)).
    """

    normal_stiffness: float
    normal_damping: float
    clip_attraction: bool

    def force(self, contact: Touching) -> np.ndarray:
        """Return f_n, shape (M,), in N."""
        force = self.normal_stiffness * contact.overlap
        if self.normal_damping:
            force -= self.normal_damping * contact.v_n
        if self.clip_attraction:
            np.maximum(force, 0.0, out=force)
        return force

    def energy(self, overlap: np.ndarray) -> np.ndarray:
        """Return the stored energy k_n delta^2 / 2, shape (M,), in J."""
        return 0.5 * self.normal_stiffness * overlap**2
