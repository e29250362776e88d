"""f_el = k_n delta."""

from __future__ import annotations

import numpy as np

from reference.kernel.program.laws.normal import NormalOperations
from reference.kernel.program.program import Program


class Linear(NormalOperations):
    """`reference.kernel.laws.linear.LinearNormal`."""

    def elastic(self, p: Program, out: np.ndarray) -> None:
        """out = k_n delta."""
        p(np.multiply, self.c.overlap, self.law.normal_stiffness, out=out)
