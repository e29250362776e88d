"""Coulomb friction with S_t = 8 G* sqrt(a* delta) and gamma_t = sqrt(10/3) beta sqrt(S_t m*), made from Hertz's.

With K = 4/3 E* sqrt(a* delta) that is S_t = 6 G*/E* K and gamma_t = gamma_n sqrt(4 G*/E*). History "sliding" is the
elongation xi, as the tension changes with the overlap; within a step it is the tension S_t xi.
"""

from __future__ import annotations

import math

import numpy as np

from reference.kernel.laws.mindlin import MindlinSliding
from reference.kernel.laws.spheres import effective_modulus, effective_shear_modulus
from reference.kernel.program.components import TINY
from reference.kernel.program.laws.setting import Setting
from reference.kernel.program.slider import Spring, slide_across


def mindlin_sliding(law: MindlinSliding, s: Setting) -> None:
    """xi *= S_t; shear = F of a slider; xi /= S_t."""
    p, c, xi, stiffness = s.p, s.c, s.c.history["sliding"], s.c.buffer("shear stiffness")
    elasticity = law.normal.youngs_modulus, law.normal.poisson_ratio
    ratio = effective_shear_modulus(*elasticity) / effective_modulus(*elasticity)
    p(np.multiply, s.normal.stiffness, 6.0 * ratio, out=stiffness)
    p(np.multiply, xi, stiffness, out=xi)
    c.pull = slide_across(p, c, _spring(law, s, stiffness, ratio), rate=c.v_t, out=c.shear, pulls=True)
    p(np.maximum, stiffness, TINY, out=stiffness)
    p(np.divide, xi, stiffness, out=xi)


def _spring(law: MindlinSliding, s: Setting, stiffness: np.ndarray, ratio: float) -> Spring:
    growth, damping = s.c.buffer("growth"), None
    s.p(np.multiply, stiffness, s.model.dt, out=growth)
    if s.normal.damped:
        damping = s.c.buffer("gamma")
        s.p(np.multiply, damping, math.sqrt(4.0 * ratio), out=damping)
    return Spring(algorithm=law.algorithm, memory=s.c.history["sliding"], growth=growth, damping=damping,
                  friction=law.shear_friction, mean_rate=s.c.mean_v_t)
