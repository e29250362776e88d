"""The contact laws whose largest steps are measured, in units of mass MASS, stiffness STIFFNESS and mean radius RADIUS.

A damping ratio is that of a pair of MASS: zeta = gamma/(2 sqrt(k m*)), m* = MASS/2. Friction is so high that nothing
slides while motions are small: the limit is that of the springs and dashpots.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

from harness.scene.contact import (
    Contact,
    HertzNormal,
    HystereticNormal,
    LinearNormal,
    MindlinSliding,
    SpringRolling,
    SpringSliding,
    SpringTorsion,
    ViscousSliding,
)
from reference.analytic.hertz_collision import HertzCollision, damping_factor_for_restitution

RADIUS, MASS, STIFFNESS = 1e-3, 1e-5, 1e4
"""m, kg, N/m: the unit of time sqrt(m/k) is 3.2e-5 s."""

TIME = math.sqrt(MASS / STIFFNESS)

GRIP = 10.0
"""Coefficient of friction that nothing overcomes."""

RATIO = 0.3
"""Tangential over normal stiffness unless it is what is varied."""

OVERLAP = 1e-3
"""Mean overlap of the packings over the mean radius, for linear springs of STIFFNESS."""


@dataclass(frozen=True, kw_only=True)
class LawCase:
    """A law by the name that tables use. linear: small motions obey constant springs and dashpots."""

    name: str
    contact: Contact
    linear: bool = True


def dashpot(ratio: float, stiffness: float = STIFFNESS) -> float:
    """Return gamma, kg/s, of a damping ratio."""
    return 2 * ratio * math.sqrt(stiffness * MASS / 2)


def linear(*, damping: float = 0.0) -> LinearNormal:
    """Linear spring, and a dashpot of this ratio."""
    return LinearNormal(normal_stiffness=STIFFNESS, normal_damping=dashpot(damping), attraction="allowed")


def spring(*, ratio: float = RATIO, damping: float = 0.0, friction: float = GRIP) -> SpringSliding:
    """Tangential spring of `ratio` k_n, and a dashpot of this ratio."""
    return SpringSliding(shear_friction=friction, shear_stiffness=ratio * STIFFNESS, shear_damping=dashpot(damping))


def hertz(restitution: float) -> HertzNormal:
    """The modulus at which the slope of the force is STIFFNESS where linear springs overlap by OVERLAP RADIUS.

    Slope 2 E* sqrt(R* d) of two of RADIUS, E* = E/(2 (1 - nu^2)). An impact at `impact_speed` is as deep (d goes with
    v^(4/5)), so that the formula of scenes sees the springs that there are.
    """
    nu, overlap = 0.3, OVERLAP * RADIUS
    modulus = STIFFNESS * (1 - nu**2) / math.sqrt(RADIUS / 2 * overlap)
    impact = HertzCollision(
        stiffness=STIFFNESS / (1.5 * math.sqrt(overlap)), reduced_mass=MASS / 2,
        damping_factor=damping_factor_for_restitution(restitution),
    )
    return HertzNormal(
        youngs_modulus=modulus, poisson_ratio=nu, restitution=restitution, attraction="allowed",
        impact_speed=(overlap / impact.largest_overlap(1.0)) ** 1.25,
    )


ELASTIC = LawCase(name="spring", contact=Contact(normal=linear()))
DASHPOT = LawCase(name="spring, dashpot", contact=Contact(normal=linear(damping=0.3)))
FRICTION = LawCase(name="friction spring", contact=Contact(normal=linear(), sliding=spring()))
FULL = LawCase(
    name="friction spring, dashpots", contact=Contact(normal=linear(damping=0.3), sliding=spring(damping=0.15))
)

WEAK = LawCase(
    name="friction spring, weak dashpots", contact=Contact(normal=linear(damping=0.02), sliding=spring(damping=0.02))
)

VISCOUS = LawCase(
    name="viscous friction, dashpot",
    contact=Contact(
        normal=linear(damping=0.3), sliding=ViscousSliding(shear_friction=GRIP, shear_damping=dashpot(0.15))
    ),
)
ROLLING = LawCase(
    name="rolling spring",
    contact=Contact(
        normal=linear(damping=0.1), sliding=spring(damping=0.1),
        rolling=SpringRolling(rolling_friction=GRIP, rolling_stiffness=STIFFNESS, rolling_damping=0.0),
    ),
)
ROLLING_DASHPOT = LawCase(
    name="friction, rolling spring, dashpots",
    contact=Contact(
        normal=linear(damping=0.3), sliding=spring(damping=0.15),
        rolling=SpringRolling(rolling_friction=1.0, rolling_stiffness=STIFFNESS, rolling_damping=dashpot(1.0)),
    ),
)
"""So much of a dashpot that the talks' algorithm, which feels the spring late, has a stable step. LIGGGHTS takes
stiffnesses of k_n mu_r^2 and more only."""

TORSION = LawCase(
    name="torsion spring",
    contact=Contact(
        normal=linear(damping=0.1), sliding=spring(damping=0.1),
        torsion=SpringTorsion(torsion_friction=GRIP, torsion_stiffness=STIFFNESS, torsion_damping=0.0),
    ),
)
TORSION_DASHPOT = LawCase(
    name="friction, torsion spring, dashpots",
    contact=Contact(
        normal=linear(damping=0.3), sliding=spring(damping=0.15),
        torsion=SpringTorsion(torsion_friction=GRIP, torsion_stiffness=STIFFNESS, torsion_damping=dashpot(1.0)),
    ),
)
HERTZ = LawCase(name="hertz", contact=Contact(normal=hertz(1.0)))
MINDLIN = LawCase(
    name="hertz, mindlin", contact=Contact(normal=hertz(0.7), sliding=MindlinSliding(shear_friction=GRIP))
)
HYSTERETIC = LawCase(
    name="hysteretic", linear=False,
    contact=Contact(normal=HystereticNormal(
        loading_stiffness=STIFFNESS / 2, unloading_stiffness=STIFFNESS, adhesion_stiffness=0.0, normal_damping=0.0,
    )),
)

QUICK = (ELASTIC, DASHPOT, FRICTION, WEAK, FULL)
RARE = (VISCOUS, ROLLING, HERTZ, MINDLIN, HYSTERETIC)
WHOLE = (*QUICK, *RARE, ROLLING_DASHPOT, TORSION, TORSION_DASHPOT)
