"""Every combination of contact laws that `grainproof laws` proves: one row a combination.

Numbers suit the bodies of `motions`: half a millimetre of reduced radius, overlaps up to six per cent of a radius,
limits of friction that the motions go beyond and back, and damping that carries a sixth of the force.
"""

from __future__ import annotations

from dataclasses import dataclass

from harness.scene.contact import (
    ConstantRolling,
    DmtNormal,
    HertzNormal,
    HystereticNormal,
    JkrNormal,
    LinearNormal,
    MindlinSliding,
    NormalLaw,
    RollingLaw,
    SlidingLaw,
    SpringRolling,
    SpringSliding,
    SpringTorsion,
    VariableHystereticNormal,
    ViscousSliding,
)
from harness.studies.laws.motions import EQUAL_RADII, UNEQUAL, Grains

TOLERANCE = 1e-12
"""Largest deviation of a code from the kernel in its conventions, and of either from closed forms, relative."""


@dataclass(frozen=True, kw_only=True)
class Laws:
    """One combination of laws.

    grains: of its pairs. floor: whether its collisions include those with a floor, which one code or another cannot
    compute in the same run as pairs.
    """

    name: str
    normal: NormalLaw
    sliding: SlidingLaw | None = None
    rolling: RollingLaw | None = None
    torsion: SpringTorsion | None = None
    dimensions: tuple[int, ...] = (2, 3)
    grains: Grains = UNEQUAL
    floor: bool = True

    def tables(self) -> dict[str, object]:
        """Return the four tables as a System takes them."""
        return {k: getattr(self, k) for k in ("normal", "sliding", "rolling", "torsion")}


LINEAR = LinearNormal(normal_stiffness=1e5, normal_damping=1.0, attraction="allowed")
CLIPPED = LinearNormal(normal_stiffness=1e5, normal_damping=1.0, attraction="clipped")
ELASTIC = LinearNormal(normal_stiffness=1e5, normal_damping=0.0, attraction="allowed")
HERTZ, HERTZ_CLIPPED = (
    HertzNormal(youngs_modulus=1e8, poisson_ratio=0.25, restitution=0.6, attraction=a, impact_speed=1.0)
    for a in ("allowed", "clipped")
)
HYSTERETIC, HYSTERETIC_DAMPED = (
    HystereticNormal(loading_stiffness=5e4, unloading_stiffness=1e5, adhesion_stiffness=5e4, normal_damping=g)
    for g in (0.0, 0.5)
)
VARIABLE, VARIABLE_DAMPED = (
    VariableHystereticNormal(
        loading_stiffness=5e4, largest_unloading_stiffness=1e5, adhesion_stiffness=5e4, plasticity_depth=0.025,
        normal_damping=g,
    )
    for g in (0.0, 0.5)
)
DMT = DmtNormal(youngs_modulus=1e8, poisson_ratio=0.25, surface_energy=5.0, normal_damping=0.1, impact_speed=1.0)
JKR = JkrNormal(youngs_modulus=1e8, poisson_ratio=0.25, surface_energy=5.0, normal_damping=0.1, impact_speed=1.0)

SPRING = SpringSliding(shear_friction=0.31, shear_stiffness=3e4, shear_damping=0.0)
DAMPED_SPRING = SpringSliding(shear_friction=0.31, shear_stiffness=3e4, shear_damping=0.25)
DYNAMIC = SpringSliding(shear_friction=0.31, shear_stiffness=3e4, shear_damping=0.0, dynamic_friction=0.23)
VISCOUS = ViscousSliding(shear_friction=0.31, shear_damping=0.7)
MINDLIN = MindlinSliding(shear_friction=0.31)

ROLLING = SpringRolling(rolling_friction=0.11, rolling_stiffness=1e4, rolling_damping=0.05)
ROLLING_CONSTANT = ConstantRolling(rolling_friction=0.11)
TORSION = SpringTorsion(torsion_friction=0.11, torsion_stiffness=1e4, torsion_damping=0.05)

_ROWS = (
    Laws(name="linear", normal=LINEAR),
    Laws(name="linear_clipped", normal=CLIPPED),
    Laws(name="hertz", normal=HERTZ),
    Laws(name="hertz_clipped", normal=HERTZ_CLIPPED),
    Laws(name="hysteretic", normal=HYSTERETIC),
    Laws(name="hysteretic_variable", normal=VARIABLE),
    Laws(name="dmt", normal=DMT),
    Laws(name="jkr", normal=JKR, floor=False),
    Laws(name="linear+spring", normal=LINEAR, sliding=SPRING),
    Laws(name="linear+spring_damped", normal=LINEAR, sliding=DAMPED_SPRING),
    Laws(name="linear+spring_dynamic", normal=LINEAR, sliding=DYNAMIC),
    Laws(name="elastic+spring_damped", normal=ELASTIC, sliding=DAMPED_SPRING),
    Laws(name="linear+viscous", normal=LINEAR, sliding=VISCOUS),
    Laws(name="hertz+mindlin", normal=HERTZ, sliding=MINDLIN),
    Laws(name="hertz+viscous", normal=HERTZ, sliding=VISCOUS),
    Laws(name="hysteretic+spring", normal=HYSTERETIC_DAMPED, sliding=SPRING),
    Laws(name="hysteretic+spring_dynamic", normal=HYSTERETIC_DAMPED, sliding=DYNAMIC),
    Laws(name="hysteretic_variable+spring", normal=VARIABLE_DAMPED, sliding=SPRING),
    Laws(name="hysteretic_variable+spring_dynamic", normal=VARIABLE_DAMPED, sliding=DYNAMIC),
    Laws(name="linear+rolling", normal=LINEAR, rolling=ROLLING),
    Laws(name="linear+spring+rolling", normal=LINEAR, sliding=SPRING, rolling=ROLLING),
    Laws(name="linear+spring+rolling_constant", normal=LINEAR, sliding=SPRING, rolling=ROLLING_CONSTANT),
    Laws(name="hysteretic+spring+rolling", normal=HYSTERETIC_DAMPED, sliding=SPRING, rolling=ROLLING),
    Laws(name="linear+spring+torsion", normal=LINEAR, sliding=SPRING, torsion=TORSION, dimensions=(3,),
         grains=EQUAL_RADII, floor=False),
    Laws(name="hertz+mindlin+rolling+torsion", normal=HERTZ, sliding=MINDLIN, rolling=ROLLING, torsion=TORSION,
         dimensions=(3,), grains=EQUAL_RADII, floor=False),
)

CASES: dict[str, Laws] = {laws.name: laws for laws in _ROWS}
"""By name; a new combination is one row above."""
