"""Coulomb friction with a tangential spring: history "sliding" is its tension, so that no step divides by k_t."""

from __future__ import annotations

from reference.kernel.laws.sliding import SpringSliding
from reference.kernel.program.laws.setting import Setting
from reference.kernel.program.slider import Spring, slide_across


def spring_sliding(law: SpringSliding, s: Setting) -> None:
    """shear = F of a slider with T = k_t xi, gamma_t, mu f."""
    spring = Spring(
        algorithm=law.algorithm, memory=s.c.history["sliding"], growth=law.shear_stiffness * s.model.dt,
        damping=law.shear_damping or None, friction=law.shear_friction, dynamic_friction=law.dynamic_friction,
        mean_rate=s.c.mean_v_t,
    )
    s.c.pull = slide_across(s.p, s.c, spring, rate=s.c.v_t, out=s.c.shear, pulls=True)
