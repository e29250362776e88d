"""f_el = max(k_2 delta - (k_2 - k_1) M, -k_c delta) with the largest overlap M.

On the adhesive branch -k_c delta, M is drawn back to r delta, r = (k_2 + k_c)/(k_2 - k_1). Anywhere else it is below
that, so that M = min(M, r delta) does it without asking.
"""

from __future__ import annotations

import numpy as np

from reference.kernel.laws.hysteretic import PlasticNormal
from reference.kernel.program.contacts import Contacts
from reference.kernel.program.laws.normal import NormalOperations
from reference.kernel.program.program import Program


class Plastic(NormalOperations):
    """Loading along k_1, a pull of k_c delta at most; history "normal": M."""

    def __init__(self, law: PlasticNormal, c: Contacts, *, keep_elastic: bool):
        super().__init__(law, c, keep_elastic=keep_elastic)
        self.pull = c.buffer("pull") if law.adhesion_stiffness else 0.0

    def pull_at_most(self, p: Program, out: np.ndarray) -> None:
        """out = max(out, -k_c delta)."""
        if self.law.adhesion_stiffness:
            p.effect("adhesion")
            p(np.multiply, self.c.overlap, -self.law.adhesion_stiffness, out=self.pull)
            p.effect("normal contact")
        p(np.maximum, out, self.pull, out=out)

    def gripping(self, p: Program, force: np.ndarray, out: np.ndarray) -> np.ndarray:
        """Return f + k_c delta."""
        if not self.law.adhesion_stiffness:
            return force
        p.effect("adhesion")
        p(np.subtract, force, self.pull, out=out)
        return out

    def loading(self, p: Program, out: np.ndarray) -> np.ndarray:
        """Return k_1 delta."""
        p(np.multiply, self.c.overlap, self.law.loading_stiffness, out=out)
        return out


class Hysteretic(Plastic):
    """`reference.kernel.laws.hysteretic.HystereticNormal`."""

    @property
    def reads_touching(self) -> bool:
        """With k_2 = k_1 there is no adhesive branch, and an opening contact must be told to forget M."""
        return not self.law.unloading_stiffness > self.law.loading_stiffness

    def elastic(self, p: Program, out: np.ndarray) -> None:
        """M = max(M, delta); out = f_el; M drawn back."""
        k_1, k_2, k_c = self.law.loading_stiffness, self.law.unloading_stiffness, self.law.adhesion_stiffness
        overlap, largest, work = self.c.overlap, self.c.history["normal"][0], self.c.a
        p(np.maximum, largest, overlap, out=largest)
        p(np.multiply, overlap, k_2, out=out)
        p(np.multiply, largest, k_2 - k_1, out=work)
        p(np.subtract, out, work, out=out)
        if self.reads_touching:
            p(np.multiply, largest, self.c.touching, out=largest)
        else:
            p(np.multiply, overlap, (k_2 + k_c) / (k_2 - k_1), out=work)
            p(np.minimum, largest, work, out=largest)
        self.pull_at_most(p, out)
