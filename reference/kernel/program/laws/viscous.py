"""f_t = -cut(gamma_t v_t) with the limit mu f: a dashpot that slides. No history."""

from __future__ import annotations

import numpy as np

from reference.kernel.laws.viscous import ViscousSliding
from reference.kernel.program.laws.setting import Setting


def viscous_sliding(law: ViscousSliding, s: Setting) -> None:
    """shear = cut(gamma_t v_t); f is the base, or the size of f_n."""
    p, c, limit = s.p, s.c, s.c.buffer("limit")
    f = c.base
    if law.limit == "total":
        f = c.a
        p(np.abs, c.f_n, out=f)
    p(np.multiply, f, law.shear_friction, out=limit)
    p(np.multiply, c.v_t, law.shear_damping, out=c.shear)
    c.tangents.cut(p, c.shear, limit, c.shear)
