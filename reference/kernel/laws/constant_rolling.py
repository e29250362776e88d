"""Rolling resistance by a couple of constant size against the direction of rolling.

Type A of J. Ai, J.-F. Chen, J. M. Rotter, J. Y. Ooi, Powder Technol. 206, 269 (2011).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from reference.kernel.laws.contact import Pressing, Touching
from reference.kernel.laws.law import CoupleLaw, Memory, NormalLaw
from reference.kernel.vectors import across, norm


@dataclass(frozen=True, kw_only=True)
class ConstantRolling(CoupleLaw):
    """Couple -mu_r a* f omega_t/|omega_t| on i, omega_t the part of omega_i - omega_j across the normal. No memory.

    algorithm: in the "talk" f is the elastic normal force, counted from the strongest pull where the contact
    adheres; "liggghts" (cdt) takes k_1 delta of a plastic contact for f, and divides by |omega_i - omega_j|, so
    that the couple is smaller where the partners twist as well.
    """

    choices: ClassVar[dict[str, str]] = {"algorithm": "constant_rolling"}
    first_order: ClassVar[str] = "its couple jumps with the direction of rolling, and begins and ends with the step"

    rolling_friction: float
    normal: NormalLaw
    algorithm: str

    @property
    def needs(self) -> frozenset[str]:
        """The relative rotation, a*, and what the normal force is made from."""
        return super().needs | self.normal.needs

    def couple(
        self, contact: Touching, pressing: Pressing, memory: Memory, dt: float, *, advance: bool
    ) -> tuple[np.ndarray, Memory]:
        """Return the couple on i, (1|3, M) in N m."""
        del dt, advance
        rolling = across(contact.spin, contact.n)
        if self.algorithm == "liggghts":
            force, size = self.normal.loading(contact), norm(contact.spin)
        else:
            force, size = self.normal.gripping(contact, pressing.elastic, pressing.elastic), norm(rolling)
        strength = self.rolling_friction * contact.reduced_radius * force
        return -np.divide(strength, size, out=np.zeros_like(size), where=size > 0.0) * rolling, memory
