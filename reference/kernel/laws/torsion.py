"""Torsion resistance by a spring: sticking and sliding of a quasi-force about the normal (3D).

S. Luding, Granular Matter 10, 235 (2008), section 2.3.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from reference.kernel.laws.contact import Pressing, Touching
from reference.kernel.laws.law import CoupleLaw, Memory
from reference.kernel.laws.slider import Slider
from reference.kernel.vectors import dot


@dataclass(frozen=True, kw_only=True)
class SpringTorsion(CoupleLaw):
    """f_o = -k_o xi - gamma_o v_o up to mu_o f, v_o = a* n.(omega_i - omega_j); couple a* f_o n on i.

    f is the base of `Pressing`; `algorithm` as in `slider`. The memory is the spring xi, (1, M) in m.
    """

    choices: ClassVar[dict[str, str]] = {"algorithm": "torsion"}
    first_order: ClassVar[str] = "its spring is stretched by the last rate, and begins and ends with the step"

    torsion_friction: float
    torsion_stiffness: float
    torsion_damping: float
    algorithm: str

    def memory_rows(self, dimension: int) -> int:
        """One: the spring about the normal."""
        del dimension
        return 1

    def couple(
        self, contact: Touching, pressing: Pressing, memory: Memory, dt: float, *, advance: bool
    ) -> tuple[np.ndarray, Memory]:
        """Return the couple on i, (3, M) in N m, and the new memory."""
        slider = Slider(
            algorithm=self.algorithm, stiffness=self.torsion_stiffness, damping=self.torsion_damping,
            friction=self.torsion_friction,
        )
        a, n = contact.reduced_radius, contact.n
        rate = (a * dot(contact.spin, n))[None]
        force, memory = slider.move(memory, rate, pressing.base, None, dt, advance=advance)
        return a * force * n, memory

    def spring(self, contact: Touching) -> tuple[np.ndarray, np.ndarray]:
        """Return k_o, (M,) in N/m, and gamma_o, (M,) in kg/s."""
        one = np.ones_like(contact.overlap)
        return self.torsion_stiffness * one, self.torsion_damping * one

    def energy(self, contact: Touching, memory: np.ndarray) -> np.ndarray:
        """Return the stored energy k_o xi^2 / 2, (M,), in J."""
        del contact
        return 0.5 * self.torsion_stiffness * memory[0] ** 2
