"""Laws by pair of materials: the numbers of each pair are looked up once, when the list of pairs is new."""

from __future__ import annotations

import numpy as np

from reference.kernel.laws.by_pair import LinearByPair as Textbook
from reference.kernel.laws.by_pair import SpringByPair
from reference.kernel.program.buffers import lined_up
from reference.kernel.program.contacts import Contacts
from reference.kernel.program.laws.normal import NormalOperations
from reference.kernel.program.laws.setting import Setting
from reference.kernel.program.program import Program
from reference.kernel.program.slider import Spring, slide_across


class LinearByPair(NormalOperations):
    """`reference.kernel.laws.by_pair.LinearByPair`. stiffness, gamma: (P,)."""

    def __init__(self, law: Textbook, c: Contacts, *, keep_elastic: bool):
        super().__init__(law, c, keep_elastic=keep_elastic)
        found = law.between(c.i, c.j)
        self.stiffness = lined_up(found["normal_stiffness"])
        if self.damped:
            self.gamma = lined_up(found["normal_damping"])

    @property
    def damped(self) -> bool:
        """Whether any pair of materials has a dashpot."""
        return bool(self.law.normal_damping.any())

    def elastic(self, p: Program, out: np.ndarray) -> None:
        """out = k_ab delta."""
        p(np.multiply, self.c.overlap, self.stiffness, out=out)

    def dashpot(self, p: Program, out: np.ndarray) -> None:
        """out = gamma_ab v_n."""
        p(np.multiply, self.c.v_n, self.gamma, out=out)


def spring_sliding_by_pair(law: SpringByPair, s: Setting) -> None:
    """shear = F of a slider with T = k_ab xi, gamma_ab, mu_ab f."""
    found = law.between(s.c.i, s.c.j)
    spring = Spring(
        algorithm=law.algorithm, memory=s.c.history["sliding"], growth=lined_up(found["shear_stiffness"] * s.model.dt),
        damping=lined_up(found["shear_damping"]) if law.shear_damping.any() else None,
        friction=lined_up(found["shear_friction"]), roughest=float(law.shear_friction.max()), mean_rate=s.c.mean_v_t,
    )
    s.c.pull = slide_across(s.p, s.c, spring, rate=s.c.v_t, out=s.c.shear, pulls=True)
