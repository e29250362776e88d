"""Coulomb friction with the tangential stiffness of elastic spheres (R. D. Mindlin, J. Appl. Mech. 16, 259 (1949))."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from reference.kernel.laws.contact import Pressing, Touching
from reference.kernel.laws.hertz import HertzNormal
from reference.kernel.laws.law import Memory, SlidingLaw
from reference.kernel.laws.slider import Slider
from reference.kernel.vectors import dot


@dataclass(frozen=True, kw_only=True)
class MindlinSliding(SlidingLaw):
    """f_t = -S_t xi - gamma_t v_t up to mu f, S_t = 8 G* sqrt(a* delta) at the overlap of now, gamma_t of Hertz's e.

    The no-slip stiffness, without partial slip and without rescaling of xi on unloading: LAMMPS' `mindlin`,
    LIGGGHTS' `hertz tangential history`. As S_t changes with the overlap there is no potential. By the algorithm of the
    talks it is felt one step late: gamma_t/S_t = 2 sqrt(5/6) beta sqrt(m*/S_t) is the step up to which its own dashpot
    holds it (`reference.kernel.late_springs`).
    The memory is the spring xi, (dim, M) in m. Raises ValueError with another normal law than Hertz's.
    """

    choices: ClassVar[dict[str, str]] = {"algorithm": "sliding"}
    first_order: ClassVar[str] = "on a damped Hertz contact, which is singular where it begins"

    shear_friction: float
    normal: HertzNormal
    algorithm: str

    def __post_init__(self) -> None:
        if not isinstance(self.normal, HertzNormal):
            raise ValueError(f"sliding 'mindlin': expected the normal law 'hertz', got {type(self.normal).__name__}")

    @property
    def needs(self) -> frozenset[str]:
        """The slip velocity, a*, and m* if there is a dashpot."""
        return super().needs | self.normal.needs

    def memory_rows(self, dimension: int) -> int:
        """The components of the spring."""
        return dimension

    def spring(self, contact: Touching) -> tuple[np.ndarray, np.ndarray]:
        """Return S_t, (M,) in N/m, and gamma_t, (M,) in kg/s."""
        stiffness = self.normal.shear_stiffness(contact)
        return stiffness, np.broadcast_to(self.normal.shear_damping(contact), stiffness.shape)

    def energy(self, contact: Touching, memory: np.ndarray) -> np.ndarray:
        """Return S_t xi^2/2, (M,), in J: no potential, but what slip at the overlap of now gives back."""
        return 0.5 * self.normal.shear_stiffness(contact) * dot(memory, memory)

    def force(
        self, contact: Touching, pressing: Pressing, memory: Memory, dt: float, *, advance: bool
    ) -> tuple[np.ndarray, Memory]:
        """Return the force on i, (dim, M) in N, and the new memory."""
        slider = Slider(
            algorithm=self.algorithm, stiffness=self.normal.shear_stiffness(contact),
            damping=self.normal.shear_damping(contact), friction=self.shear_friction,
        )
        return slider.move(
            memory, contact.v_t, pressing.base, contact.n, dt, advance=advance,
            mean_rate=contact.mean_v_t,
        )
