"""f_el = 4/3 E* sqrt(a* delta) delta - f_a where something touches; limits are made of f_el + 2 f_a."""

from __future__ import annotations

import math

import numpy as np

from reference.kernel.laws.dmt import DmtNormal
from reference.kernel.laws.spheres import effective_modulus
from reference.kernel.program.buffers import lined_up
from reference.kernel.program.contacts import Contacts
from reference.kernel.program.laws.normal import NormalOperations
from reference.kernel.program.program import Program


class Dmt(NormalOperations):
    """`reference.kernel.laws.dmt.DmtNormal`."""

    reads_touching = True
    grips_elastically = True

    def __init__(self, law: DmtNormal, c: Contacts, *, keep_elastic: bool):
        super().__init__(law, c, keep_elastic=keep_elastic)
        modulus = effective_modulus(law.youngs_modulus, law.poisson_ratio)
        self.unit_stiffness = lined_up(4.0 / 3.0 * modulus * np.sqrt(c.reduced_radius))
        self.full_pull, self.pull = lined_up(4.0 * math.pi * law.surface_energy * c.reduced_radius), c.buffer("pull")

    def elastic(self, p: Program, out: np.ndarray) -> None:
        """out = K sqrt(delta) delta - f_a."""
        overlap = self.c.overlap
        p(np.sqrt, overlap, out=out)
        p(np.multiply, out, self.unit_stiffness, out=out)
        p(np.multiply, out, overlap, out=out)
        p.effect("adhesion")
        p(np.multiply, self.c.touching, self.full_pull, out=self.pull)
        p(np.subtract, out, self.pull, out=out)

    def gripping(self, p: Program, force: np.ndarray, out: np.ndarray) -> np.ndarray:
        """Return f_el + 2 f_a."""
        del force
        p.effect("adhesion")
        p(np.multiply, self.pull, 2.0, out=out)
        p(np.add, out, self.elastic_force, out=out)
        return out
