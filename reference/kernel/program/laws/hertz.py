"""f_el = K delta, K = 4/3 E* sqrt(a* delta);  gamma = g sqrt(K), g = sqrt(10/3) beta sqrt(3/2 m*).

The slope of f_el is S_n = 3/2 K, of which gamma is made: sqrt(10/3) beta sqrt(S_n m*). K and gamma are kept for the
tangential stiffness of the same spheres.
"""

from __future__ import annotations

import numpy as np

from reference.kernel.laws.hertz import HertzNormal
from reference.kernel.laws.spheres import damping, effective_modulus
from reference.kernel.program.buffers import lined_up
from reference.kernel.program.contacts import Contacts
from reference.kernel.program.laws.normal import NormalOperations
from reference.kernel.program.program import Program


class Hertz(NormalOperations):
    """`reference.kernel.laws.hertz.HertzNormal`. stiffness, gamma: (P,) K and gamma of the step."""

    def __init__(self, law: HertzNormal, c: Contacts, *, keep_elastic: bool):
        super().__init__(law, c, keep_elastic=keep_elastic)
        modulus = effective_modulus(law.youngs_modulus, law.poisson_ratio)
        self.unit_stiffness = lined_up(4.0 / 3.0 * modulus * np.sqrt(c.reduced_radius))
        self.stiffness = c.buffer("stiffness")
        if self.damped:
            self.unit_damping = lined_up(damping(law.restitution, np.full(c.count, 1.5), c.reduced_mass))
            self.gamma = c.buffer("gamma")

    @property
    def damped(self) -> bool:
        """Whether there is a dashpot."""
        return self.law.restitution < 1.0

    def elastic(self, p: Program, out: np.ndarray) -> None:
        """K = K_1 sqrt(delta), K_1 the constant of the contact; out = K delta."""
        p(np.sqrt, self.c.overlap, out=self.stiffness)
        p(np.multiply, self.stiffness, self.unit_stiffness, out=self.stiffness)
        p(np.multiply, self.stiffness, self.c.overlap, out=out)

    def dashpot(self, p: Program, out: np.ndarray) -> None:
        """gamma = g sqrt(K); out = gamma v_n."""
        p(np.sqrt, self.stiffness, out=self.gamma)
        p(np.multiply, self.gamma, self.unit_damping, out=self.gamma)
        p(np.multiply, self.gamma, self.c.v_n, out=out)
