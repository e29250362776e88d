"""A contact solved phase by phase: against closed forms, conservation laws, and the kernel's limit."""

import math
from dataclasses import replace

import numpy as np
import pytest

from reference.analytic import pair_by_events
from reference.analytic.linear_collision import LinearCollision
from reference.analytic.oblique_impact import ObliqueImpact, sticking_of_springs
from reference.analytic.pair_by_events import Bodies, PairLaws, collide, without_friction
from reference.kernel.conventions import CORRECTED, LAMMPS, LIGGGHTS
from reference.kernel.laws.registry import build_law
from reference.kernel.model import Model
from reference.kernel.program.simulation import fastest

KN = 1e5
CLIPPED = PairLaws(normal_stiffness=KN, normal_damping=0.1, attraction="clipped", shear_friction=0.5,
                   shear_stiffness=2e4, shear_damping=0.025)
ARMS = {"talk": {}, "lammps": {"slip_arm": "radius", "base": "absolute"},
        "liggghts": {"base": "absolute", "tested": "spring"}}


def bodies(degrees=45.0, speed=0.3, spin=(0.0, 0.0), inertia=0.5) -> Bodies:
    """Unequal discs; the first flies along x and is hit at an angle from the line of centres."""
    radius, mass = np.array([1e-3, 1.2e-3]), np.array([1e-5, 1.6e-5])
    angle = math.radians(degrees)
    x = np.array([[0.0, 0.0], [(radius.sum() + 3e-6) * math.cos(angle), (radius.sum() + 3e-6) * math.sin(angle)]])
    return Bodies(x=x, v=np.array([[speed, 0.0], [0.0, 0.0]]), spin=np.array(spin), radius=radius, mass=mass,
                  inertia=inertia * mass * radius**2)


def normal_at_touch(b, parted):
    """From the second body to the first, when they meet."""
    x = b.x[0] - b.x[1] + parted.begin * (b.v[0] - b.v[1])
    return x / np.linalg.norm(x)


def reduced_mass(b):
    return float(b.mass.prod() / b.mass.sum())


@pytest.mark.parametrize("attraction", ["allowed", "clipped"])
def test_restitution_and_duration_are_the_closed_forms(attraction):
    b = bodies(degrees=0.0)
    laws = replace(without_friction(CLIPPED), attraction=attraction, normal_damping=0.4)
    closed = LinearCollision(stiffness=KN, damping=0.4, reduced_mass=reduced_mass(b))
    parted = collide(b, laws)
    assert (parted.v[1, 0] - parted.v[0, 0]) / 0.3 == pytest.approx(closed.restitution(attraction), rel=1e-10)
    assert parted.phases == ("smooth",)
    assert parted.begin == pytest.approx(3e-6 / 0.3, rel=1e-9)


@pytest.mark.parametrize("degrees", [30.0, 60.0])
@pytest.mark.parametrize("name", ARMS)
def test_momentum_is_kept_and_one_force_turns_both(name, degrees):
    """The arms are R - delta/2 of both bodies, so that the impulses of the torques over R agree up to delta/R."""
    b = bodies(degrees, spin=(100.0, -50.0))
    parted = collide(b, replace(CLIPPED, **ARMS[name]))
    assert b.mass @ parted.v == pytest.approx(b.mass @ b.v, abs=1e-17)
    impulses = b.inertia * (parted.spin - b.spin) / b.radius
    assert impulses[0] == pytest.approx(impulses[1], rel=2e-3)
    assert abs(impulses[0]) > 1e-8


def test_gross_sliding_tends_to_the_rigid_impact():
    """The closed form is for overlaps that are small against R: its error falls with the speed."""
    closed = ObliqueImpact(inertia_factor=0.5, friction=0.1, restitution=1.0)
    off = []
    for speed in (0.3, 0.03):
        b = bodies(60.0, speed)
        laws = replace(CLIPPED, normal_damping=0.0, shear_damping=0.0, shear_friction=0.1, shear_stiffness=1e5)
        parted = collide(b, laws)
        assert parted.phases == ("slide -",)
        n = normal_at_touch(b, parted)
        kick = closed.kick(normal=abs(speed * n[0]), slip=abs(speed * n[1]))
        turned = kick * reduced_mass(b) / (b.mass * 0.5 * b.radius)
        off.append(np.abs(np.abs(parted.spin / turned) - 1.0).max())
    assert off[0] < 1e-2
    assert off[1] < off[0] / 5


def test_sticking_almost_without_limit_tends_to_the_closed_form():
    """Measured: 6e-5 off, of the last thousandth of the contact, which slides, and of d/R."""
    b = bodies(45.0, 0.003)
    laws = replace(CLIPPED, normal_damping=0.0, shear_damping=0.0, shear_friction=1e3)
    parted = collide(b, laws)
    n = normal_at_touch(b, parted)
    t = np.array([-n[1], n[0]])
    slip = (parted.v[0] - parted.v[1]) @ t - b.radius @ parted.spin
    before = b.v[0] @ t
    expected = sticking_of_springs(shear_to_normal_stiffness=0.2, inertia_factor=0.5)
    assert -slip / before == pytest.approx(expected, abs=3e-4)


def kernel_exit(b, laws, convention, steps):
    normal = build_law("normal", {"law": "linear", "normal_stiffness": KN, "normal_damping": laws.normal_damping,
                                  "attraction": laws.attraction}, convention, None)
    sliding = build_law("sliding", {"law": "spring", "shear_friction": laws.shear_friction,
                                    "shear_stiffness": laws.shear_stiffness, "shear_damping": laws.shear_damping},
                        convention, normal)
    contact_time = math.pi * math.sqrt(reduced_mass(b) / KN)
    m = Model(x=b.x.T.copy(), v=b.v.T.copy(), spin=b.spin[None].copy(), radius=b.radius, mass=b.mass, inertia=b.inertia,
              walls=(), normal=normal, sliding=sliding, convention=convention, dt=contact_time / steps)
    simulation = fastest(m)
    simulation.advance(3 * steps)
    return simulation.state.v.T, simulation.state.spin[0]


@pytest.mark.parametrize(("name", "own", "bound"), [("talk", CORRECTED, 2e-7), ("lammps", LAMMPS, 2e-7),
                                                    ("liggghts", LIGGGHTS, 4e-5)])
def test_the_kernel_tends_to_it_in_every_convention(name, own, bound):
    """Two evaluations that share no step; LIGGGHTS' springs turn without rescaling, which leaves first order."""
    b, laws = bodies(45.0, spin=(80.0, 0.0)), replace(CLIPPED, **ARMS[name])
    exact, errors = collide(b, laws), []
    for steps in (500, 2000):
        v, spin = kernel_exit(b, laws, replace(own, scheme="corrected"), steps)
        errors.append(max(np.abs(v - exact.v).max(), 1e-3 * np.abs(spin - exact.spin).max()) / 0.3)
    assert errors[1] < bound
    assert errors[1] < errors[0]


@pytest.mark.parametrize("degrees", [20.0, 45.0, 66.0])
@pytest.mark.parametrize("attraction", ["allowed", "clipped"])
@pytest.mark.parametrize("name", ARMS)
def test_the_answer_does_not_hang_on_the_tolerance(monkeypatch, name, attraction, degrees):
    b, laws = bodies(degrees, spin=(30.0, -10.0)), replace(CLIPPED, attraction=attraction, **ARMS[name])
    exact = collide(b, laws)
    monkeypatch.setattr(pair_by_events, "RELATIVE", 1e-10)
    monkeypatch.setattr(pair_by_events, "STEPS_A_CONTACT", 300.0)
    coarse = collide(b, laws)
    assert coarse.phases == exact.phases
    assert np.abs(coarse.v - exact.v).max() < 1e-9 * 0.3
    assert 1e-3 * np.abs(coarse.spin - exact.spin).max() < 1e-9 * 0.3


def test_bodies_that_do_not_meet_are_refused():
    b = bodies()
    for wrong in (replace(b, v=-b.v), replace(b, x=0.5 * b.x)):
        with pytest.raises(ValueError, match="apart and meet"):
            collide(wrong, CLIPPED)
