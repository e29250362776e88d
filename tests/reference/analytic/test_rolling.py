"""Sliding to rolling by integration of Coulomb's law; the incline by steps of a rigid body with friction."""

import math

import numpy as np
import pytest

from reference.analytic.rolling import BallOnIncline, SlidingBall

G, RADIUS = 9.81, 0.05


def sliding_ball(q, friction=0.3, velocity=1.0, spin=0.0):
    return SlidingBall(
        velocity=velocity, spin=spin, radius=RADIUS, inertia_factor=q, friction=friction, gravity=G
    )


@pytest.mark.parametrize("q", [0.4, 0.5, 1.0])
@pytest.mark.parametrize("friction", [0.02, 0.7])
@pytest.mark.parametrize(("velocity", "spin"), [(1.0, 0.0), (1.0, 50.0), (-0.4, 3.0), (0.0, -7.0), (1.0, -60.0)])
def test_until_it_rolls(q, friction, velocity, spin, integrate_until):
    ball = sliding_ball(q, friction, velocity, spin)
    push = -friction * G * math.copysign(1.0, velocity + RADIUS * spin)
    time, (distance, u, w) = integrate_until(
        lambda t, y: [y[1], push, push / (q * RADIUS)], [0.0, velocity, spin], lambda t, y: y[1] + RADIUS * y[2],
        span=100,
    )
    assert ball.time_to_roll == pytest.approx(time, rel=1e-9)
    assert ball.rolling_velocity == pytest.approx(u, rel=1e-9, abs=1e-12)
    assert ball.rolling_spin == pytest.approx(w, rel=1e-9, abs=1e-9)
    assert ball.motion(time) == pytest.approx((distance, u, w), rel=1e-9, abs=1e-9)
    before, after = (v**2 / 2 + q * (RADIUS * s) ** 2 / 2 for v, s in ((velocity, spin), (u, w)))
    assert ball.energy_lost == pytest.approx(before - after, rel=1e-9)


@pytest.mark.parametrize(("q", "velocity", "time"), [(0.4, 5 / 7, 2 / 7), (0.5, 2 / 3, 1 / 3)])
def test_sphere_and_disc(q, velocity, time):
    ball = sliding_ball(q, friction=0.3)
    assert ball.rolling_velocity == pytest.approx(velocity, rel=1e-15)
    assert ball.time_to_roll * 0.3 * G == pytest.approx(time, rel=1e-15)


def test_motion_goes_on_rolling():
    """Beyond t_r velocity and spin stay, and the distance grows by the rolling velocity."""
    ball = sliding_ball(0.4)
    t_r = ball.time_to_roll
    distance, velocity, spin = ball.motion(np.array([0.0, t_r, t_r + 2.0]))
    assert distance[0] == 0
    assert velocity[0] == 1.0
    assert distance[2] - distance[1] == pytest.approx(2 * ball.rolling_velocity, rel=1e-14)
    assert velocity[2] == pytest.approx(ball.rolling_velocity, rel=1e-14)
    assert velocity[2] + RADIUS * spin[2] == pytest.approx(0, abs=1e-14)


def test_a_rolling_ball_is_left_alone():
    ball = sliding_ball(0.4, velocity=1.0, spin=-1.0 / RADIUS)
    assert ball.time_to_roll == 0
    assert ball.motion(np.array([3.0]))[1] == 1.0


def stepped(q, angle, friction, steps=1000, dt=1e-3):
    """Velocity and spin after `steps`: in each, the friction impulse that ends the slip, or Coulomb's largest."""
    u = w = 0.0
    largest = friction * G * math.cos(angle) * dt
    for _ in range(steps):
        u += G * math.sin(angle) * dt
        wanted = -(u + RADIUS * w) / (1 + 1 / q)
        impulse = max(-largest, min(largest, wanted))
        u, w = u + impulse, w + impulse / (q * RADIUS)
    return u, w


@pytest.mark.parametrize("q", [0.4, 0.5])
@pytest.mark.parametrize("degrees", [5, 30, 60, 80])
@pytest.mark.parametrize("friction", [0.0, 0.1, 0.5, 1.0])
def test_incline(q, degrees, friction):
    ball = BallOnIncline(
        angle=math.radians(degrees), radius=RADIUS, inertia_factor=q, friction=friction, gravity=G
    )
    u, w = stepped(q, math.radians(degrees), friction)
    assert ball.acceleration == pytest.approx(u, rel=1e-9)
    assert ball.angular_acceleration == pytest.approx(w, rel=1e-9, abs=1e-9)
    assert ball.rolls == (abs(u + RADIUS * w) < 1e-9)
    assert ball.rolls == (math.tan(ball.angle) <= (1 + 1 / q) * friction)


@pytest.mark.parametrize(("q", "factor", "part"), [(0.4, 3.5, 5 / 7), (0.5, 3.0, 2 / 3)])
def test_criterion_of_rolling(q, factor, part):
    """At tan(th) = 3.5 mu (disc: 3 mu) both branches give one acceleration."""
    angle = math.radians(40)
    for more, rolls in [(1 - 1e-9, False), (1 + 1e-9, True)]:
        ball = BallOnIncline(
            angle=angle, radius=RADIUS, inertia_factor=q, friction=more * math.tan(angle) / factor, gravity=G
        )
        assert ball.rolls is rolls
        assert ball.acceleration == pytest.approx(part * G * math.sin(angle), rel=1e-8)
