"""Bounces, the dropped ball and the two balls in a gap against the integrated equations of motion."""

import math

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from reference.analytic.bounce import BallsInGap, BouncingBall, DroppedBall
from reference.analytic.linear_collision import LinearCollision, damping_for_restitution

G = 9.81


@pytest.mark.parametrize("restitution", [0.5, 0.95])
def test_rigid_bounces(restitution, integrate_until):
    """Every flight integrated from the floor to the floor."""
    ball = BouncingBall(height=0.5, radius=0.1, restitution=restitution, gravity=G)
    time, state = 0.0, [0.5, 0.0]
    for bounce in range(1, 6):
        spent, (_, velocity) = integrate_until(
            lambda t, y: [y[1], -G], state, lambda t, y: y[0] - 0.1, span=2, direction=-1
        )
        time += spent
        assert ball.strike(bounce) == pytest.approx(time, rel=1e-9)
        assert ball.strike_speed(bounce) == pytest.approx(-velocity, rel=1e-9)
        state = [0.1, -restitution * velocity]
        _, (top, _) = integrate_until(lambda t, y: [y[1], -G], state, lambda t, y: y[1], span=2, direction=-1)
        assert ball.peak(bounce) == pytest.approx(top, rel=1e-9)
    assert ball.strike(2000) == pytest.approx(ball.time_to_rest, rel=1e-12)


MASS = 2600 * math.pi / 6 * 0.2**3


def dropped(stiffness=5e4, restitution=0.9, height=0.5, gravity=G):
    """The ball of MFiX's DEM01, d = 0.2 m, on a floor that is stiffer than there."""
    damping = damping_for_restitution(restitution, stiffness=stiffness, reduced_mass=MASS)
    contact = LinearCollision(stiffness=stiffness, damping=damping, reduced_mass=MASS)
    return DroppedBall(height=height, radius=0.1, contact=contact, gravity=gravity)


def in_contact(ball):
    k, c = ball.contact.stiffness, ball.contact.damping
    return lambda t, y: [y[1], ball.gravity - (k * y[0] + c * y[1]) / MASS]


@pytest.mark.parametrize("height", [0.102, 0.5, 3.0])
@pytest.mark.parametrize("stiffness", [1e4, 5e4, 1e7])
@pytest.mark.parametrize("restitution", [1.0, 0.9, 0.3])
def test_dropped_ball(height, stiffness, restitution, integrate_until):
    ball = dropped(stiffness, restitution, height)
    speed = math.sqrt(2 * G * (height - 0.1))
    assert ball.touch_speed == pytest.approx(speed, rel=1e-12)
    start, span = [0.0, speed], 20 / ball.contact.natural_frequency
    top_time, (overlap, _) = integrate_until(in_contact(ball), start, lambda t, y: y[1], span=span, direction=-1)
    assert ball.time_of_maximum == pytest.approx(top_time, rel=1e-9)
    assert ball.largest_overlap == pytest.approx(overlap, rel=1e-9)
    end = integrate_until(in_contact(ball), start, lambda t, y: y[0], span=span, direction=-1)
    if end is None:
        assert (ball.duration, ball.rebound_speed) == (math.inf, 0.0)
        return
    time, (_, rate) = end
    assert ball.duration == pytest.approx(time, rel=1e-9)
    assert ball.rebound_speed == pytest.approx(-rate, rel=1e-9)
    assert ball.rebound_height == pytest.approx(0.1 + rate**2 / (2 * G), rel=1e-9)


def test_ball_that_comes_to_rest():
    """From 2 mm on a soft, damped floor it does not come up again; then its overlap is m g/k."""
    ball = dropped(1e4, 0.3, 0.102)
    assert ball.duration == math.inf
    assert (ball.rebound_speed, ball.restitution, ball.rebound_height) == (0.0, 0.0, 0.1)
    height, velocity = ball.motion(np.array([60.0]))
    assert height[0] == pytest.approx(0.1 - MASS * G / 1e4, rel=1e-12)
    assert velocity[0] == pytest.approx(0, abs=1e-12)


def test_motion_through_the_three_stages():
    """By integration of a floor that is there only while the ball touches it, to the second touch."""
    ball = dropped()
    last = ball.touch_time + ball.duration + 2 * ball.rebound_speed / G
    marks = np.array([0.0, ball.touch_time, ball.touch_time + ball.duration, last])
    state, k, c = [0.5, 0.0], ball.contact.stiffness, ball.contact.damping
    for stage, begin, end in zip((0, 1, 0), marks[:-1], marks[1:], strict=True):
        time = np.linspace(begin, end * (1 - 1e-12), 30)
        run = solve_ivp(
            lambda t, y, on=stage: [y[1], on * (k * (0.1 - y[0]) - c * y[1]) / MASS - G], (begin, end), state,
            method="DOP853", rtol=1e-12, atol=1e-13, t_eval=time,
        )
        height, velocity = ball.motion(time)
        assert height == pytest.approx(run.y[0], rel=1e-9)
        assert velocity == pytest.approx(run.y[1], rel=1e-9, abs=1e-9)
        state = run.y[:, -1]
    with pytest.raises(ValueError, match="second touch"):
        ball.motion(np.array([last + 1e-6]))


def test_weightless_limit_is_the_free_collision():
    """For m g << k d gravity drops out of e, and only then."""
    hard = dropped(1e13, 0.7)
    assert hard.restitution == pytest.approx(0.7, rel=1e-5)
    assert hard.duration == pytest.approx(hard.contact.duration("allowed"), rel=1e-5)
    assert dropped(1e4, 0.7, height=0.2).restitution < 0.99 * 0.7


def test_impossible_drops():
    with pytest.raises(ValueError, match="damping ratio"):
        DroppedBall(height=0.5, radius=0.1, gravity=G,
                    contact=LinearCollision(stiffness=1.0, damping=2.0, reduced_mass=1.0))
    with pytest.raises(ValueError, match="height > radius"):
        dropped(height=0.1)


def gap(damping=(0.0, 0.0, 0.0), **change):
    """MFiX's DEM03: two balls of 1 mm between walls 1.8 mm apart, 20000 and 10000 kg/m^3, 1e3 N/m."""
    volume = math.pi / 6 * 1e-9
    given = {"gap": 1.8e-3, "radius": (5e-4, 5e-4), "mass": (2e4 * volume, 1e4 * volume),
             "stiffness": (1e3, 1e3, 1e3), "gravity": G}
    return BallsInGap(**(given | change), damping=damping)


def pushed(balls):
    """Rates of (y1, y2, y1', y2') from the forces of the three contacts, one by one."""
    (k1, k2, k3), (c1, c2, c3), (a, b), (m1, m2) = balls.stiffness, balls.damping, balls.radius, balls.mass

    def rates(t, y):
        y1, y2, v1, v2 = y
        floor = k1 * (a - y1) - c1 * v1
        between = k2 * (y1 + a - (y2 - b)) + c2 * (v1 - v2)
        ceiling = k3 * (y2 + b - balls.gap) + c3 * v2
        return [v1, v2, (floor - between) / m1 - balls.gravity, (between - ceiling) / m2 - balls.gravity]

    return rates


@pytest.mark.parametrize(
    "balls",
    [
        gap(), gap((1e-3, 2e-3, 5e-4)), gap((0.0, 0.3, 0.0)),
        gap(radius=(5.5e-4, 4.9e-4), stiffness=(2e3, 500.0, 1e3), gravity=200.0),
    ],
)
def test_balls_in_gap(balls):
    """Undamped, damped, one contact overdamped, unequal balls."""
    start = balls.equilibrium + [1.6e-5, -1.6e-5]
    time = np.linspace(0, 20e-3, 50)
    run = solve_ivp(pushed(balls), (0, time[-1]), [*start, 0.0, 0.01], method="DOP853", rtol=1e-12, atol=1e-16,
                    t_eval=time)
    height, velocity = balls.motion(time, height=start, velocity=[0.0, 0.01])
    assert height == pytest.approx(run.y[:2].T, rel=1e-9)
    assert velocity == pytest.approx(run.y[2:].T, rel=1e-9, abs=1e-9)
    assert pushed(balls)(0, [*balls.equilibrium, 0, 0])[2:] == pytest.approx([0, 0], abs=1e-9 * G)


def test_modes_of_equal_balls():
    """In phase sqrt(k/m), in antiphase sqrt(3 k/m)."""
    balls = gap(mass=(1e-5, 1e-5))
    assert balls.frequencies == pytest.approx(np.sqrt(np.array([1.0, 3.0]) * 1e3 / 1e-5), rel=1e-12)
    height, _ = balls.motion(
        np.array([0, 2 * math.pi / balls.frequencies[0]]), height=balls.equilibrium + 1e-5, velocity=[0, 0]
    )
    assert height[1] == pytest.approx(height[0], rel=1e-12)


def test_critical_damping_of_a_mode():
    """Equal balls, floor and ceiling alone damped: in phase they are one mass on c."""
    critical = 2 * math.sqrt(1e3 * 1e-5)
    balls = gap(mass=(1e-5, 1e-5), damping=(critical, 0.0, critical))
    with pytest.raises(ValueError, match="critically damped"):
        balls.motion(np.array([1e-4]), height=balls.equilibrium, velocity=[0, 0])


def test_a_contact_that_opens():
    with pytest.raises(ValueError, match="opens"):
        gap().motion(np.linspace(0, 1e-2, 100), height=[0.45e-3, 1.35e-3], velocity=[1.0, 0.0])
