"""Coulomb friction with a tangential spring and dashpot (Cundall & Strack, Geotechnique 29, 47 (1979))."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from reference.kernel.laws.contact import Pressing, Touching
from reference.kernel.laws.law import Memory, SlidingLaw
from reference.kernel.laws.slider import Slider, memory_rows
from reference.kernel.vectors import dot


@dataclass(frozen=True, kw_only=True)
class SpringSliding(SlidingLaw):
    """f_t = -k_t xi - gamma_t v_t up to mu f, mu_d f while sliding; `algorithm` as in `slider`.

    f is the base of `Pressing`. The memory is the spring xi, (dim, M) in m, in the tangent plane.
    """

    choices: ClassVar[dict[str, str]] = {"algorithm": "sliding"}
    first_order: ClassVar[str] = "with a dashpot on a damped Hertz contact, which is singular where it begins"

    shear_friction: float
    shear_stiffness: float
    shear_damping: float
    algorithm: str
    dynamic_friction: float | None = None

    def memory_rows(self, dimension: int) -> int:
        """Return the rows of the spring, and one of the state with a dynamic coefficient."""
        return memory_rows(dimension, self.algorithm, self.dynamic_friction)

    def force(
        self, contact: Touching, pressing: Pressing, memory: Memory, dt: float, *, advance: bool
    ) -> tuple[np.ndarray, Memory]:
        """Return the force on i, (dim, M) in N, and the new memory."""
        slider = Slider(
            algorithm=self.algorithm, stiffness=self.shear_stiffness, damping=self.shear_damping,
            friction=self.shear_friction, dynamic_friction=self.dynamic_friction,
        )
        return slider.move(
            memory, contact.v_t, pressing.base, contact.n, dt, advance=advance,
            mean_rate=contact.mean_v_t,
        )

    def spring(self, contact: Touching) -> tuple[np.ndarray, np.ndarray]:
        """Return k_t, (M,) in N/m, and gamma_t, (M,) in kg/s."""
        one = np.ones_like(contact.overlap)
        return self.shear_stiffness * one, self.shear_damping * one

    def energy(self, contact: Touching, memory: np.ndarray) -> np.ndarray:
        """Return the stored energy k_t xi^2 / 2, shape (M,), in J."""
        xi = memory[: len(contact.n)]
        return 0.5 * self.shear_stiffness * dot(xi, xi)
