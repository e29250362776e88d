"""What the operations of all normal laws share; see `reference.kernel.laws.law.NormalLaw`."""

from __future__ import annotations

import numpy as np

from reference.kernel.laws.law import NormalLaw
from reference.kernel.program.contacts import Contacts
from reference.kernel.program.program import Program


class NormalOperations:
    """f_n = f_el - gamma v_n, clipped at 0 if attraction is.

    elastic_force: (P,) f_el after `force`; with keep_elastic in a buffer of its own, else where f_n is.
    """

    reads_touching = False
    """Whether the law must be told where something touches, because overlap 0 does not make it 0."""

    grips_elastically = False
    """Whether limits are made from f_el instead of f_n."""

    def __init__(self, law: NormalLaw, c: Contacts, *, keep_elastic: bool):
        self.law, self.c = law, c
        apart = self.damped and (keep_elastic or self.grips_elastically)
        self.elastic_force = c.buffer("elastic force") if apart else c.f_n

    @classmethod
    def unit(cls, law: NormalLaw) -> float:
        """Return history over what the textbook remembers."""
        del law
        return 1.0

    @property
    def damped(self) -> bool:
        """Whether there is a dashpot."""
        return bool(self.law.normal_damping)

    def force(self, p: Program) -> None:
        """c.f_n from overlaps and v_n."""
        c = self.c
        p.effect("normal contact")
        self.elastic(p, self.elastic_force)
        if not self.damped:
            return
        p.effect("normal damping")
        self.dashpot(p, c.a)
        p(np.subtract, self.elastic_force, c.a, out=c.f_n)
        if self.law.attraction == "clipped":
            p(np.maximum, c.f_n, 0.0, out=c.f_n)

    def elastic(self, p: Program, out: np.ndarray) -> None:
        """out = f_el; a and b are free."""
        raise NotImplementedError

    def dashpot(self, p: Program, out: np.ndarray) -> None:
        """out = gamma v_n."""
        p(np.multiply, self.c.v_n, self.law.normal_damping, out=out)

    def gripping(self, p: Program, force: np.ndarray, out: np.ndarray) -> np.ndarray:
        """Return the force counted from the strongest pull: `force`, or `out` where a law computes it."""
        del p, out
        return force

    def loading(self, p: Program, out: np.ndarray) -> np.ndarray:
        """Return f_el by the stiffness of first loading: as it is, or `out` where a law computes it."""
        del p, out
        return self.elastic_force
