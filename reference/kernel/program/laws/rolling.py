"""Rolling resistance by a spring: a slider with a* (omega_i - omega_j) x n for its rate, that acts as a couple."""

from __future__ import annotations

import numpy as np

from reference.kernel.laws.rolling import SpringRolling
from reference.kernel.program.laws.setting import Setting
from reference.kernel.program.slider import Spring, slide, slide_across


def spring_rolling(law: SpringRolling, s: Setting) -> None:
    """couple = a* n x F in the tangent plane, a* F about axes in space. History "rolling": the tension."""
    p, c = s.p, s.c
    spring = Spring(
        algorithm=law.algorithm, memory=c.history["rolling"], growth=law.rolling_stiffness * s.model.dt,
        damping=law.rolling_damping or None, friction=law.rolling_friction, turns=law.frame == "contact",
    )
    if law.frame == "contact":
        rate, force = s.rotation.rolling_velocity(p, c), c.tangents.buffer("rolling force")
        slide_across(p, c, spring, rate=rate, out=force, pulls=False)
        s.rotation.couple_of(p, c, force)
    else:
        rate = s.rotation.across(p, c, c.rolling)
        slide(p, c, c.tangents, spring, rate=rate, out=c.couple)
        p(np.multiply, c.couple, c.reduced_radius, out=c.couple)
