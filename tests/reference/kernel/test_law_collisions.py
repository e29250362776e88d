"""Head-on collisions of all normal laws against closed forms, and orders of convergence.

Measured rms errors of the restitution over 64 random masses, radii and phases of contact, at 50 and 400 steps in the
time unit, and orders between them: Hertz elastic 4e-6, 2e-8, 2.5; e = 0.9 2e-4, 1e-5, 1.2; e = 0.5 1e-3, 1e-4, 1.1;
clipped 9e-4, 9e-5, 1.05; plastic 1.2e-4, 2e-6, 2.0; with adhesion 1.9; with growing k_2 2.0.
"""

import math

import numpy as np
import pytest

from reference.analytic.hertz_collision import HertzCollision, damping_factor_for_restitution, hertz_stiffness
from reference.analytic.hysteretic_collision import ConstantUnloading, OverlapUnloading

PAIRS = 64
LADDER = (50, 100, 200, 400)
"""Steps in the time unit of the conftest; masses, radii and phases of contact differ from pair to pair."""


def draw(seed=0):
    rng = np.random.default_rng(seed)
    mass, radius = rng.uniform(0.5, 2.0, (2, PAIRS)), rng.uniform(0.5, 1.0, (2, PAIRS))
    speed, gap = rng.uniform(1.0, 2.0, PAIRS), rng.uniform(0.0, 0.02, PAIRS)
    return mass, radius, speed, gap


def collide(dem, normal, resolution, periods=4.0):
    """Let pairs collide along x in 3D; return restitution (0 while in contact), largest overlap, duration of each."""
    mass, radius, speed, gap = draw()
    reduced = mass.prod(axis=0) / mass.sum(axis=0)
    first = np.zeros((PAIRS, 3))
    first[:, 1] = 10.0 * np.arange(PAIRS)
    second = first.copy()
    second[:, 0] = radius.sum(axis=0) + gap
    v = np.zeros((2, PAIRS, 3))
    v[:, :, 0] = reduced * speed * np.array([[1.0], [-1.0]]) / mass
    m = dem.model(np.vstack([first, second]), v=v.reshape(-1, 3), radius=radius.ravel(), mass=mass.ravel(),
                  normal=normal, dt=dem.tc / resolution)
    s, deepest = dem.Simulation(m), np.zeros(PAIRS)
    for _ in range(int(periods * resolution)):
        s.advance()
        contact = s.interactions[0].last.contact
        deepest[contact.i] = np.maximum(deepest[contact.i], contact.overlap)
    apart = s.state.v[0, PAIRS:] - s.state.v[0, :PAIRS]
    now = s.state.x[0, PAIRS:] - s.state.x[0, :PAIRS] - radius.sum(axis=0)
    duration = s.state.step * m.dt - gap / speed - now / apart  # free flight traced back to overlap 0 on both sides
    return np.where(now > 0.0, apart / speed, 0.0), deepest, duration


def rms(errors) -> float:
    return math.sqrt(np.mean(np.square(errors)))


def order(dem, normal, expected, ladder=LADDER, **options):
    """Slope of the rms error of the restitution over the ladder, and the error on its last rung."""
    errors = [rms(collide(dem, normal, n, **options)[0] - expected) for n in ladder]
    return -np.polyfit(np.log(ladder), np.log(errors), 1)[0], errors[-1]


def hertz_pairs(restitution):
    mass, radius, speed, _ = draw()
    reduced, a = (q.prod(axis=0) / q.sum(axis=0) for q in (mass, radius))
    damping = damping_factor_for_restitution(restitution)
    stiffness = [hertz_stiffness(effective_modulus=3e4 / 2 / 0.91, effective_radius=r) for r in a]
    return [(HertzCollision(stiffness=k, reduced_mass=m, damping_factor=damping), v)
            for k, m, v in zip(stiffness, reduced, speed, strict=True)]


def test_elastic_hertz(dem):
    """Order 2; depth and duration of the closed form."""
    normal = dem.table("normal", "hertz", restitution=1.0)
    slope, error = order(dem, normal, 1.0, periods=8.0)
    assert 1.8 < slope < 3.0
    assert error < 1e-7
    _, deepest, duration = collide(dem, normal, 400, periods=8.0)
    closed = hertz_pairs(1.0)
    np.testing.assert_allclose(deepest, [c.largest_overlap(v) for c, v in closed], rtol=1e-4)
    np.testing.assert_allclose(duration, [c.duration(v) for c, v in closed], rtol=1e-4)


@pytest.mark.parametrize("restitution", [0.9, 0.5])
def test_damped_hertz_has_the_restitution_asked_for(dem, restitution):
    """At all masses, radii and speeds. Order 1: the dashpot sees the velocity of the half step."""
    normal = dem.table("normal", "hertz", restitution=restitution)
    slope, error = order(dem, normal, restitution, periods=8.0)
    assert 0.9 < slope < 1.4
    assert error < 2e-4


def test_clipped_hertz_has_that_of_a_contact_that_ends_in_force(dem):
    expected = hertz_pairs(0.5)[0][0].restitution("clipped")
    normal = dem.table("normal", "hertz", restitution=0.5, attraction="clipped")
    slope, error = order(dem, normal, expected, periods=8.0)
    assert 0.9 < slope < 1.2
    assert error < 2e-4
    assert expected == pytest.approx(0.5503, abs=1e-4)


@pytest.mark.parametrize("adhesion", [0.0, 600.0])
def test_plastic_contacts(dem, adhesion):
    """e^2 = k_1/k_2 - (k_c/k_1)(k_2 - k_1)^2/(k_2 (k_2 + k_c)) at all masses and speeds."""
    closed = [ConstantUnloading(loading=4e3, unloading=1e4, adhesion=adhesion, reduced_mass=m)
              for m in reduced_masses()]
    normal = dem.table("normal", "hysteretic", adhesion_stiffness=adhesion, normal_damping=0.0)
    slope, error = order(dem, normal, closed[0].restitution, periods=8.0)
    assert 1.6 < slope < 2.4
    assert error < 5e-6
    _, deepest, duration = collide(dem, normal, 400, periods=8.0)
    depth = [c.largest_overlap(v) for c, v in zip(closed, draw()[2], strict=True)]
    np.testing.assert_allclose(deepest, depth, rtol=1e-4)
    np.testing.assert_allclose(duration, [c.duration for c in closed], rtol=1e-4)


def test_plastic_contacts_that_stick(dem):
    """Beyond k_c = k_1^2/(k_2 - 2 k_1) no pair comes apart."""
    closed = ConstantUnloading(loading=4e3, unloading=1e4, adhesion=0.0, reduced_mass=1.0)
    normal = dem.table("normal", "hysteretic", adhesion_stiffness=1.05 * closed.sticking_adhesion, normal_damping=0.0)
    assert not collide(dem, normal, 100, periods=12.0)[0].any()
    looser = dem.table("normal", "hysteretic", adhesion_stiffness=0.9 * closed.sticking_adhesion, normal_damping=0.0)
    assert (collide(dem, looser, 100, periods=12.0)[0] > 0.1).all()


def test_plastic_contacts_that_get_stiffer(dem):
    """Restitution falls with the speed, as k_2 of the largest overlap says, below and beyond the limit."""
    numbers = {"adhesion_stiffness": 200.0, "plasticity_depth": 0.02, "normal_damping": 0.0}
    _, radius, speed, _ = draw()
    pair_radius = 2.0 * radius.prod(axis=0) / radius.sum(axis=0)
    closed = [OverlapUnloading(loading=4e3, limit=1.2e4, adhesion=200.0, plasticity_depth=0.02, pair_radius=r,
                               reduced_mass=m) for r, m in zip(pair_radius, reduced_masses(), strict=True)]
    expected = np.array([c.restitution(v) for c, v in zip(closed, speed, strict=True)])
    assert expected.min() > 0.2
    beyond = speed > [c.limit_speed for c in closed]
    assert 5 < beyond.sum() < PAIRS - 5
    slope, error = order(dem, dem.table("normal", "hysteretic_variable", **numbers), expected, periods=8.0)
    assert 1.6 < slope < 2.4
    assert error < 5e-6


def reduced_masses():
    mass = draw()[0]
    return mass.prod(axis=0) / mass.sum(axis=0)
