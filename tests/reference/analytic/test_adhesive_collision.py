"""DMT and JKR against integration of the equation of motion, the literature's numbers, and their limits."""

import math

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

from reference.analytic.adhesive_collision import DmtCollision, JkrCollision
from reference.analytic.hertz_collision import HertzCollision, hertz_stiffness

SOFT = {"effective_modulus": 2e6, "effective_radius": 0.7e-3, "reduced_mass": 3e-6, "surface_energy": 0.02}
STIFF = {"effective_modulus": 5e9, "effective_radius": 2e-3, "reduced_mass": 8e-5, "surface_energy": 0.2}
TORN = 1 - 1e-9
"""Of the tearing overlap: there the contact radius still follows from the overlap."""
PAIRS = pytest.mark.parametrize("numbers", [SOFT, STIFF], ids=["soft", "stiff"])


def flown(pair, speed, force, start, end):
    """Integrate m* d'' = -force(d) until the overlap falls to `end`, or turns round three times: all states."""
    def leaves(t, y):
        return y[0] - end

    leaves.terminal, leaves.direction = True, -1

    def turns(t, y):
        return y[1]

    turns.terminal = 3
    unit = start / speed
    return solve_ivp(
        lambda t, y: [y[1], -force(y[0]) / pair.reduced_mass], (0, 1e6 * unit), [0.0, speed],
        events=[leaves, turns], rtol=1e-11, atol=1e-18, max_step=unit,
    )


def radius_of(pair, overlap):
    """Contact radius of a JKR contact on its stable branch."""
    stable = max(overlap, TORN * pair.tearing_overlap)
    return brentq(lambda a: pair.overlap(a) - stable, pair.tearing_radius, 1e3 * pair.touching_radius, xtol=1e-20)


@PAIRS
@pytest.mark.parametrize("speed", [0.02, 1.0])
def test_dmt_motion(numbers, speed):
    pair = DmtCollision(**numbers)
    k = hertz_stiffness(effective_modulus=pair.effective_modulus, effective_radius=pair.effective_radius)

    def force(d):
        return k * max(d, 0.0) ** 1.5 - pair.pull_off_force

    path = flown(pair, speed, force, pair.largest_overlap(speed) / 50, 0.0)
    assert path.y[0].max() <= pair.largest_overlap(speed) * (1 + 1e-9)
    top = path.y_events[1][0]
    assert top[0] == pytest.approx(pair.largest_overlap(speed), rel=1e-8)
    assert -path.y_events[0][0][1] == pytest.approx(speed, rel=1e-6)


@PAIRS
@pytest.mark.parametrize("factor", [1.05, 1.5, 20.0])
def test_jkr_motion(numbers, factor):
    """From touch at d = 0 until the surfaces tear."""
    pair = JkrCollision(**numbers)
    speed = factor * pair.sticking_speed
    path = flown(pair, speed, lambda d: pair.force(radius_of(pair, d)), pair.largest_overlap(speed) / 20,
                 TORN * pair.tearing_overlap)
    assert path.y_events[1][0][0] == pytest.approx(pair.largest_overlap(speed), rel=1e-7)
    assert -path.y_events[0][0][1] / speed == pytest.approx(pair.restitution(speed), rel=1e-4)


@PAIRS
def test_jkr_sticks_below_its_sticking_speed(numbers):
    pair = JkrCollision(**numbers)
    assert pair.restitution(pair.sticking_speed) == 0.0
    assert pair.restitution(0.5 * pair.sticking_speed) == 0.0
    assert pair.restitution(1.0001 * pair.sticking_speed) > 0.0


@PAIRS
def test_jkr_loses_what_thornton_and_ning_give(numbers):
    pair = JkrCollision(**numbers)
    gamma = 2 * pair.surface_energy
    known = (gamma**5 * pair.effective_radius**4 / pair.effective_modulus**2) ** (1 / 3)
    assert pair.energy_lost / known == pytest.approx(7.09, abs=5e-3)
    assert pair.energy_lost == pytest.approx(
        pair.energy(pair.tearing_radius) - pair.energy(pair.touching_radius), rel=1e-12
    )


@PAIRS
def test_jkr_curve(numbers):
    """Energy and stiffness are integral and slope of the force; the largest attraction is the pull-off force."""
    pair = JkrCollision(**numbers)
    a = np.linspace(0.2, 4, 4001) * pair.touching_radius
    d, f, u = (np.array([law(x) for x in a]) for law in (pair.overlap, pair.force, pair.energy))
    work = np.concatenate([[0.0], np.cumsum((f[1:] + f[:-1]) / 2 * np.diff(d))])
    assert work == pytest.approx(u - u[0], abs=2e-6 * abs(u).max())
    assert -f.min() == pytest.approx(pair.pull_off_force, rel=1e-6)
    assert d.min() == pytest.approx(pair.tearing_overlap, rel=1e-6)
    assert pair.overlap(pair.touching_radius) == pytest.approx(0.0, abs=1e-12 * pair.touching_radius)
    inner = a > 2 * pair.touching_radius
    slopes = np.gradient(f, d)[inner][1:-1]
    assert slopes == pytest.approx([pair.stiffness(x) for x in a[inner][1:-1]], rel=1e-4)


@pytest.mark.parametrize("kind", [DmtCollision, JkrCollision])
def test_without_surface_energy_it_is_hertz(kind):
    numbers = STIFF | {"surface_energy": 1e-12}
    pair = kind(**numbers)
    k = hertz_stiffness(effective_modulus=pair.effective_modulus, effective_radius=pair.effective_radius)
    hertz = HertzCollision(stiffness=k, reduced_mass=pair.reduced_mass)
    depth = hertz.largest_overlap(1.0)
    assert pair.largest_overlap(1.0) == pytest.approx(depth, rel=1e-5)
    argument = depth if kind is DmtCollision else pair.largest_radius(1.0)
    assert pair.stiffness(argument) == pytest.approx(1.5 * k * math.sqrt(depth), rel=1e-5)


@pytest.mark.parametrize("kind", [DmtCollision, JkrCollision])
@pytest.mark.parametrize("speed", [1e-9, 1e-3, 1e3])
def test_roots_are_found_whatever_prevails(kind, speed):
    """Adhesion alone, both, motion alone: at the largest overlap the energy is used up."""
    pair = kind(**SOFT)
    depth = pair.largest_overlap(speed)
    if kind is DmtCollision:
        k = hertz_stiffness(effective_modulus=pair.effective_modulus, effective_radius=pair.effective_radius)
        left = 0.4 * k * depth**2.5 - pair.pull_off_force * depth - pair.energy_in(speed)
        size = 0.4 * k * depth**2.5
    else:
        radius = pair.largest_radius(speed)
        left = pair.energy(radius) - pair.energy(pair.touching_radius) - pair.energy_in(speed)
        size = abs(pair.energy(radius)) + abs(pair.energy(pair.touching_radius))
    assert abs(left) < 1e-12 * size
