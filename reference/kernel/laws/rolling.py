"""Rolling resistance by a spring: sticking and sliding of a quasi-force that acts as a couple only.

S. Luding, Granular Matter 10, 235 (2008), section 2.3.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from reference.kernel.laws.contact import Pressing, Touching
from reference.kernel.laws.law import CoupleLaw, Memory
from reference.kernel.laws.slider import Slider
from reference.kernel.vectors import across, spin_components, spin_cross, torque_cross


@dataclass(frozen=True, kw_only=True)
class SpringRolling(CoupleLaw):
    """f_r = -k_r xi - gamma_r v_r up to mu_r f, v_r = a* (omega_i - omega_j) x n; couple a* n x f_r on i.

    f is the base of `Pressing`; `algorithm` as in `slider`. The memory is the spring xi in m; in which `frame`
    it is kept is a choice: "contact": (dim, M) in the tangent plane, turned with the contact; "space": (1|3, M),
    a* times the angle of relative rolling about space-fixed axes, which do not follow the contact, so that its
    couple may come to have a part along the normal (LIGGGHTS' epsd family).
    """

    choices: ClassVar[dict[str, str]] = {"algorithm": "rolling", "frame": "rolling_frame"}
    first_order: ClassVar[str] = "its spring is stretched by the last rate, and begins and ends with the step"

    rolling_friction: float
    rolling_stiffness: float
    rolling_damping: float
    algorithm: str
    frame: str

    def memory_rows(self, dimension: int) -> int:
        """The components of the spring."""
        return dimension if self.frame == "contact" else spin_components(dimension)

    def couple(
        self, contact: Touching, pressing: Pressing, memory: Memory, dt: float, *, advance: bool
    ) -> tuple[np.ndarray, Memory]:
        """Return the couple on i, (1|3, M) in N m, and the new memory."""
        slider = Slider(
            algorithm=self.algorithm, stiffness=self.rolling_stiffness, damping=self.rolling_damping,
            friction=self.rolling_friction,
        )
        a, n = contact.reduced_radius, contact.n
        if self.frame == "space":
            rate = a * across(contact.spin, n)
            force, memory = slider.move(memory, rate, pressing.base, None, dt, advance=advance)
            return a * force, memory
        rate = a * spin_cross(contact.spin, n)
        force, memory = slider.move(memory, rate, pressing.base, n, dt, advance=advance)
        return a * torque_cross(n, force), memory

    def spring(self, contact: Touching) -> tuple[np.ndarray, np.ndarray]:
        """Return k_r, (M,) in N/m, and gamma_r, (M,) in kg/s."""
        one = np.ones_like(contact.overlap)
        return self.rolling_stiffness * one, self.rolling_damping * one

    def energy(self, contact: Touching, memory: np.ndarray) -> np.ndarray:
        """Return the stored energy k_r xi^2 / 2, (M,), in J."""
        del contact
        return 0.5 * self.rolling_stiffness * (memory * memory).sum(axis=0)
