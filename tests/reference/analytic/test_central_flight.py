"""Flights of pairs: conserved quantities, exact answers, and the equation of motion integrated."""

import math

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from reference.analytic.adhesive_collision import JkrCollision
from reference.analytic.central_flight import JkrGrip, flight
from reference.analytic.prescribed import ElasticPair, jkr_force, jkr_overlap_of_largest_pull

RADII, MASSES = (2.0**-10, 1.25 * 2.0**-10), np.array([2.0**-14, 1.75 * 2.0**-14])
REACH, REDUCED = sum(RADII), MASSES.prod() / MASSES.sum()
STIFFNESS = 1e5
CONTACT_TIME = math.pi * math.sqrt(REDUCED / STIFFNESS)
PAIR = ElasticPair(
    youngs_modulus=1e8, poisson_ratio=0.25, effective_radius=RADII[0] * RADII[1] / REACH
)
ENERGY = 5.0


def elastic(overlap, separation):
    del separation
    return STIFFNESS * np.maximum(overlap, 0.0)


def oblique():
    """Three pairs, the first head-on; (3, 2, 3) each."""
    rng = np.random.default_rng(5)
    n = np.vstack([[1.0, 0.0, 0.0], rng.normal(size=(2, 3))])
    n /= np.linalg.norm(n, axis=1, keepdims=True)
    across = np.cross(n, rng.normal(size=(3, 3))) * np.array([0.0, 0.2, 0.3])[:, None]
    drift = rng.uniform(-0.1, 0.1, (3, 3)) * np.array([0.0, 1.0, 1.0])[:, None]
    x = np.stack([(REACH + 1e-6) * n, np.zeros((3, 3))], axis=1)
    relative = -0.5 * n + across
    share = MASSES[::-1] / MASSES.sum()
    return x, np.stack([drift + share[0] * relative, drift - share[1] * relative], axis=1)


def fly(force, dt, *, time=3 * CONTACT_TIME):
    steps = round(time / dt)
    return flight(*oblique(), mass=MASSES, reach=REACH, force=force, dt=dt, steps=steps, every=steps)


def test_momentum_angular_momentum_and_energy_are_kept():
    x, v = fly(elastic, CONTACT_TIME / 500)
    m = MASSES[:, None]
    momentum, spin = (m * v).sum(axis=2), np.cross(x, m * v).sum(axis=2)
    assert momentum[-1] == pytest.approx(momentum[0], abs=1e-18)
    assert spin[-1] == pytest.approx(spin[0], abs=1e-20)
    energy = 0.5 * (m * v**2).sum(axis=(2, 3))
    assert energy[-1] == pytest.approx(energy[0], rel=1e-4)
    assert np.abs(v[-1] - v[0]).max() > 0.1


def test_a_head_on_impact_swaps_the_relative_velocity():
    _, v = fly(elastic, CONTACT_TIME / 2000)
    before, after = (v[k, 0, 0] - v[k, 0, 1] for k in (0, -1))
    assert after == pytest.approx(-before, abs=2e-5)


def test_the_step_is_of_second_order():
    """Of a force that begins smoothly: the beginning of a contact is on no step's grid."""
    def smooth(overlap, separation):
        return elastic(overlap, separation) * np.maximum(overlap, 0.0) / 1e-5

    velocities = [fly(smooth, CONTACT_TIME / n, time=0.7 * CONTACT_TIME)[1][-1] for n in (3200, 50, 100, 200)]
    errors = [np.abs(v - velocities[0]).max() for v in velocities[1:]]
    assert errors[0] / errors[2] == pytest.approx(16.0, rel=0.2)


def test_bodies_that_touch_at_the_start_are_refused():
    x, v = oblique()
    with pytest.raises(ValueError, match="touch at the start"):
        flight(0.99 * x, v, mass=MASSES, reach=REACH, force=elastic, dt=1e-6, steps=1, every=1)


# --- the grip ------------------------------------------------------------------------------------


def grip(damping: float = 0.0) -> JkrGrip:
    return JkrGrip(pair=PAIR, surface_energy=ENERGY, damping=damping)


def test_a_grip_is_the_prescribed_force_row_by_row():
    release = jkr_overlap_of_largest_pull(PAIR, ENERGY)
    overlap = np.concatenate([np.linspace(-3e-6, 3e-5, 40), np.linspace(3e-5, 2 * release, 60), [-1e-7, 1e-7]])
    separation = np.gradient(overlap) * 1e6
    whole = jkr_force(
        overlap, separation, pair=PAIR, surface_energy=ENERGY, damping=0.1, tearing_overlap=release
    )
    one = grip(0.1)
    assert [one(overlap[k : k + 1], separation[k : k + 1])[0] for k in range(len(overlap))] == whole.tolist()
    assert (whole[overlap < 0.0] != 0.0).any()


@pytest.mark.parametrize("damping", [0.0, 0.1])
def test_a_flight_with_a_grip_is_the_motion_integrated(damping):
    """From touch, where the force jumps in, to the largest pull, where it is let go: first order in the step."""
    known = restitution(damping)
    found = []
    for dt in (2.0**-21, 2.0**-23):
        _, v = fly(grip(damping), dt, time=300 * 2.0**-20)
        found.append((v[-1, 0, 0, 0] - v[-1, 0, 1, 0]) / 0.5)
    assert found == pytest.approx([known, known], rel=4e-3)
    assert found[1] == pytest.approx(known, rel=1e-3)


def restitution(damping: float) -> float:
    pair = JkrCollision(
        effective_modulus=PAIR.effective_modulus, effective_radius=PAIR.effective_radius, reduced_mass=REDUCED,
        surface_energy=ENERGY,
    )
    release = (9 * math.pi * ENERGY * PAIR.effective_radius**2 / (4 * PAIR.effective_modulus)) ** (1 / 3)
    assert pair.force(release) == pytest.approx(-pair.pull_off_force, rel=1e-12)

    def over(_, y):
        return y[0] - release

    over.terminal, over.direction = True, -1
    slope = 2 / pair.effective_radius
    root = math.sqrt(math.pi * ENERGY / pair.effective_modulus)
    run = solve_ivp(
        lambda _, y: [y[1] / (slope * y[0] - root / math.sqrt(y[0])), -(pair.force(y[0]) + damping * y[1]) / REDUCED],
        (0.0, 1.0), [pair.touching_radius, 0.5], events=over, rtol=1e-10, atol=1e-16, max_step=2e-6,
    )
    return -run.y[1, -1] / 0.5
