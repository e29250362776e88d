"""Gravity, drag and periodic axes: exact solutions, and symmetry under shifts."""

import dataclasses
import math

import numpy as np
import pytest

LADDER = (25, 50, 100, 200)


def test_free_fall_is_exact(dem):
    """Velocity Verlet integrates a constant force without error: x = x0 + v0 t + g t^2/2."""
    g, v0 = np.array([0.5, -9.81, 2.0]), np.array([3.0, 4.0, -1.0])
    m = dem.model([[1.0, 2.0, 3.0]], v=[v0], gravity=tuple(g), mass=0.37, dt=1e-3)
    s = dem.run(dem.Simulation(m), 1000).state
    np.testing.assert_allclose(s.v[:, 0], v0 + g, rtol=1e-13)
    np.testing.assert_allclose(s.x[:, 0], np.array([1.0, 2.0, 3.0]) + v0 + 0.5 * g, rtol=1e-13)


def test_a_bouncing_ball_keeps_its_height(dem):
    """Elastic floor under gravity: back at the start height after the period 2 sqrt(2 h/g) + contact, each bounce."""
    floor = dem.wall("floor", (0.0, 0.0), (0.0, 1.0))
    m = dem.model([[0.0, 1.05]], walls=[floor], gravity=(0.0, -10.0), dt=dem.tc / 100)
    simulation, tops, last = dem.Simulation(m), [], 0.0
    for _ in range(6000):
        simulation.advance()
        v = simulation.state.v[1, 0]
        if last > 0.0 >= v:
            tops.append(simulation.state.x[1, 0])
        last = v
    assert len(tops) >= 3
    np.testing.assert_allclose(tops, 1.05, atol=5e-5)


def test_drag_decays_exponentially_at_first_order(dem):
    """m v' = -c v: v = v0 exp(-c t/m); the half-step velocity in the force costs one order."""
    mass, c, end = 2.0, 3.0, 1.0
    errors = []
    for n in LADDER:
        m = dem.model([[0.0, 0.0]], v=[[1.0, -2.0]], drag=c, mass=mass, dt=end / n)
        s = dem.run(dem.Simulation(m), n).state
        exact_v = np.array([1.0, -2.0]) * math.exp(-c * end / mass)
        exact_x = np.array([1.0, -2.0]) * mass / c * (1 - math.exp(-c * end / mass))
        errors.append([np.abs(s.v[:, 0] - exact_v).max(), np.abs(s.x[:, 0] - exact_x).max()])
    for quantity in np.array(errors).T:
        assert 0.9 < -np.polyfit(np.log(LADDER), np.log(quantity), 1)[0] < 1.1


def test_drag_leaves_spins_alone_and_ends_falling_at_the_terminal_velocity(dem):
    m = dem.model([[0.0, 0.0]], spin=[[7.0]], drag=5.0, gravity=(0.0, -10.0), mass=2.0, mu=0.5, dt=1e-2)
    s = dem.run(dem.Simulation(m), 1500).state
    assert s.spin[0, 0] == 7.0
    assert s.v[1, 0] == pytest.approx(-2.0 * 10.0 / 5.0, rel=1e-12)


@pytest.mark.parametrize("dim", [2, 3])
@pytest.mark.parametrize("images", [0, 3])
def test_a_shifted_periodic_problem_has_the_shifted_result(dem, dim, images):
    """Anywhere, and with particles moved by whole periods."""
    sides = (6.5, 6.3, 6.1)[:dim]
    m = dem.cluster(5, dim, speed=3.0, mu=0.4, gt=3.0, gn=4.0, periodic=sides)
    rng = np.random.default_rng(1)
    shift = rng.uniform(-9, 9, (dim, 1)) + rng.integers(-images, images + 1, m.x.shape) * np.array(sides)[:, None]
    plain, moved = (dem.run(dem.Simulation(dataclasses.replace(m, x=x)), 150).state for x in (m.x, m.x + shift))
    np.testing.assert_allclose(moved.x, plain.x + shift, rtol=0, atol=1e-11)
    np.testing.assert_allclose(moved.v, plain.v, rtol=0, atol=1e-10)
    np.testing.assert_allclose(moved.spin, plain.spin, rtol=0, atol=1e-10)


def test_a_collision_across_the_boundary_is_the_one_inside(dem):
    inside = dem.model([[4.0, 1.0], [6.1, 1.2]], v=[[1.0, 0.0], [-1.0, 0.0]], mu=0.5, periodic=(10.0, 0.0))
    across = dataclasses.replace(inside, x=inside.x + np.array([[5.0, -5.0], [0.0, 0.0]]))
    a, b = (dem.run(dem.Simulation(m), 200).state for m in (inside, across))
    assert a.v[0, 0] < 0.5
    np.testing.assert_allclose(a.v, b.v, rtol=0, atol=1e-11)


def test_positions_run_on_beyond_the_box_and_meet_again_after_a_lap(dem):
    """Two particles in a lane of length 8: the moving one goes round and strikes the other from behind."""
    m = dem.model([[1.0, 0.0], [5.0, 0.0]], v=[[0.0, 0.0], [4.0, 0.0]], periodic=(8.0, 0.0))
    s = dem.run(dem.Simulation(m), 1800).state
    assert s.v[0].tolist() == pytest.approx([4.0, 0.0], abs=1e-2)  # equal masses swap their velocities
    assert s.x[0, 1] == pytest.approx(7.0, abs=0.1)
