"""Momentum, angular momentum, energy, reversibility, invariance under turning and under the dimension."""

import dataclasses

import numpy as np
import pytest

from reference.kernel.conventions import LAMMPS
from reference.kernel.model import Loaded

CONVENTIONS = ("lammps", "liggghts", "talk")


@pytest.mark.parametrize("mu", [None, 0.5])
def test_momentum_over_ten_thousand_steps(dem, mu):
    """Measured: 3e-14 of the sum of |p| without friction (2100 rebuilds), 2e-15 with friction and damping."""
    damped = {} if mu is None else {"mu": mu, "gn": 5.0, "gt": 3.0}
    m = dem.cluster(1, 2, across=4, periodic=(8.0, 8.0), **damped)
    simulation = dem.run(dem.Simulation(m), 10_000)
    drift = (m.mass * (simulation.state.v - m.v)).sum(axis=1)
    assert np.abs(drift).max() < 3e-13 * np.abs(m.mass * m.v).sum()
    assert simulation.rebuilds > 100


def imploding(dem, dim, convention, **laws):
    """A cluster that falls together, so that many contacts rub before it flies apart."""
    laws = laws or {"mu": 0.5, "gn": 5.0, "gt": 3.0}
    m = dem.cluster(2, dim, across=4 if dim == 2 else 3, squeeze=1.05, convention=convention, **laws)
    return dataclasses.replace(m, v=m.v - 0.75 * (m.x - m.x.mean(axis=1, keepdims=True)))


def drift_of_angular_momentum(dem, m, steps):
    simulation, contacts = dem.Simulation(m), 0
    before = dem.angular_momentum(simulation)
    for _ in range(steps):
        simulation.advance()
        contacts += len(simulation.interactions[0].last.f_n)
    assert contacts > 2 * steps / 3
    scale = (m.mass * np.sqrt((m.x**2).sum(axis=0) * (m.v**2).sum(axis=0))).sum()
    return np.abs(dem.angular_momentum(simulation) - before).max() / scale


@pytest.mark.parametrize("convention", CONVENTIONS)
@pytest.mark.parametrize("dim", [2, 3])
def test_angular_momentum_with_friction(dem, dim, convention):
    """Torques with lever arms that add up to the distance leave it alone: all three do so between particles.

    `lammps` measures the slip at R but applies the torque at R - overlap/2, so it conserves as well.
    """
    assert drift_of_angular_momentum(dem, imploding(dem, dim, convention), 1000) < 1e-12


@pytest.mark.parametrize("convention", CONVENTIONS)
@pytest.mark.parametrize("dim", [2, 3])
@pytest.mark.parametrize(("normal", "sliding", "rolling"), [
    ("hertz", "mindlin", "spring"), ("hysteretic", "spring", "constant"), ("hysteretic_variable", "viscous", "spring")])
def test_angular_momentum_with_every_law(dem, normal, sliding, rolling, dim, convention):
    """Couples come in opposite pairs; rolling and torsion springs included."""
    words = {"normal": normal, "sliding": sliding, "rolling": rolling} | ({"torsion": "spring"} if dim == 3 else {})
    tables = {family: dem.table(family, word) for family, word in words.items()}
    assert drift_of_angular_momentum(dem, imploding(dem, dim, convention, **tables), 300) < 1e-12


@pytest.mark.parametrize("dim", [2, 3])
def test_angular_momentum_with_the_radius_as_lever_arm(dem, dim):
    """What gran/hooke/history does: measured 8e-4 (2D) and 1.4e-4 (3D) of sum m |x| |v| here."""
    classic = dataclasses.replace(LAMMPS, name="classic", torque_arm="radius")
    assert 3e-5 < drift_of_angular_momentum(dem, imploding(dem, dim, classic), 1000) < 3e-3


def largest_energy_error(dem, resolution, seed):
    m = dem.cluster(seed, 2, across=4, periodic=(8.0, 8.0), dt=dem.tc / resolution)
    simulation, worst = dem.Simulation(m), 0.0
    start = dem.energy(simulation)
    for step in range(10 * resolution):
        simulation.advance()
        if step % 5 == 0:
            worst = max(worst, abs(dem.energy(simulation) / start - 1.0))
    return worst


def test_energy_of_an_elastic_cluster(dem):
    """Bounded, and falling as dt^2: measured over 20 t_c 2e-3, 5e-4, 1e-4, 3e-5 at t_c/dt = 20, 50, 100, 200."""
    ladder = (20, 50, 100, 200)
    errors = np.array([np.mean([largest_energy_error(dem, r, seed) for seed in (1, 2)]) for r in ladder])
    assert (np.diff(errors) < 0).all()
    assert errors[1] < 1.5e-3
    assert 1.6 < -np.polyfit(np.log(ladder), np.log(errors), 1)[0] < 2.5


def test_a_jammed_cluster_keeps_its_energy_for_long(dem):
    """Always in contact, 5000 steps: the error oscillates and does not grow."""
    m = dem.cluster(9, 2, squeeze=0.92, speed=0.1, periodic=(5.52, 5.52))
    simulation = dem.Simulation(m)
    start, errors = dem.energy(simulation), []
    for _ in range(100):
        dem.run(simulation, 50)
        errors.append(dem.energy(simulation) / start - 1.0)
    assert np.abs(errors).max() < 1e-3
    assert abs(np.mean(errors[50:]) - np.mean(errors[:50])) < 1e-4


@pytest.mark.parametrize("dim", [2, 3])
def test_elastic_motion_runs_backwards(dem, dim):
    """Forces depend on positions alone, so that only round-off is left: measured 4e-12 after 1000 + 1000."""
    m = dem.cluster(1, dim, across=3 if dim == 2 else 2, walls=dem.box(8.0, dim), periodic=None, speed=2.0)
    simulation = dem.Simulation(m)
    start = simulation.state.x.copy()
    dem.run(simulation, 500)
    assert np.abs(simulation.state.x - start).max() > 0.1
    simulation.state.v *= -1.0
    dem.run(simulation, 500)
    np.testing.assert_allclose(simulation.state.x, start, rtol=0, atol=1e-10)


def turned(m, turn):
    """The whole problem turned by the matrix `turn` about the origin."""
    def vector(a):
        return tuple((turn @ np.array(a)).tolist())

    walls = tuple(dataclasses.replace(w, point=vector(w.point), normal=vector(w.normal)) for w in m.walls)
    return dataclasses.replace(m, x=turn @ m.x, v=turn @ m.v, spin=turn @ m.spin, walls=walls,
                               gravity=vector(m.gravity))


@pytest.mark.parametrize("convention", CONVENTIONS)
def test_a_turned_problem_has_the_turned_result(dem, convention):
    lid = dem.wall("lid", (0.0, 0.0, 4.0), (0.1, 0.2, -1.0), friction=True,
                   motion=Loaded(mass=3.0, load=60.0, stress=0.0, span=None, damping=2.0))
    floor = dem.wall("floor", (0.0, 0.0, 0.0), (0.0, 0.0, 1.0))
    m = dem.cluster(8, 3, across=2, squeeze=0.9, speed=2.0, mu=0.4, gn=8.0, gt=4.0, walls=[lid, floor],
                    gravity=(0.0, 3.0, -9.0), drag=0.1, convention=convention)
    turn, _ = np.linalg.qr(np.random.default_rng(0).normal(size=(3, 3)))
    turn *= np.linalg.det(turn)
    plain, other = (dem.run(dem.Simulation(p), 200).state for p in (m, turned(m, turn)))
    for name in ("x", "v", "spin", "wall_force"):
        a, b = turn @ getattr(plain, name), getattr(other, name)
        np.testing.assert_allclose(a[:, :8] if name == "x" else a, b[:, :8] if name == "x" else b, rtol=0,
                                   atol=1e-12 * max(1.0, np.abs(a).max()) * 10)


@pytest.mark.parametrize("convention", CONVENTIONS)
def test_a_plane_problem_is_the_same_in_three_dimensions(dem, convention):
    flat = dem.cluster(8, 2, squeeze=0.9, speed=2.0, mu=0.4, gn=8.0, gt=4.0, convention=convention)
    n = flat.particle_count
    solid = dataclasses.replace(
        flat, x=np.vstack([flat.x, np.zeros(n)]), v=np.vstack([flat.v, np.zeros(n)]),
        spin=np.vstack([np.zeros((2, n)), flat.spin]))
    a, b = (dem.run(dem.Simulation(m), 200).state for m in (flat, solid))
    np.testing.assert_allclose(b.x[:2], a.x, rtol=0, atol=1e-12)
    np.testing.assert_allclose(b.spin[2:], a.spin, rtol=0, atol=1e-11)
    assert not b.x[2].any()
    assert not b.spin[:2].any()
