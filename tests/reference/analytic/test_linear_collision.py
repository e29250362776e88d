"""The closed forms against the integrated equation of motion, and against values computed elsewhere."""

import math

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from reference.analytic.linear_collision import LinearCollision, damping_for_restitution

RATIOS = [0.0, 1e-6, 0.05, 0.3, 0.6, 1 / math.sqrt(2), 0.75, 0.9, 0.999, 1.0, 1.001, 1.5, 3.0, 20.0]
SPEED = 0.3


def collision(ratio):
    """k and m* of a real pair, so that a wrong unit shows; damping from the ratio b/w0."""
    k, m = 1e5, 4.2e-6
    return LinearCollision(stiffness=k, damping=2 * ratio * math.sqrt(k * m), reduced_mass=m)


def integrated(pair, attraction):
    """Return duration, restitution, and time and size of the largest overlap, by integration with events.

    In units of 1/w0 and v/w0, where k = m* = v = 1 and gamma = 2 b/w0.
    """
    zeta, w0 = pair.damping_ratio, pair.natural_frequency

    def forces(t, y):
        return [y[1], -y[0] - 2 * zeta * y[1]]

    def largest(t, y):
        return y[1]

    def end(t, y):
        return y[0] if attraction == "allowed" else y[0] + 2 * zeta * y[1]

    largest.direction, end.direction, end.terminal = -1, -1, True
    run = solve_ivp(forces, (0, 200), [1e-300, 1.0], method="DOP853", rtol=1e-12, atol=1e-14, events=[largest, end])
    (t_top,), (t_end,) = run.t_events
    top, last = run.y_events[0][0], run.y_events[1][0]
    return t_end / w0, -last[1], t_top / w0, top[0] * SPEED / w0


ENDING = [(r, "clipped") for r in RATIOS if r > 0] + [(r, "allowed") for r in RATIOS if 0 < r < 0.95]
"""Contacts that end; with attraction near and above the critical damping they do not."""


@pytest.mark.parametrize(("ratio", "attraction"), ENDING)
def test_against_integration(ratio, attraction):
    pair = collision(ratio)
    duration, restitution, time, overlap = integrated(pair, attraction)
    assert pair.duration(attraction) == pytest.approx(duration, rel=1e-9)
    assert pair.restitution(attraction) == pytest.approx(restitution, rel=1e-9, abs=1e-12)
    assert pair.time_of_maximum == pytest.approx(time, rel=1e-9)
    assert pair.largest_overlap(SPEED) == pytest.approx(overlap, rel=1e-9)


@pytest.mark.parametrize("ratio", RATIOS)
def test_motion_obeys_the_equation(ratio):
    """By the integrator, over the whole contact; and the force ends where the clipped contact does."""
    pair = collision(ratio)
    w0 = pair.natural_frequency
    time = np.linspace(0, pair.duration("clipped"), 40)
    run = solve_ivp(
        lambda t, y: [y[1], -y[0] - 2 * ratio * y[1]], (0, time[-1] * w0), [0.0, 1.0], method="DOP853",
        rtol=1e-12, atol=1e-14, t_eval=time * w0,
    )
    overlap, rate = pair.motion(time, SPEED)
    assert overlap == pytest.approx(run.y[0] * SPEED / w0, rel=1e-9, abs=1e-11 * SPEED / w0)
    assert rate == pytest.approx(run.y[1] * SPEED, rel=1e-9, abs=1e-11 * SPEED)
    scale = SPEED * math.sqrt(pair.stiffness * pair.reduced_mass)
    assert abs(pair.force(time[-1:], SPEED)[0]) < 1e-12 * scale * max(1, ratio)
    assert pair.force(time[1:-1], SPEED).min() > 0


@pytest.mark.parametrize(
    ("ratio", "clipped", "allowed"),
    [
        (0.05, 0.858758, 0.854468), (0.3, 0.450975, 0.372326), (0.6, 0.248841, 0.094780), (0.9, 0.155283, 0.001524),
        (1.0, 0.135335, 0.0), (1.5, 0.075588, 0.0), (3.0, 0.023770, 0.0),
    ],
)
def test_tabulated_restitutions(ratio, clipped, allowed):
    assert collision(ratio).restitution("clipped") == pytest.approx(clipped, abs=6e-7)
    assert collision(ratio).restitution("allowed") == pytest.approx(allowed, abs=6e-7)


def test_elastic_limit():
    pair = collision(0.0)
    half_period = math.pi * math.sqrt(pair.reduced_mass / pair.stiffness)
    for attraction in ("allowed", "clipped"):
        assert pair.restitution(attraction) == 1.0
        assert pair.duration(attraction) == pytest.approx(half_period, rel=1e-15)
    assert pair.largest_overlap(SPEED) == pytest.approx(SPEED * half_period / math.pi, rel=1e-15)


@pytest.mark.parametrize("ratio", [1.0, 1.001, 5.0])
def test_overdamped_bodies_never_part_if_attraction_is_allowed(ratio):
    pair = LinearCollision(stiffness=1.0, damping=2 * ratio, reduced_mass=1.0)
    assert pair.overdamped
    assert pair.duration("allowed") == math.inf
    assert pair.restitution("allowed") == 0.0
    assert pair.motion(np.linspace(0, 500, 100), 1.0)[0].min() >= 0.0


def test_critical_damping_from_both_sides():
    """The clipped duration passes 2/w0 and e = exp(-2) without a jump, to round-off of the square root."""
    critical = LinearCollision(stiffness=1.0, damping=2.0, reduced_mass=1.0)
    assert critical.critical_damping == 2.0
    assert critical.duration("clipped") == 2.0
    assert critical.restitution("clipped") == pytest.approx(math.exp(-2), rel=1e-15)
    for ratio in (1 - 1e-9, 1 + 1e-9):
        near = LinearCollision(stiffness=1.0, damping=2 * ratio, reduced_mass=1.0)
        assert near.duration("clipped") == pytest.approx(2.0, rel=3e-9)


def test_heavy_damping_stays_accurate():
    """For b >> w0 the clipped duration tends to (2/b) ln(2 b/w0)."""
    b = 1e8
    pair = LinearCollision(stiffness=1.0, damping=2 * b, reduced_mass=1.0)
    assert pair.duration("clipped") == pytest.approx(2 / b * math.log(2 * b), rel=1e-14)


@pytest.mark.parametrize("restitution", [1.0, 0.9, 0.5, 0.01])
def test_damping_for_restitution_inverts(restitution):
    damping = damping_for_restitution(restitution, stiffness=1e5, reduced_mass=4e-6)
    pair = LinearCollision(stiffness=1e5, damping=damping, reduced_mass=4e-6)
    assert pair.restitution("allowed") == pytest.approx(restitution, rel=1e-12)


@pytest.mark.parametrize("restitution", [0.0, -0.1, 1.1, math.nan])
def test_damping_for_impossible_restitution(restitution):
    with pytest.raises(ValueError, match="restitution must lie in"):
        damping_for_restitution(restitution, stiffness=1.0, reduced_mass=1.0)


def test_talks_mean_pair():
    """Contact times of the talks' mean pair (a = 1 mm, rho = 2000, k = 1e5): 2.03e-5, 2.04e-5, 2.20e-5 s."""
    mass = 4 / 3 * math.pi * 2000 * 1e-9
    times = [
        LinearCollision(stiffness=1e5, damping=g, reduced_mass=mass / 2).duration("allowed") for g in (0, 0.1, 0.5)
    ]
    assert times == pytest.approx([2.033e-5, 2.039e-5, 2.204e-5], rel=3e-4)
