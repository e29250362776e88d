"""What is timed: one line a case. A case that the kernel's program cannot compose yet is left out, and said so."""

from __future__ import annotations

from dataclasses import dataclass

from harness.scene.contact import (
    HystereticNormal,
    LinearNormal,
    NormalLaw,
    RollingLaw,
    SlidingLaw,
    SpringRolling,
    SpringSliding,
)
from harness.scene.model import Background
from reference.analytic.linear_collision import damping_for_restitution

STIFFNESS, MASS, MEAN_RADIUS = 1e5, 8e-6, 1e-3
"""k_n in N/m, of every particle in kg, in m. One mass, because not every code has
a dashpot that does not depend on it."""

RESTITUTION, FRICTION = 0.8, 0.5

QUIET_SPEED, FAST_SPEED = 0.005, 1.0
"""Of the random velocities that particles start with, m/s rms a component. A dense packing at the lower one swings
by a hundredth of the mean overlap and keeps its list of pairs (at four times that, elastic ones shake themselves loose
within 5000 steps); at the higher one lists are renewed all the time."""

SKIN, FAST_SKIN = 0.05, 0.2
"""How far beyond contact pairs are listed, for every code alike, in mean radii."""


GAMMA = damping_for_restitution(RESTITUTION, stiffness=STIFFNESS, reduced_mass=0.5 * MASS)
"""gamma_n, kg/s."""

ELASTIC = LinearNormal(normal_stiffness=STIFFNESS, normal_damping=0.0, attraction="allowed")
DASHPOT = LinearNormal(normal_stiffness=STIFFNESS, normal_damping=GAMMA, attraction="allowed")
ADHESIVE = HystereticNormal(
    loading_stiffness=STIFFNESS, unloading_stiffness=5 * STIFFNESS, adhesion_stiffness=STIFFNESS, normal_damping=GAMMA
)
SLIDING = SpringSliding(
    shear_friction=FRICTION, shear_stiffness=2.0 / 7.0 * STIFFNESS, shear_damping=0.5 * GAMMA
)
ROLLING = SpringRolling(
    rolling_friction=0.1, rolling_stiffness=2.0 / 7.0 * STIFFNESS, rolling_damping=0.5 * GAMMA
)
DRAG = Background(translational_drag=0.01 * GAMMA)


@dataclass(frozen=True, kw_only=True)
class Case:
    """One set of effects, and the particle numbers at which it is timed.

    walls: a box of four or six planes with the particles' own law; else all axes are periodic. base: the case
    that this one has one effect more (or other) than; the kernel's time is compared with its time there.
    """

    name: str
    dimension: int
    normal: NormalLaw
    sliding: SlidingLaw | None = None
    rolling: RollingLaw | None = None
    background: Background | None = None
    gravity: float = 0.0
    walls: bool = True
    speed: float = QUIET_SPEED
    skin: float = SKIN
    base: str | None = None
    quick: tuple[int, ...] = ()
    full: tuple[int, ...] = ()


WIDE = (100, 200, 500, 1000, 2000, 6000, 10_000, 20_000, 50_000, 100_000)
FEW = (200, 2000, 20_000)
ONE = (2000,)

CASES: tuple[Case, ...] = (
    Case(name="2D elastic", dimension=2, normal=ELASTIC, quick=(2000, 20_000), full=WIDE),
    Case(name="2D dashpot", dimension=2, normal=DASHPOT, base="2D elastic", quick=FEW, full=WIDE),
    Case(name="2D friction", dimension=2, normal=DASHPOT, sliding=SLIDING, base="2D dashpot",
         quick=(100, 200, 1000, 2000, 6000, 20_000), full=WIDE),
    Case(name="2D friction, adhesive", dimension=2, normal=ADHESIVE, sliding=SLIDING, base="2D friction",
         quick=ONE, full=FEW),
    Case(name="2D friction, rolling", dimension=2, normal=DASHPOT, sliding=SLIDING, rolling=ROLLING,
         base="2D friction", quick=ONE, full=FEW),
    Case(name="2D friction, drag", dimension=2, normal=DASHPOT, sliding=SLIDING, background=DRAG,
         base="2D friction", full=FEW),
    Case(name="2D friction, gravity", dimension=2, normal=DASHPOT, sliding=SLIDING, gravity=9.81,
         base="2D friction", full=FEW),
    Case(name="2D friction, periodic", dimension=2, normal=DASHPOT, sliding=SLIDING, walls=False,
         base="2D friction", quick=ONE, full=FEW),
    Case(name="2D elastic, fast", dimension=2, normal=ELASTIC, speed=FAST_SPEED, skin=FAST_SKIN,
         base="2D elastic", quick=ONE, full=FEW),
    Case(name="3D dashpot", dimension=3, normal=DASHPOT, quick=ONE, full=(200, 1000, *FEW[1:])),
    Case(name="3D friction", dimension=3, normal=DASHPOT, sliding=SLIDING, base="3D dashpot",
         quick=ONE, full=(200, 1000, *FEW[1:])),
)


def find_case(name: str) -> Case:
    """Return the case of this name; raises KeyError."""
    return {c.name: c for c in CASES}[name]
