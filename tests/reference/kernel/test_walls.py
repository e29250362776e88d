"""Walls: how they move, what they feel, and what happens when a particle leaves through one."""

import dataclasses
import math

import numpy as np
import pytest

from reference.kernel.model import Constant, Cosine, Loaded
from reference.kernel.simulation import KernelUnstable

LADDER = (25, 50, 100, 200)


def slope(errors):
    return -np.polyfit(np.log(LADDER), np.log(errors), 1)[0]


def alone(dem, motion, *, dt=1e-3, normal=(0.0, -1.0), point=(0.0, 9.0)):
    """One wall far above one resting particle."""
    return dem.Simulation(dem.model([[0.0, 0.0]], walls=[dem.wall("lid", point, normal, motion=motion)], dt=dt))


# --- prescribed motion -----------------------------------------------------------------------------


def test_cosine_motion_and_the_rest_after_it(dem):
    simulation = alone(dem, Cosine(travel=0.4, duration=0.25))
    for step in range(1, 401):
        simulation.advance()
        s, t = simulation.state, min(step * 1e-3, 0.25)
        assert s.wall_d[0] == pytest.approx(0.2 * (1 - math.cos(math.pi * t / 0.25)), rel=1e-12, abs=1e-16)
        assert s.wall_rate[0] == pytest.approx(0.2 * math.pi / 0.25 * math.sin(math.pi * t / 0.25), abs=1e-12)
        assert s.x[1, 1] == pytest.approx(9.0 - s.wall_d[0], rel=1e-15)
        assert s.v[0, 1] == 0.0
    assert s.wall_d[0] == 0.4
    assert s.v[1, 1] == s.wall_rate[0] == 0.0


def test_the_velocity_that_particles_feel_is_the_mean_one_of_the_step(dem):
    simulation = alone(dem, Cosine(travel=0.4, duration=0.25))
    before = 0.0
    for _ in range(50):
        simulation.advance()
        s = simulation.state
        assert -s.v[1, 1] == pytest.approx((s.wall_d[0] - before) / 1e-3, rel=1e-14)
        before = s.wall_d[0]


def test_constant_motion_has_a_displacement_along_the_normal_only(dem):
    simulation = alone(dem, Constant(velocity=(0.6, -0.5)), normal=(0.6, -0.8), point=(-9.0, 9.0))
    s = dem.run(simulation, 1000).state
    assert s.wall_d[0] == pytest.approx(0.76, rel=1e-14)
    assert s.wall_rate[0] == pytest.approx(0.76, rel=1e-14)
    np.testing.assert_allclose(s.x[:, 1], [-9.0 + 0.6, 9.0 - 0.5], rtol=0, atol=1e-15)


def test_a_sheared_rough_wall_drags_and_a_smooth_one_does_not(dem):
    """Its velocity v along the plane starts with step 0; friction mu f_n acts until the disc follows."""
    def pushed(friction):
        floor = dem.wall("floor", (0.0, 0.0), (0.0, 1.0), friction=friction, motion=Constant(velocity=(9.0, 0.0)))
        m = dem.model([[0.0, 0.999]], walls=[floor], mu=0.5, gravity=(0.0, -10.0), convention="lammps")
        return dem.run(dem.Simulation(m), 21).state

    rough, smooth = pushed(True), pushed(False)
    # at set-up pair granular's rule gives no force yet, so half a step is missing; J = mu m g t, spin J R/I
    assert rough.v[0, 0] == pytest.approx(0.5 * 10.0 * 20.5 * dem.tc / 50, rel=1e-10)
    assert rough.spin[0, 0] == pytest.approx(rough.v[0, 0] / 0.5, rel=1e-10)
    assert smooth.v[0, 0] == smooth.spin[0, 0] == 0.0


# --- loaded walls ----------------------------------------------------------------------------------


def lid_on_a_disc(dem, resolution, *, wall_damping, disc_damping):
    """A disc on a fixed floor below a lid with mass 2 and load 30, started out of balance but touching."""
    floor = dem.wall("floor", (0.0, 0.0), (0.0, 1.0))
    lid = dem.wall("lid", (0.0, 1.99), (0.0, -1.0),
                   motion=Loaded(mass=2.0, load=30.0, stress=0.0, span=None, damping=wall_damping))
    m = dem.model([[0.0, 0.994]], walls=[floor, lid], gn=disc_damping, dt=dem.tc / resolution)
    s = dem.run(dem.Simulation(m), 4 * resolution).state
    return np.array([s.x[1, 0], s.wall_d[1], s.v[1, 0], s.wall_rate[1]])


def exact_lid(dem, *, wall_damping, disc_damping):
    """m y'' = k(1 - y) - c y' - k(1 - (h - d - y)) + .. ; 2 d'' = 30 + F.n - gamma d', by DOP853."""
    from scipy.integrate import solve_ivp

    k, c, height = dem.KN, disc_damping, 1.99

    def rates(_, state):
        y, d, v, u = state
        below = k * (1.0 - y) - c * v
        above = k * (1.0 - (height - d - y)) + c * (v + u)
        return [v, u, below - above, (30.0 - above - wall_damping * u) / 2.0]

    end = 4 * dem.tc
    solved = solve_ivp(rates, (0.0, end), [0.994, 0.0, 0.0, 0.0], method="DOP853", rtol=1e-12, atol=1e-14)
    y, d = solved.y[:2]
    assert y.max() < 1.0
    assert (height - d - y).max() < 1.0  # it never opens
    return solved.y[:, -1]


@pytest.mark.parametrize(("wall_damping", "disc_damping", "order"), [(0.0, 0.0, 2), (40.0, 0.0, 1), (0.0, 20.0, 1)])
def test_a_loaded_wall_on_a_disc_follows_the_equations_of_motion(dem, wall_damping, disc_damping, order):
    """Second order; first order with dashpots, which see half-step velocities. Measured 2.00, 1.0, 1.0."""
    damping = {"wall_damping": wall_damping, "disc_damping": disc_damping}
    exact = exact_lid(dem, **damping)
    errors = [lid_on_a_disc(dem, r, **damping) - exact for r in LADDER]
    sizes = [np.linalg.norm(e * [100.0, 100.0, 1.0, 1.0]) for e in errors]  # lengths in v/w0: both count alike
    assert order - 0.1 < slope(sizes) < order + 0.1
    assert sizes[-1] < 1e-2 * np.linalg.norm(exact[2:])


def test_stress_times_the_changing_distance_of_two_walls(dem):
    """The talk's m x'' = F - p z(t) - gamma x' without particles: z falls as the top wall comes down."""
    from scipy.integrate import solve_ivp

    height, stress, mass, damping, drive = 5.0, 8.0, 3.0, 1.5, Cosine(travel=1.0, duration=0.4)

    def pushed(resolution):
        walls = [dem.wall("bottom", (0.0, 0.0), (0.0, 1.0)), dem.wall("top", (0.0, height), (0.0, -1.0), motion=drive),
                 dem.wall("side", (50.0, 0.0), (-1.0, 0.0),
                          motion=Loaded(mass=mass, load=-2.0, stress=stress, span=(0, 1), damping=damping))]
        m = dem.model([[1.5, 1.5]], walls=walls, dt=0.4 / resolution)
        s = dem.run(dem.Simulation(m), resolution).state
        return np.array([s.wall_d[2], s.wall_rate[2]])

    def rates(t, state):
        z = height - drive.displacement(t)
        return [state[1], (-2.0 + stress * z - damping * state[1]) / mass]

    exact = solve_ivp(rates, (0.0, 0.4), [0.0, 0.0], method="DOP853", rtol=1e-12, atol=1e-14).y[:, -1]
    errors = np.array([np.abs(pushed(r) - exact) for r in LADDER])
    assert (errors[1] < 1e-2 * np.abs(exact)).all()
    for quantity in errors.T:
        assert 0.9 < slope(quantity) < 1.1  # damped with half-step velocities


def test_the_side_wall_of_a_box_at_rest_carries_stress_times_height(dem):
    """Four discs on a square lattice between four walls: every contact carries p h / 2 when at rest."""
    height, stress = 3.998, 20.0
    walls = [dem.wall("left", (0.0, 0.0), (1.0, 0.0)), dem.wall("bottom", (0.0, 0.0), (0.0, 1.0)),
             dem.wall("right", (3.996, 0.0), (-1.0, 0.0),
                      motion=Loaded(mass=4.0, load=0.0, stress=stress, span=(1, 3), damping=400.0)),
             dem.wall("top", (0.0, height), (0.0, -1.0))]
    x = [[1.0, 1.0], [2.998, 1.0], [1.0, 2.998], [2.998, 2.998]]
    simulation = dem.run(dem.Simulation(dem.model(x, walls=walls, gn=60.0)), 3000)
    s = simulation.state
    assert -s.wall_force[:, 2] @ s.wall_normal[:, 2] == pytest.approx(stress * height, rel=1e-6)
    assert s.wall_force[0, 0] == pytest.approx(-stress * height, rel=1e-6)
    assert s.wall_d[2] == pytest.approx(3.996 - (4.0 - 3 * stress * height / 2 / dem.KN), abs=1e-8)


def test_smooth_and_rough_walls_in_one_corner(dem):
    """A disc pressed into a corner turns by the rough wall alone; taking friction away stops the turning."""
    def corner(rough):
        walls = [dem.wall("floor", (0.0, 0.0), (0.0, 1.0), friction="floor" in rough),
                 dem.wall("side", (0.0, 0.0), (1.0, 0.0), friction="side" in rough)]
        m = dem.model([[0.999, 0.999]], v=[[0.1, -0.3]], walls=walls, mu=0.4, gt=2.0)
        return dem.run(dem.Simulation(m), 20)

    spins = {rough: corner(rough).state.spin[0, 0] for rough in [(), ("floor",), ("side",)]}
    assert spins[()] == 0.0
    assert spins["floor",] < 0.0  # thrown to the right on the floor: clockwise
    assert spins["side",] < 0.0  # falling along the left wall: clockwise
    kinds = [(k.walls, k.sliding is not None) for k in corner(("side",)).interactions]
    assert kinds == [(None, True), ((1,), True), ((0,), False)]


def test_a_frictionless_problem_has_no_torque_no_spring_and_no_wall_pairs(dem):
    simulation = dem.Simulation(dem.model([[0.0, 0.0], [1.9, 0.0]]))
    assert simulation.state.torque is None
    assert [k.walls for k in simulation.interactions] == [None]
    assert not simulation.interactions[0].pairs.memory
    rough_without_law = dem.model([[0.0, 0.9]], walls=[dem.wall("floor", (0, 0), (0, 1), friction=True)])
    assert [k.sliding for k in dem.Simulation(rough_without_law).interactions] == [None, None]


# --- beyond the laws -------------------------------------------------------------------------------


@pytest.mark.parametrize("skin", [0.0, 0.1, 100.0])
@pytest.mark.parametrize("speed", [400.0, 1e5])
def test_a_centre_that_passes_a_wall_is_refused_by_name(dem, skin, speed):
    """Slowly or in one bound, whatever the list's skin: the same step, the same message."""
    walls = [dem.wall("floor", (0.0, 0.0), (0.0, 1.0)), dem.wall("gate", (9.0, 0.0), (-1.0, 0.0))]
    m = dem.model([[3.0, 5.0], [7.5, 5.0]], v=[[0.0, 0.0], [speed, 0.0]], walls=walls)
    simulation = dem.Simulation(m, skin=skin)
    step = math.ceil(1.5 / (speed * m.dt)) if speed > 1e4 else 9  # 9: slowed by the wall on the way
    with pytest.raises(KernelUnstable, match=f"step {step}: the centre of particle 2 has passed wall 'gate'"):
        dem.run(simulation, 50)


def test_a_start_behind_a_wall_is_refused(dem):
    m = dem.model([[0.0, -0.5]], walls=[dem.wall("floor", (0.0, 0.0), (0.0, 1.0))])
    with pytest.raises(KernelUnstable, match="step 0: the centre of particle 1 has passed wall 'floor'"):
        dem.Simulation(m)


@pytest.mark.parametrize("bad", [math.nan, math.inf])
@pytest.mark.parametrize("name", ["v", "force", "spin"])
def test_a_number_that_is_none_is_refused(dem, name, bad):
    simulation = dem.Simulation(dem.model([[0.0, 0.0], [1.99, 0.0]], mu=0.3))
    getattr(simulation.state, name)[0, 1] = bad
    with pytest.raises(KernelUnstable, match="step [1-3]: a position is no longer a finite number"), \
            np.errstate(invalid="ignore"):
        dem.run(simulation, 3)


def test_two_centres_in_one_place_are_refused(dem):
    with np.errstate(invalid="ignore"):
        simulation = dem.Simulation(dem.model([[0.0, 0.0], [0.0, 0.0]]))
        with pytest.raises(KernelUnstable, match="no longer a finite number"):
            dem.run(simulation, 2)


def test_a_step_far_too_long_ends_as_unstable(dem):
    m = dem.cluster(1, 2, walls=dem.box(6.2, 2), speed=5.0)
    with pytest.raises(KernelUnstable), np.errstate(all="ignore"):
        dem.run(dem.Simulation(dataclasses.replace(m, dt=1.5 * dem.tc)), 20_000)
