"""As `hysteretic` with k_2 - k_1 = s T, T = min(M, limit), s = (k_p - k_1)/limit, limit = delta* of the contact.

    f = k_1 delta + s T (delta - T);   B = delta + (k_1 + k_c) delta/(s T) is M drawn back;
    where T >= B:  f_el = -k_c delta, M = B;   else f_el = f
"""

from __future__ import annotations

import numpy as np

from reference.kernel.laws.hysteretic_variable import VariableHystereticNormal
from reference.kernel.program.buffers import lined_up
from reference.kernel.program.components import TINY
from reference.kernel.program.contacts import Contacts
from reference.kernel.program.laws.hysteretic import Plastic
from reference.kernel.program.program import Program

FAR = 1e300
"""An overlap beyond all overlaps, m."""


class VariableHysteretic(Plastic):
    """`reference.kernel.laws.hysteretic_variable.VariableHystereticNormal`; history "normal": M."""

    def __init__(self, law: VariableHystereticNormal, c: Contacts, *, keep_elastic: bool):
        super().__init__(law, c, keep_elastic=keep_elastic)
        k_1, k_p = law.loading_stiffness, law.largest_unloading_stiffness
        self.limit = lined_up(k_p / (k_p - k_1) * law.plasticity_depth * 2.0 * c.reduced_radius)
        self.slope = lined_up((k_p - k_1) / self.limit)

    def elastic(self, p: Program, out: np.ndarray) -> None:
        """f, then M, then the adhesive branch."""
        overlap, largest, k_1 = self.c.overlap, self.c.history["normal"][0], self.law.loading_stiffness
        turning, excess, work = self.c.a, self.c.b, self.c.buffer("plastic")
        p(np.maximum, largest, overlap, out=largest)
        p(np.minimum, largest, self.limit, out=turning)
        p(np.multiply, turning, self.slope, out=excess)
        p(np.subtract, overlap, turning, out=work)
        p(np.multiply, work, excess, out=work)
        p(np.multiply, overlap, k_1, out=out)
        p(np.add, out, work, out=out)
        self._draw_back(p, turning, excess, work)
        if self.pull is not None:
            self.find_pull(p)
        p(np.maximum, out, 0.0 if self.pull is None else self.pull, out=out)

    def _draw_back(self, p: Program, turning: np.ndarray, excess: np.ndarray, work: np.ndarray) -> None:
        """M = B where T >= B, else M."""
        overlap, largest = self.c.overlap, self.c.history["normal"][0]
        p(np.maximum, excess, TINY, out=excess)
        p(np.multiply, overlap, self.law.loading_stiffness + self.law.adhesion_stiffness, out=work)
        p(np.divide, work, excess, out=work)
        p(np.add, work, overlap, out=work)
        p(np.less, turning, work, out=excess)
        p(np.multiply, excess, FAR, out=excess)
        p(np.maximum, work, excess, out=work)
        p(np.minimum, largest, work, out=largest)
