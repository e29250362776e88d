"""The closed forms against the integrated equation of motion, published spheres, and measured engines."""

import math

import numpy as np
import pytest

from reference.analytic.hertz_collision import (
    HertzCollision,
    damping_factor_for_restitution,
    effective_modulus,
    effective_radius,
    hertz_stiffness,
    restitution_under_tsuji,
    tsuji_damping_factor,
)

SPEED = 0.3
FACTORS = [0.0, 0.02, 0.3, 0.9, 1.5, 2.0]
"""alpha; sqrt(5) = 2.236 is critical."""


def collision(alpha):
    """k and m* of a real pair, so that a wrong unit shows."""
    return HertzCollision(stiffness=3.1e9, reduced_mass=4.2e-6, damping_factor=alpha)


def scales(pair):
    """Length and time in which k = m* = v = 1."""
    length = (pair.reduced_mass * SPEED**2 / pair.stiffness) ** 0.4
    return length, length / SPEED


def motion(alpha):
    """Rates in those units."""

    def rates(t, y):
        d = max(y[0], 0.0)
        return [y[1], -(d**1.5) - alpha * d**0.25 * y[1]]

    return rates


@pytest.mark.parametrize("alpha", FACTORS)
def test_largest_overlap(alpha, integrate_until):
    pair = collision(alpha)
    length, _ = scales(pair)
    _, (overlap, _) = integrate_until(motion(alpha), [0.0, 1.0], lambda t, y: y[1], span=20)
    assert pair.largest_overlap(SPEED) == pytest.approx(overlap * length, rel=1e-9)
    assert pair.force_at_largest_overlap(SPEED) == pytest.approx(3.1e9 * (overlap * length) ** 1.5, rel=1e-9)
    assert pair.force(overlap * length, 0.0) == pytest.approx(pair.force_at_largest_overlap(SPEED), rel=1e-9)


@pytest.mark.parametrize("alpha", FACTORS)
def test_until_the_overlap_is_gone(alpha, integrate_until):
    pair = collision(alpha)
    time, (_, rate) = integrate_until(motion(alpha), [0.0, 1.0], lambda t, y: y[0], span=40, direction=-1)
    assert pair.restitution("allowed") == pytest.approx(-rate, rel=2e-9, abs=1e-12)
    assert pair.duration(SPEED) == pytest.approx(time * scales(pair)[1], rel=2e-9)


@pytest.mark.parametrize("alpha", [*FACTORS[1:], math.sqrt(5), 4.0])
def test_until_the_force_is_gone(alpha, integrate_until):
    """The clipped restitution is that of the linear oscillator too, also beyond the critical damping."""

    def force(t, y):
        return y[0] ** 1.25 + alpha * y[1]

    _, (overlap, rate) = integrate_until(motion(alpha), [0.0, 1.0], force, span=60, direction=-1)
    pair = collision(alpha)
    length, _ = scales(pair)
    assert pair.restitution("clipped") == pytest.approx(-rate, rel=1e-9)
    assert pair.force(overlap * length, rate * SPEED) == pytest.approx(0, abs=1e-9 * pair.force(overlap * length, 0))


def test_elastic_constants():
    """2.943 d_max/v and 2.868 (m*^2/(R* E*^2 v))^(1/5), the two forms in use, and d_max with E* and R*."""
    modulus, radius, mass = 25e9, 0.005, 5.9e-3
    pair = HertzCollision(
        stiffness=hertz_stiffness(effective_modulus=modulus, effective_radius=radius), reduced_mass=mass
    )
    overlap = (15 * mass * SPEED**2 / (16 * modulus * math.sqrt(radius))) ** 0.4
    exact = 4 * math.sqrt(math.pi) * math.gamma(0.4) / (5 * math.gamma(0.9))
    assert exact == pytest.approx(2.943275184, rel=1e-9)
    assert pair.largest_overlap(SPEED) == pytest.approx(overlap, rel=1e-13)
    assert pair.duration(SPEED) == pytest.approx(exact * overlap / SPEED, rel=1e-13)
    assert pair.duration(SPEED) == pytest.approx(
        2.868265699 * (mass**2 / (radius * modulus**2 * SPEED)) ** 0.2, rel=1e-9
    )
    assert pair.restitution("allowed") == 1.0


@pytest.mark.parametrize(
    ("young", "poisson", "radius", "density", "speed", "overlap", "force", "time"),
    [
        (48e9, 0.20, 0.010, 2800, 20.0, 274.1e-6, 10.697e3, 40.34e-6),
        (20e9, 0.25, 0.010, 2500, 20.0, 368.3e-6, 7.108e3, 54.2e-6),
    ],
)
def test_equal_spheres(young, poisson, radius, density, speed, overlap, force, time):
    """The glass and limestone spheres of Chung and Ooi (Granular Matter 13, 643, 2011), test 1."""
    pair = HertzCollision(
        stiffness=hertz_stiffness(
            effective_modulus=effective_modulus(young=(young, young), poisson=(poisson, poisson)),
            effective_radius=effective_radius(radius, radius),
        ),
        reduced_mass=2 / 3 * math.pi * radius**3 * density,
    )
    assert pair.largest_overlap(speed) == pytest.approx(overlap, rel=3e-4)
    assert pair.force_at_largest_overlap(speed) == pytest.approx(force, rel=3e-4)
    assert pair.duration(speed) == pytest.approx(time, rel=1e-3)


def test_sphere_on_rigid_plane():
    """The aluminium sphere of the same authors, test 2: 49.72 um, 11.370 kN, 731.7 us."""
    pair = HertzCollision(
        stiffness=hertz_stiffness(
            effective_modulus=effective_modulus(young=(70e9, math.inf), poisson=(0.3, 0.3)),
            effective_radius=effective_radius(0.1),
        ),
        reduced_mass=4 / 3 * math.pi * 0.1**3 * 2699,
    )
    assert pair.largest_overlap(0.2) == pytest.approx(49.72e-6, rel=1e-3)
    assert pair.force_at_largest_overlap(0.2) == pytest.approx(11.370e3, rel=1e-3)
    assert pair.duration(0.2) == pytest.approx(731.7e-6, rel=1e-3)


@pytest.mark.parametrize("restitution", [1.0, 0.9, 0.5, 0.01])
def test_damping_factor_inverts(restitution):
    pair = collision(damping_factor_for_restitution(restitution))
    assert pair.restitution("allowed") == pytest.approx(restitution, rel=1e-12)


@pytest.mark.parametrize("restitution", [0.0, -0.1, 1.1, math.nan])
def test_impossible_restitution(restitution):
    with pytest.raises(ValueError, match="restitution must lie in"):
        damping_factor_for_restitution(restitution)


@pytest.mark.parametrize(("asked", "measured"), [(0.9, 0.928356), (0.5, 0.616074)])
def test_tsuji_as_measured(asked, measured):
    """LAMMPS 22 Jul 2025, hertz/material with damping tsuji, two equal spheres head-on."""
    assert restitution_under_tsuji(asked) == pytest.approx(measured, abs=3e-6)


def test_tsuji_is_off_by_the_square_root_of_two():
    for asked in np.linspace(0.1, 0.9, 9):
        ratio = damping_factor_for_restitution(asked) / tsuji_damping_factor(asked)
        assert ratio == pytest.approx(math.sqrt(2), rel=0.01)


@pytest.mark.parametrize("asked", [-0.1, 1.1, math.nan])
def test_tsuji_outside_its_range(asked):
    with pytest.raises(ValueError, match="restitution must lie in"):
        restitution_under_tsuji(asked)


def test_overdamped_pair_never_parts():
    pair = collision(2.3)
    assert pair.damping_ratio > 1
    assert pair.restitution("allowed") == 0.0
    assert pair.duration(SPEED) == math.inf
