"""Single collisions: closed forms, order of convergence, exact null and sliding tests."""

import math
from fractions import Fraction

import numpy as np
import pytest

from reference.analytic.linear_collision import LinearCollision

PAIRS = 64
LADDER = (25, 50, 100, 200, 400)
"""t_c / dt, t_c that of two unit masses; the masses differ from pair to pair, and so do the phases of contact."""


def collide(dem, resolution, *, damping_ratio, attraction, dim=2, seed=0):
    """Let 64 pairs collide head on in all directions; rms errors of restitution and of duration / t_c."""
    rng = np.random.default_rng(seed)
    mass, radius = rng.uniform(0.5, 2.0, (2, PAIRS)), rng.uniform(0.5, 1.0, (2, PAIRS))
    speed, reduced = rng.uniform(0.5, 2.0, PAIRS), mass.prod(axis=0) / mass.sum(axis=0)
    gap = rng.uniform(0.0, 0.1, PAIRS) * speed * dem.tc
    along = rng.normal(size=(PAIRS, dim))
    along /= np.linalg.norm(along, axis=1, keepdims=True)
    first = np.zeros((PAIRS, dim))
    first[:, 0] = 10.0 * np.arange(PAIRS)
    second = first + (radius.sum(axis=0) + gap)[:, None] * along
    push = (speed * reduced)[:, None] * along
    gamma = damping_ratio * 2.0 * math.sqrt(dem.KN * 0.5)
    m = dem.model(np.vstack([first, second]), v=np.vstack([push / mass[0][:, None], -push / mass[1][:, None]]),
                  radius=radius.ravel(), mass=mass.ravel(), gn=gamma, clip=attraction == "clipped",
                  dt=dem.tc / resolution)
    s = dem.run(dem.Simulation(m), int(2.5 * resolution)).state
    closed = [LinearCollision(stiffness=dem.KN, damping=gamma, reduced_mass=q) for q in reduced]
    gap_now = np.linalg.norm(s.x[:, PAIRS:] - s.x[:, :PAIRS], axis=0) - radius.sum(axis=0)
    exit_speed = ((s.v[:, PAIRS:] - s.v[:, :PAIRS]) * along.T).sum(axis=0)
    duration = np.array([c.duration(attraction) for c in closed])
    left = np.array([c.motion(t, v)[0] for c, t, v in zip(closed, duration, speed, strict=True)])
    measured = s.step * m.dt - (gap_now + left) / exit_speed - gap / speed  # free flight traced back to f = 0
    restitution = np.array([c.restitution(attraction) for c in closed])
    return rms(exit_speed / speed - restitution), rms((measured - duration) / dem.tc)


def rms(a):
    return math.sqrt(np.mean(a**2))


def slope(errors):
    return -np.polyfit(np.log(LADDER), np.log(errors), 1)[0]


@pytest.mark.parametrize(("damping_ratio", "attraction", "band", "at_50"), [
    (0.0, "allowed", (1.85, 2.25), 5e-4),  # measured 2.05 and 2.00
    (0.07, "allowed", (0.9, 1.15), 5e-3),  # 1.02, 1.05: the dashpot jumps on within a step
    (0.07, "clipped", (0.9, 1.15), 5e-3),  # 1.00, 1.04
    (0.35, "clipped", (0.9, 1.15), 2e-2),  # 0.98, 1.01
    (1.5, "clipped", (0.9, 1.15), 2e-1),  # 0.98, 1.07: overdamped
])
def test_restitution_and_contact_time_converge(dem, damping_ratio, attraction, band, at_50):
    errors = np.array([collide(dem, r, damping_ratio=damping_ratio, attraction=attraction) for r in LADDER])
    for quantity in errors.T:
        assert band[0] < slope(quantity) < band[1]
        assert quantity[1] < at_50


def test_the_same_errors_in_three_dimensions(dem):
    """Two equal speeds along a line know nothing of the dimension, but the directions are drawn anew."""
    errors = [collide(dem, r, damping_ratio=0.0, attraction="allowed", dim=3, seed=1)[0] for r in LADDER]
    assert 1.85 < slope(errors) < 2.25


@pytest.mark.parametrize("attraction", ["allowed", "clipped"])
def test_restitution_at_a_wall_is_that_of_the_whole_mass(dem, attraction):
    gamma, dt = 30.0, dem.tc / 4000
    floor = dem.wall("floor", (0.0, 0.0), (0.0, 1.0))
    m = dem.model([[0.0, 1.0]], v=[[0.3, -1.0]], gn=gamma, clip=attraction == "clipped", walls=[floor], dt=dt)
    s = dem.run(dem.Simulation(m), int(2.0 * dem.tc / dt)).state
    closed = LinearCollision(stiffness=dem.KN, damping=gamma, reduced_mass=1.0)
    assert s.v[1, 0] == pytest.approx(closed.restitution(attraction), rel=1e-3)
    assert s.v[0, 0] == 0.3


@pytest.mark.parametrize("convention", ["lammps", "liggghts", "talk"])
@pytest.mark.parametrize("tilted", [False, True])
def test_opposite_spins_have_no_contact_velocity(dem, convention, tilted):
    """Chung & Ooi 2011, test 7: identical spheres, spins omega and -omega: friction has nothing to do."""
    n = np.array([2.0, 1.0, -2.0]) / 3.0 if tilted else np.array([1.0, 0.0, 0.0])
    across = np.cross(n, [0.0, 0.0, 1.0])
    spins = 100.0 * np.array([across, -across])
    m = dem.model([-1.001 * n, 1.001 * n], v=[0.2 * n, -0.2 * n], spin=spins, mu=0.4, gt=2.0, convention=convention)
    start = dem.Simulation(m).state.v.copy()
    s = dem.run(dem.Simulation(m), 200).state
    np.testing.assert_allclose(s.spin.T, spins, atol=1e-11)
    np.testing.assert_allclose(np.cross(s.v.T, n), 0.0, atol=1e-14)
    np.testing.assert_allclose(s.v[:, 0], -start[:, 0], atol=1e-3)  # elastic, reversed
    if not tilted:
        assert np.array_equal(s.spin.T, spins)


@pytest.mark.parametrize(("dim", "factor"), [(2, Fraction(2, 1)), (3, Fraction(5, 2))])
def test_gross_sliding_at_a_wall_is_that_of_rigid_bodies(dem, dim, factor):
    """|J_t| = mu J_n in every step, so v_t' = v_t - mu (1 + e) v_n and R omega' = q^-1 mu (1 + e) v_n.

    Exact in the measured e, with the lever arm R (convention lammps), while the contact slides:
    v_t >= (1 + 1/q) mu (1 + e) v_n (Chung & Ooi 2011, tests 4 to 6).
    """
    up = np.eye(dim)[dim - 1]
    floor = dem.wall("floor", np.zeros(dim), up, friction=True)
    v = np.zeros(dim)
    v[0], v[-1] = 2.0, -1.0
    m = dem.model([1.001 * up], v=[v], mu=0.2, walls=[floor], convention="lammps")
    s = dem.run(dem.Simulation(m), 200).state
    change = 0.2 * (s.v[-1, 0] + 1.0)
    assert s.v[-1, 0] == pytest.approx(1.0, abs=2e-3)
    assert s.v[0, 0] == pytest.approx(2.0 - change, abs=1e-13)
    assert s.spin[0 if dim == 2 else 1, 0] == pytest.approx((-1 if dim == 2 else 1) * factor * change, abs=1e-12)


@pytest.mark.parametrize("convention", ["lammps", "liggghts", "talk"])
@pytest.mark.parametrize("dim", [2, 3])
def test_sliding_ends_in_rolling(dem, dim, convention):
    """A sphere thrown along a rough floor rolls at 5/7 v0, a disc at 2/3 v0, whatever mu is.

    With lever arm a the friction impulse J gives v0 - J/m = a^2 J/I: v/v0 = 1 - 1/(1 + m a^2/I).
    While it slides it loses mu g in a second. The talk's algorithm reaches that only for dt -> 0: the
    spring that sliding leaves behind already carries the dashpot of a slip that then falls, so every
    other step sticks with a force less by gamma_t times the loss of slip velocity in a step.
    """
    mu, g, v0, gt, up = 0.3, 10.0, 1.0, 40.0, np.eye(dim)[dim - 1]
    sag, dt = g / dem.KN, dem.tc / 20
    arm = 1.0 if convention == "lammps" else 1.0 - sag / 2
    floor = dem.wall("floor", np.zeros(dim), up, friction=True)
    m = dem.model([(1.0 - sag) * up], v=[v0 * np.eye(dim)[0]], mu=mu, gt=gt, walls=[floor], gravity=-g * up,
                  convention=convention, dt=dt)
    simulation = dem.Simulation(m)
    loss = sliding_loss(dem, simulation, steps=20)
    mobility = 1.0 + arm**2 / m.inertia[0]
    least = 1.0 - gt * mobility * dt if convention == "talk" else 1.0 - 1e-10
    assert least < loss / (mu * g) < 1.0 + 1e-10
    rolling = v0 * (1.0 - 1.0 / mobility)
    dem.run(simulation, int(4.0 * (v0 - rolling) / (mu * g) / dt))
    assert simulation.state.v[0, 0] == pytest.approx(rolling, rel=1e-6)
    assert rolling == pytest.approx({2: 2 / 3, 3: 5 / 7}[dim] * v0, rel=1e-3)
    spin = simulation.state.spin[0 if dim == 2 else 1, 0]
    assert abs(spin) * arm == pytest.approx(rolling, rel=1e-6)


def sliding_loss(dem, simulation, steps):
    """Velocity lost in a second, measured over an even number of steps after the first few."""
    dem.run(simulation, 10)
    before = simulation.state.v[0, 0]
    dem.run(simulation, steps)
    return (before - simulation.state.v[0, 0]) / (steps * simulation.model.dt)
