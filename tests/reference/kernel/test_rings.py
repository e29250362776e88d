"""Rings of glued discs: what they are to particles, how they turn, and what is written of them."""

import dataclasses
import math

import numpy as np
import pytest

from reference.kernel.conventions import CONVENTIONS
from reference.kernel.corrected import simulate
from reference.kernel.laws.registry import LAWS
from reference.kernel.model import Ring
from reference.kernel.output import SeriesWriter, contact_table, particle_table, ring_loads, wall_table
from reference.kernel.program.simulation import ProgramSimulation, fastest
from reference.kernel.simulation import Simulation

FRICTION = {"mu": 0.4, "gt": 2.0}
PLANAR = [(family, word) for family, words in LAWS.items() for word in words if family != "torsion"]
VISCOUS = {"law": "viscous", "shear_friction": 1e3, "shear_damping": 3.0}


# --- the body ------------------------------------------------------------------------------------------


@pytest.mark.parametrize(("family", "word"), PLANAR)
@pytest.mark.parametrize("convention", list(CONVENTIONS))
def test_glued_discs_at_rest_are_discs_of_overwhelming_mass(dem, annulus, family, word, convention):
    """The same discs as particles of mass 1e200, which nothing moves: m* and a* of every law."""
    rings = (annulus.ring("inner", 3.0, count=9), annulus.ring("outer", 8.0, count=20))
    sliding = {"sliding": dem.table("sliding", "spring")} if family == "rolling" else {}
    tables = dem.contact_with(family, word) | sliding
    glued = annulus.between(centre=(0.0, 0.0), squeeze=1.1, convention=convention, rings=rings, **tables)
    heavy = dataclasses.replace(glued, rings=(), **{
        name: np.concatenate([getattr(glued, name), *([value(r) for r in rings])], axis=-1) for name, value in {
            "x": lambda r: r.x, "v": lambda r: 0 * r.x, "spin": lambda r: 0 * r.x[:1], "radius": lambda r: r.radius,
            "mass": lambda r: 1e200 + 0 * r.radius, "inertia": lambda r: 1e200 + 0 * r.radius}.items()})
    a, b = dem.run(Simulation(glued), 100), dem.run(Simulation(heavy), 100)
    n = glued.particle_count
    for name in ("x", "v", "spin"):
        free, expected = getattr(a.state, name)[:, :n], getattr(b.state, name)[:, :n]
        np.testing.assert_allclose(free, expected, rtol=0, atol=1e-9 * np.abs(expected).max(initial=1.0), err_msg=name)
    assert sum(len(forces.f_n) for kind, forces in a.contacts() if kind.rings) > 5


def test_glued_discs_never_touch_each_other(dem, annulus):
    """Overlapping discs on a circle, far from the only particle: no contact and no force."""
    rings = (annulus.ring("inner", 3.0, count=60, omega=1.0),)
    simulation = dem.run(Simulation(dem.model([[20.0, 0.0]], rings=rings)), 5)
    assert not contact_table(simulation)["i"].size
    assert not simulation.state.force.any()


@pytest.mark.parametrize("changes", [{"x": np.zeros((2, 3))}, {"x": np.zeros((3, 2))}])
def test_arrays_of_other_shapes_are_refused(changes):
    with pytest.raises(ValueError, match=r"ring 'r': x: expected shape \(2, 2\), got"):
        Ring(name="r", centre=(0.0, 0.0), radius=np.ones(2), **changes)


@pytest.mark.parametrize(("dim", "options", "got"), [
    (3, {}, "three dimensions"), (2, {"periodic": (30.0, 0.0)}, "periodic axes")])
def test_rings_are_refused_where_there_are_none(dem, annulus, dim, options, got):
    with pytest.raises(ValueError, match=f"rings: expected two dimensions and open axes, got {got}"):
        dem.model([[0.0] * dim], rings=(annulus.ring("r", 3.0),), **options)


# --- the motion ----------------------------------------------------------------------------------------


@pytest.mark.parametrize("kind", [Simulation, ProgramSimulation])
def test_a_ring_turns_as_a_whole_and_without_drift(dem, annulus, kind):
    """After a thousand steps every disc is where a rotation in extended precision brings it, at its old distance."""
    ring = annulus.ring("r", 3.0, omega=-7.0)
    simulation = kind(dem.model([[20.0, 0.0]], rings=(ring,), mu=0.5, dt=1e-2))
    simulation.advance(1000)
    x, v, spin = (getattr(simulation.state, name)[:, 1:] for name in ("x", "v", "spin"))
    drift = np.hypot(*x) / np.hypot(*ring.x) - 1.0
    assert np.abs(drift).max() < 1e-15
    angle = np.longdouble(-7.0) * simulation.time
    c, s = np.cos(angle), np.sin(angle)
    np.testing.assert_allclose(x, [c * ring.x[0] - s * ring.x[1], s * ring.x[0] + c * ring.x[1]], rtol=0, atol=3e-14)
    np.testing.assert_allclose(v, -7.0 * np.stack([-x[1], x[0]]), rtol=0, atol=1e-13)
    assert (spin == -7.0).all()


def test_a_ring_that_starts_turned_goes_on_from_there(dem, annulus):
    ring = annulus.ring("r", 3.0, omega=2.0, centre=(0.3, -0.2))
    start = ring.turned(0.7)
    assert (start.name, start.omega, start.circle) == ("r", 2.0, ring.circle)
    np.testing.assert_allclose(start.places(1.0), dataclasses.replace(ring, omega=2.7).places(1.0), rtol=0, atol=1e-14)


def test_the_set_up_sees_the_ring_turning(dem, annulus):
    """Before the first step glued discs have their velocity and spin, and a touching disc at rest feels them."""
    ring = annulus.ring("r", 5.0, omega=2.0, count=1)
    m = dem.model([[5.0, 1.4]], gn=3.0, sliding=VISCOUS, convention="talk", rings=(ring,))
    s = Simulation(m).state
    overlap = 1.5 - 1.4
    assert s.v[:, 1].tolist() == [0.0, 10.0]
    assert s.force[1, 0] == pytest.approx(dem.KN * overlap + 3.0 * 10.0)
    slip = 2.0 * (0.5 - overlap / 2)  # its spin; the disc is pushed, not dragged
    assert s.force[0, 0] == pytest.approx(-3.0 * slip)


@pytest.mark.parametrize("kind", [Simulation, ProgramSimulation])
@pytest.mark.parametrize("convention", ["lammps", "liggghts", "talk"])
def test_forces_see_the_ring_at_the_end_of_the_step(dem, annulus, kind, convention):
    """By hand: the disc with its half-step velocity, the glued one where it is and as fast as at the end."""
    dt, omega = 0.01, 2.0
    m = dem.model([[5.0, 1.4]], v=[[0.3, -0.2]], gn=3.0, dt=dt, mass=1e3, convention=convention,
                  rings=(annulus.ring("r", 5.0, omega=omega, count=1),))
    simulation = kind(m)
    half = m.v[:, 0] + 0.5 * dt * simulation.state.force[:, 0] / 1e3
    simulation.advance(1)
    arm = 5.0 * np.array([math.cos(omega * dt), math.sin(omega * dt)])
    branch = m.x[:, 0] + dt * half - arm
    distance = math.hypot(*branch)
    n, v = branch / distance, half - omega * np.array([-arm[1], arm[0]])
    expected = (dem.KN * (1.5 - distance) - 3.0 * (v @ n)) * n
    np.testing.assert_allclose(simulation.state.force[:, 0], expected, rtol=1e-11)


def test_a_ring_at_rest_does_not_move(dem, annulus):
    m = annulus.between(omegas=(None, None), **FRICTION)
    simulation = dem.run(Simulation(m), 60)
    for ring, part in zip(m.rings, m.ring_nodes, strict=True):
        assert np.array_equal(simulation.state.x[:, part], ring.x)
        assert not simulation.state.v[:, part].any()


# --- what it does to particles ---------------------------------------------------------------------------


def notch(dem, annulus, convention, dt):
    """A disc in the notch between two discs of a ring that turns around it: moving along, but not yet spinning."""
    omega, circle, overlap = 3.0, 6.0, 0.05
    ring = annulus.ring("r", circle, radius=1.0, count=18, omega=omega)
    middle = math.pi / 18
    place = circle * math.cos(middle) - math.sqrt((2.0 - overlap) ** 2 - (circle * math.sin(middle)) ** 2)
    x = place * np.array([math.cos(middle), math.sin(middle)])
    return dem.model([x], v=[[-omega * x[1], omega * x[0]]], gn=8.0, sliding=VISCOUS, rings=(ring,), dt=dt, kn=800.0,
                     convention=convention)


def dragged(m, duration):
    """Place, velocity and spin of the disc, (5,), by an ODE solver: two discs on a circle, springs and dashpots."""
    from scipy.integrate import solve_ivp

    ring, law = m.rings[0], m.normal
    omega, start = ring.omega, math.atan2(m.x[1, 0], m.x[0, 0])

    def rates(t, y):
        pull = np.zeros(3)
        for k in (-1, 1):
            angle = start + k * math.pi / 18 + omega * t
            arm = 6.0 * np.array([math.cos(angle), math.sin(angle)])
            branch = y[:2] - arm
            distance = math.hypot(*branch)
            n = branch / distance
            across = np.array([-n[1], n[0]])
            overlap = 2.0 - distance
            assert overlap > 0
            v = y[2:4] - omega * np.array([-arm[1], arm[0]])
            lever = 1.0 - overlap / 2
            shear = -VISCOUS["shear_damping"] * (v @ across - lever * (y[4] + omega))
            pull[:2] += (law.normal_stiffness * overlap - law.normal_damping * (v @ n)) * n + shear * across
            pull[2] -= lever * shear
        return [*y[2:4], *(pull[:2] / m.mass[0]), pull[2] / m.inertia[0]]

    y0 = [*m.x[:, 0], *m.v[:, 0], *m.spin[:, 0]]
    return solve_ivp(rates, (0.0, duration), y0, method="DOP853", rtol=1e-12, atol=1e-13).y[:, -1]


@pytest.mark.parametrize(("convention", "order"), [("talk", 1), ("corrected", 2)])
@pytest.mark.parametrize("kind", [fastest, simulate])
def test_a_disc_is_dragged_as_an_ode_has_it(dem, annulus, named, convention, order, kind):
    duration, steps = 0.2, (400, 800, 1600)
    exact, errors = dragged(notch(dem, annulus, named[convention], duration), duration), []
    for count in steps:
        simulation = kind(notch(dem, annulus, named[convention], duration / count))
        simulation.advance(count)
        s = simulation.state
        errors.append(np.abs([*s.x[:, 0], *s.v[:, 0], *s.spin[:, 0]] - exact).max())
    orders = np.log2(np.array(errors[:-1]) / errors[1:])
    np.testing.assert_allclose(orders, order, atol=0.1)
    assert errors[-1] < {1: 1e-2, 2: 1e-4}[order]
    assert exact[4] == pytest.approx(3.0, rel=0.2)  # the spin comes from friction alone


@pytest.mark.parametrize("convention", ["talk", "corrected", "lammps", "liggghts"])
@pytest.mark.parametrize("kind", [fastest, simulate])
def test_the_torque_on_rings_is_that_on_particles_with_the_other_sign(dem, annulus, named, convention, kind):
    """Force and torque about the centre of both rings and all discs vanish to round-off."""
    rolling = None if convention == "corrected" else dem.table("rolling", "spring")
    m = annulus.between(convention=named[convention], rolling=rolling, **FRICTION)
    simulation = kind(m)
    n, centre = m.particle_count, np.array([[0.3], [-0.2]])
    for _ in range(6):
        simulation.advance(20)
        s, loads = simulation.state, ring_loads(simulation)
        x, f = s.x[:, :n] - centre, s.force[:, :n]
        moments = np.concatenate([x[0] * f[1] - x[1] * f[0], s.torque[0, :n]])
        torques = np.array([load.torque for load in loads])
        assert np.abs(torques).min() > 1e-3
        assert abs(moments.sum() + torques.sum()) < 1e-13 * np.abs(moments).sum()
        np.testing.assert_allclose(f.sum(axis=1), -np.sum([load.force for load in loads], axis=0), rtol=0,
                                   atol=1e-13 * np.abs(f).sum())


def test_torque_and_angular_momentum(dem, annulus):
    """The leapfrog takes the impulse dt T of every step, halves at both ends, from the particles."""
    m = annulus.between(centre=(0.0, 0.0), **FRICTION)
    simulation = Simulation(m)
    start, torque = dem.angular_momentum(simulation)[2], [sum(load.torque for load in ring_loads(simulation))]
    for _ in range(150):
        simulation.advance()
        torque.append(sum(load.torque for load in ring_loads(simulation)))
    given = -m.dt * (sum(torque) - 0.5 * (torque[0] + torque[-1]))
    gained = dem.angular_momentum(simulation)[2] - start
    assert abs(gained) > 1.0
    assert gained == pytest.approx(given, rel=1e-10)


@pytest.mark.parametrize(("convention", "order"), [("talk", 1), ("corrected", 2)])
def test_between_rings_that_turn_alike_everything_turns_alike(dem, annulus, named, convention, order):
    """A loaded annulus ends in rigid rotation, with torques that cancel: every velocity is omega x r, every spin omega.

    A step dt goes along a chord, which leaves sin(omega dt)/dt of omega. Spins of discs at a ring lack the more:
    contacts see it at the end of the step, the discs in its middle, an error of the order of the scheme.
    """
    omega, errors = 0.8, []
    for dt in (4e-3, 2e-3):
        m = annulus.between(centre=(0.0, 0.0), omegas=(omega, omega), squeeze=1.16, kn=1e3, gn=20.0, dt=dt,
                            sliding=VISCOUS | {"shear_damping": 8.0}, convention=named[convention])
        simulation = fastest(m)
        simulation.advance(round(16.0 / dt))
        s, table, n = simulation.state, contact_table(simulation), m.particle_count
        assert np.isin(np.arange(1, n + 1), np.concatenate([table["i"], table["j"]])).all()  # nothing rattles
        chord = math.sin(omega * dt) / dt * np.stack([-s.x[1], s.x[0]])
        np.testing.assert_allclose(s.v[:, :n], chord[:, :n], rtol=0, atol=1e-7)
        errors.append(np.abs(s.spin[0] - omega).max() / omega)
        inner, outer = (load.torque for load in ring_loads(simulation))
        assert abs(inner + outer) < 1e-6 * abs(inner)
    assert errors[0] < {1: 3e-3, 2: 3e-5}[order]
    assert np.log2(errors[0] / errors[1]) == pytest.approx(order, abs=0.05)


# --- what is written -------------------------------------------------------------------------------------


def planes(dem, friction):
    return dem.box(30.0, 2, friction=friction)[:2]


@pytest.mark.parametrize("steps", [0, 40])
@pytest.mark.parametrize("walled", [False, True])
def test_rows_of_rings(dem, annulus, walled, steps):
    """Elastic, so that half-step and full-step forces are one: contact rows add up to force and torque of the ring."""
    walls = planes(dem, ()) if walled else ()
    simulation = dem.run(Simulation(annulus.between(centre=(10.0, 10.0), walls=walls, gn=0.0, squeeze=1.1)), steps)
    contacts, table = contact_table(simulation), wall_table(simulation)
    first = len(walls)
    assert table["id"].tolist() == list(range(1, first + 3))
    assert set(table) == {"id", "px", "py", "radius", "fx", "fy", "torque"} | ({"nx", "ny"} if walled else set())
    for row, ring in enumerate(simulation.model.rings, start=first):
        assert (table["px"][row], table["py"][row]) == (10.0, 10.0)
        assert table["radius"][row] == pytest.approx({"inner": 3.0, "outer": 8.0}[ring.name], rel=1e-14)
        mine = contacts["j"] == -(row + 1)
        assert mine.sum() > 5
        px, py, fx, fy = (contacts[name][mine] for name in ("px", "py", "fx", "fy"))
        assert -fx.sum() == pytest.approx(table["fx"][row], abs=1e-9)
        assert -fy.sum() == pytest.approx(table["fy"][row], abs=1e-9)
        torque = -((px - 10.0) * fy - (py - 10.0) * fx).sum()
        assert torque == pytest.approx(table["torque"][row], abs=1e-9)
    if walled:
        assert np.isnan(table["radius"][:2]).all()
        assert np.isnan(table["torque"][:2]).all()
        assert np.isnan(table["nx"]).tolist() == [False, False, True, True]
    assert len(particle_table(simulation)["id"]) == simulation.model.particle_count


def test_contact_rows_with_glued_discs(dem, annulus):
    """One contact, slipping: the force at the full step on i, the point R_i - overlap/2 from i, the spring."""
    m = dem.model([[5.0, 1.4]], v=[[0.1, -0.2]], spin=[0.5], gn=3.0, mu=10.0, gt=2.0, kt=500.0, convention="talk",
                  rings=(annulus.ring("r", 5.0, omega=2.0, count=1),))
    simulation = dem.run(Simulation(m), 7)
    table, s = contact_table(simulation), simulation.state
    branch = s.x[:, 0] - s.x[:, 1]
    distance = math.hypot(*branch)
    n, overlap = branch / distance, 1.5 - distance
    across, v = np.array([-n[1], n[0]]), s.v[:, 0] - s.v[:, 1]
    assert (table["i"].tolist(), table["j"].tolist()) == ([1.0], [-1.0])
    assert table["overlap"][0] == pytest.approx(overlap)
    np.testing.assert_allclose([table["px"][0], table["py"][0]], s.x[:, 0] - (1.0 - overlap / 2) * n, rtol=1e-14)
    slip = v @ across - (1.0 - overlap / 2) * s.spin[0, 0] - (0.5 - overlap / 2) * 2.0
    spring = np.array([table["ux"][0], table["uy"][0]]) @ across
    assert abs(spring) > 1e-4
    expected = (dem.KN * overlap - 3.0 * (v @ n)) * n - (500.0 * spring + 2.0 * slip) * across
    np.testing.assert_allclose([table["fx"][0], table["fy"][0]], expected, rtol=1e-11)


def test_series_of_rings(dem, annulus, tmp_path):
    m = annulus.between(omegas=(0.8, None), centre=(10.0, 10.0), walls=planes(dem, ())[:1], **FRICTION)
    series, simulation = SeriesWriter(tmp_path / "series.csv", m), fastest(m)
    simulation.advance(30)
    series.write(simulation)
    series.close()
    header, row = (line.split(",") for line in (tmp_path / "series.csv").read_text().splitlines())
    wall = [f"x0_{q}" for q in ("d", "v", "fx", "fy")]
    assert header == ["step", "time", *wall, *(f"{r}_{q}" for r in ("inner", "outer")
                                                for q in ("angle", "torque", "fx", "fy"))]
    got, loads = dict(zip(header, map(float, row), strict=True)), ring_loads(simulation)
    assert (got["inner_angle"], got["outer_angle"]) == (0.8 * simulation.time, 0.0)
    for name, load in zip(("inner", "outer"), loads, strict=True):
        assert (got[f"{name}_torque"], got[f"{name}_fx"], got[f"{name}_fy"]) == (load.torque, *load.force)
        assert abs(load.torque) > 1e-3
