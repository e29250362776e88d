"""Torsion resistance by a spring: a slider with the one number a* n.(omega_i - omega_j) for its rate."""

from __future__ import annotations

from reference.kernel.laws.torsion import SpringTorsion
from reference.kernel.program.components import Numbers
from reference.kernel.program.laws.setting import Setting
from reference.kernel.program.slider import Spring, slide


def spring_torsion(law: SpringTorsion, s: Setting) -> None:
    """a* F n is added to couple, or becomes it without rolling resistance. History "torsion": the tension."""
    p, c = s.p, s.c
    spring = Spring(
        algorithm=law.algorithm, memory=c.history["torsion"], growth=law.torsion_stiffness * s.model.dt,
        damping=law.torsion_damping or None, friction=law.torsion_friction, turns=False,
    )
    rate, force = c.buffer("twisting"), c.buffer("twist")
    s.rotation.twisting_velocity(p, c, rate)
    slide(p, c, Numbers(c), spring, rate=rate, out=force)
    s.rotation.twist_by(p, c, force, add=s.model.rolling is not None)
