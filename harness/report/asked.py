"""Small systems that engines are asked about, so that their support can be shown without a scene."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from harness.scene.contact import (
    Between,
    ConstantRolling,
    Contact,
    DmtNormal,
    HertzNormal,
    HystereticNormal,
    JkrNormal,
    LinearNormal,
    MindlinSliding,
    NormalNumbers,
    SpringRolling,
    SpringSliding,
    SpringTorsion,
    VariableHystereticNormal,
    ViscousSliding,
)
from harness.scene.materials import materials_of
from harness.scene.model import Background
from harness.scene.system import Constant, Cosine, Loaded, Particles, Ring, System, Wall

RADIUS, SIDE = 1e-3, 0.02
"""Of the two bodies and of the box, m."""


ELASTIC = {"youngs_modulus": 1e8, "poisson_ratio": 0.3}
STICKY = {**ELASTIC, "surface_energy": 0.05, "normal_damping": 0.01, "impact_speed": 0.1}
HYSTERETIC = {"loading_stiffness": 5e4, "adhesion_stiffness": 2e4, "normal_damping": 0.1}
LINEAR = LinearNormal(normal_stiffness=1e5, normal_damping=0.1, attraction="allowed")
HERTZ = HertzNormal(**ELASTIC, restitution=0.9, attraction="allowed", impact_speed=0.1)
SPRING = SpringSliding(shear_friction=0.5, shear_stiffness=2e4, shear_damping=0.025)

NORMALS = (
    LINEAR, HERTZ, HystereticNormal(**HYSTERETIC, unloading_stiffness=1e5),
    VariableHystereticNormal(**HYSTERETIC, largest_unloading_stiffness=1e5, plasticity_depth=0.05),
    DmtNormal(**STICKY), JkrNormal(**STICKY),
)
"""Each normal law, between smooth bodies."""

TURNING = (
    {"sliding": SPRING}, {"sliding": ViscousSliding(shear_friction=0.5, shear_damping=0.1)},
    {"sliding": SpringSliding(shear_friction=0.5, shear_stiffness=2e4, shear_damping=0.025, dynamic_friction=0.4)},
    {"sliding": MindlinSliding(shear_friction=0.5), "normal": HERTZ},
    {"sliding": SPRING, "rolling": SpringRolling(rolling_friction=0.1, rolling_stiffness=1e4, rolling_damping=0.01)},
    {"sliding": SPRING, "rolling": ConstantRolling(rolling_friction=0.1)},
)
"""Each law that turns particles, beside what it needs."""

TORSION = {
    "sliding": SPRING, "torsion": SpringTorsion(torsion_friction=0.1, torsion_stiffness=1e4, torsion_damping=0.01),
}
"""In space only."""


def ordinary_cases() -> tuple[System, ...]:
    """Return systems in which, together, every effect and every law is on, in 2D and 3D, with walls and without."""
    cases = []
    for dimension in (2, 3):
        for base in (walled(dimension), periodic(dimension)):
            cases += [base.with_(normal=law, sliding=None, walls=smooth(base.walls)) for law in NORMALS]
            cases += [base.with_(**laws) for laws in (*TURNING, *((TORSION,) if dimension == 3 else ()))]
            cases.append(of_materials(base))
    return (*cases, *(ringed().with_(**laws) for laws in ({"sliding": None}, *TURNING)))


def of_materials(system: System) -> System:
    """Return the system with a stiff and a soft body between stiff walls."""
    stiff = NormalNumbers(normal_stiffness=1e7, normal_damping=0.1)
    contact = Contact(normal=LINEAR, sliding=SPRING, between=(Between(materials=("stiff", "stiff"), normal=stiff),))
    words = ("stiff", "soft")
    return system.with_(
        particles=replace(system.particles, material=np.array(words)), materials=materials_of(contact, words),
        walls=tuple(replace(w, material="stiff") for w in system.walls),
    )


def smooth(walls: tuple[Wall, ...]) -> tuple[Wall, ...]:
    """Return the walls without friction."""
    return tuple(replace(w, friction=False) for w in walls)


def hard_cases() -> dict[str, System]:
    """Return systems that one engine or another cannot compute, by what is special about them."""
    return {
        "discs in 3D": _with_inertia(walled(3), 0.5),
        "rings": _with_inertia(walled(2), 1.0),
        "spheres among discs": _with_inertia(walled(2), np.array([0.4, 0.5])),
        "a plane across a periodic axis": walled(2).with_(periodic=(SIDE, 0.0)),
        "a period of two diameters": periodic(2).with_(periodic=(4 * RADIUS, SIDE)),
        "a sliding plane that touches at the start": _with_belt_at(walled(2), 5e-3 + 0.5 * RADIUS),
    }


def walled(dimension: int) -> System:
    """Two bodies between a rough floor, a rough lid with mass, a smooth piston and a sliding belt."""
    up, across = _axis(dimension, -1), _axis(dimension, 0)
    walls = (
        Wall(index=1, name="floor", point=_times(0.0, up), normal=up, friction=True),
        Wall(index=2, name="lid", point=_times(SIDE, up), normal=_times(-1.0, up), friction=True,
             motion=Loaded(mass=1.0, load=1.0, stress=0.0, span=None, damping=1.0)),
        Wall(index=3, name="piston", point=_times(0.0, across), normal=across, friction=False,
             motion=Cosine(travel=1e-4, duration=1e-2)),
        Wall(index=4, name="belt", point=_times(SIDE, across), normal=_times(-1.0, across), friction=True,
             motion=Constant(velocity=_times(1e-2, up))),
    )
    return System(
        dimension=dimension, particles=_two_bodies(dimension), walls=walls,
        normal=LINEAR, sliding=SPRING,
        background=Background(translational_drag=1e-3), gravity=_times(-9.81, up), periodic=None,
        dt=1e-7, steps=10, sample_every=10, frame_every=10, contacts=True,
    )


def periodic(dimension: int) -> System:
    """Two bodies and no wall, all axes periodic."""
    return walled(dimension).with_(walls=(), periodic=(SIDE,) * dimension)


def ringed() -> System:
    """Two bodies between a ring of six discs that turns and one that rests."""
    hexagon = np.exp(1j * np.pi / 3 * np.arange(6))
    rings = (
        Ring(
            index=k, name=name, centre=(5e-3, 5e-3), circle=r, omega=omega, radius=np.full(6, RADIUS),
            x=np.column_stack([5e-3 + r * hexagon.real, 5e-3 + r * hexagon.imag]),
        )
        for k, name, r, omega in ((1, "inner", 2.5e-3, 1.0), (2, "outer", SIDE, None))
    )
    return walled(2).with_(walls=(), rings=tuple(rings))


def _axis(dimension: int, index: int) -> tuple[float, ...]:
    return tuple(np.eye(dimension)[index].tolist())


def _times(factor: float, vector: tuple[float, ...]) -> tuple[float, ...]:
    return tuple(factor * c + 0.0 for c in vector)  # + 0.0 turns -0 into 0


def _two_bodies(dimension: int) -> Particles:
    x = np.full((2, dimension), 5e-3)
    x[1, 0] += 2.5 * RADIUS
    return Particles(
        x=x, radius=np.full(2, RADIUS), mass=np.full(2, 1e-5), v=np.zeros((2, dimension)),
        inertia_factor=np.full(2, 0.5 if dimension == 2 else 0.4), spin=np.zeros((2, 1 if dimension == 2 else 3)),
    )


def _with_inertia(system: System, factor: float | np.ndarray) -> System:
    return system.with_(particles=replace(system.particles, inertia_factor=np.full(2, factor)))


def _with_belt_at(system: System, place: float) -> System:
    """Return the system with its last wall moved to x = `place`, m."""
    belt = replace(system.walls[-1], point=(place, 0.0))
    return system.with_(walls=(*system.walls[:-1], belt))
