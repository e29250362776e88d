"""f_n = k_n delta - gamma_n v_n, clipped at 0 if attraction is."""

from __future__ import annotations

import numpy as np

from reference.kernel.laws.linear import LinearNormal
from reference.kernel.program.contacts import Contacts
from reference.kernel.program.program import Program


def linear(p: Program, law: LinearNormal, c: Contacts) -> None:
    """f_n from overlap and v_n."""
    p(np.multiply, c.overlap, law.normal_stiffness, out=c.f_n)
    if not law.normal_damping:
        return
    p.effect("normal damping")
    p(np.multiply, c.v_n, law.normal_damping, out=c.a)
    p(np.subtract, c.f_n, c.a, out=c.f_n)
    if law.attraction == "clipped":
        p(np.maximum, c.f_n, 0.0, out=c.f_n)
