"""With the largest overlap M and E = (k_2 - k_1) M, which is what is remembered::

    E = min(max(E, (k_2 - k_1) delta), (k_2 + k_c) delta);    f_el = (k_2 + k_c) delta - E - k_c delta

The minimum draws M back on the adhesive branch, where it makes f_el = -k_c delta; anywhere else E is below it.
"""

from __future__ import annotations

import numpy as np

from reference.kernel.laws.hysteretic import HystereticNormal, PlasticNormal
from reference.kernel.program.contacts import Contacts
from reference.kernel.program.laws.normal import NormalOperations
from reference.kernel.program.program import Program


class Plastic(NormalOperations):
    """Loading along k_1, a pull of k_c delta at most. pull: (P,) -k_c delta of the step; None without adhesion."""

    def __init__(self, law: PlasticNormal, c: Contacts, *, keep_elastic: bool):
        super().__init__(law, c, keep_elastic=keep_elastic)
        self.pull = c.buffer("pull") if law.adhesion_stiffness else None

    def find_pull(self, p: Program) -> None:
        """pull = -k_c delta."""
        p.effect("adhesion")
        p(np.multiply, self.c.overlap, -self.law.adhesion_stiffness, out=self.pull)

    def gripping(self, p: Program, force: np.ndarray, out: np.ndarray) -> np.ndarray:
        """Return f + k_c delta."""
        if self.pull is None:
            return force
        p.effect("adhesion")
        p(np.subtract, force, self.pull, out=out)
        return out

    def loading(self, p: Program, out: np.ndarray) -> np.ndarray:
        """Return k_1 delta."""
        p(np.multiply, self.c.overlap, self.law.loading_stiffness, out=out)
        return out


class Hysteretic(Plastic):
    """`reference.kernel.laws.hysteretic.HystereticNormal`; history "normal": E."""

    @classmethod
    def unit(cls, law: HystereticNormal) -> float:
        """Return E over M; with k_2 = k_1, where E says nothing, M itself is the history."""
        return law.unloading_stiffness - law.loading_stiffness or 1.0

    @property
    def reads_touching(self) -> bool:
        """With k_2 = k_1 nothing draws M back: an opening contact must be told to forget it."""
        return self.law.unloading_stiffness == self.law.loading_stiffness

    def elastic(self, p: Program, out: np.ndarray) -> None:
        """E, then out = f_el."""
        if self.reads_touching:
            self._along_one_line(p, out)
        else:
            self._along_branches(p, out)

    def _along_branches(self, p: Program, out: np.ndarray) -> None:
        k_1, k_2, k_c = self.law.loading_stiffness, self.law.unloading_stiffness, self.law.adhesion_stiffness
        overlap, excess, work = self.c.overlap, self.c.history["normal"][0], self.c.a
        p(np.multiply, overlap, k_2 - k_1, out=work)
        p(np.maximum, excess, work, out=excess)
        p(np.multiply, overlap, k_2 + k_c, out=work)
        p(np.minimum, excess, work, out=excess)
        p(np.subtract, work, excess, out=out)
        if self.pull is not None:
            self.find_pull(p)
            p(np.add, out, self.pull, out=out)

    def _along_one_line(self, p: Program, out: np.ndarray) -> None:
        largest = self.c.history["normal"][0]
        p(np.maximum, largest, self.c.overlap, out=largest)
        p(np.multiply, largest, self.c.touching, out=largest)
        p(np.multiply, self.c.overlap, self.law.loading_stiffness, out=out)
        if self.pull is not None:
            self.find_pull(p)
