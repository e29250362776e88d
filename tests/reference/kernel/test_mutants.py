"""Physics in a few named checks that the kernel passes, and wrong physics that each of them must catch."""

import dataclasses
import math

import numpy as np
import pytest

from reference.analytic.linear_collision import LinearCollision
from reference.kernel import interactions, neighbours, simulation, walls
from reference.kernel.laws import (
    law,
    linear,
    slider,
)
from reference.kernel.model import Cosine, Loaded

# --- checks ----------------------------------------------------------------------------------------


def check_restitution(dem):
    """Head on, with damping: e = exp(-pi b/w), to the error of the step."""
    m = dem.model([[0.0, 0.0], [2.001, 0.0]], v=[[1.0, 0.0], [-1.0, 0.0]], gn=20.0, dt=dem.tc / 400)
    v = dem.run(dem.Simulation(m), 800).state.v[0]
    closed = LinearCollision(stiffness=dem.KN, damping=20.0, reduced_mass=0.5)
    assert (v[1] - v[0]) / 2.0 == pytest.approx(closed.restitution("allowed"), abs=5e-3)


def check_no_attraction(dem):
    """With attraction clipped no contact force pulls: a head-on pair never slows down again."""
    m = dem.model([[0.0, 0.0], [2.001, 0.0]], v=[[1.0, 0.0], [-1.0, 0.0]], gn=60.0, clip=True)
    s, last = dem.Simulation(m), -2.0
    for _ in range(150):
        s.advance()
        apart = s.state.v[0, 1] - s.state.v[0, 0]
        assert apart >= last - 1e-13
        last = apart
    assert last > 0.5


def check_contact_time(dem):
    """Elastic: apart again after pi sqrt(m*/k), and not before."""
    m = dem.model([[0.0, 0.0], [2.0, 0.0]], v=[[1.0, 0.0], [-1.0, 0.0]], dt=dem.tc / 200)
    s, touching = dem.Simulation(m), 0
    for _ in range(500):
        s.advance()
        touching += len(s.interactions[0].last.f_n)
    assert touching * m.dt == pytest.approx(dem.tc, rel=1e-2)


def check_momentum(dem):
    m = dem.cluster(1, 2, periodic=(6.5, 6.5), mu=0.5, gn=5.0, gt=2.0)
    v = dem.run(dem.Simulation(m), 200).state.v
    assert np.abs((m.mass * (v - m.v)).sum(axis=1)).max() < 1e-12
    assert np.abs(v - m.v).max() > 0.1


def check_angular_momentum(dem):
    """Two discs that rub: the torque of friction and its lever arms balance the orbital part."""
    m = dem.model([[0.0, 0.0], [1.99, 0.0]], v=[[0.3, 1.0], [-0.3, -1.0]], spin=[[2.0], [-0.5]], mu=0.5)
    s = dem.Simulation(m)
    before = dem.angular_momentum(s)[2]
    dem.run(s, 100)
    assert np.abs(s.state.spin[0] - m.spin[0]).max() > 0.1
    assert dem.angular_momentum(s)[2] == pytest.approx(before, abs=1e-12)


def check_rolling(dem):
    """A thrown disc ends at 2/3 v0, rolling forwards."""
    floor = dem.wall("floor", (0.0, 0.0), (0.0, 1.0), friction=True)
    m = dem.model([[0.0, 0.999]], v=[[1.0, 0.0]], mu=0.5, gt=60.0, gravity=(0.0, -10.0), walls=[floor], dt=dem.tc / 20)
    s = dem.run(dem.Simulation(m), 300).state
    assert s.v[0, 0] == pytest.approx(2.0 / 3.0, rel=1e-3)
    assert s.spin[0, 0] == pytest.approx(-2.0 / 3.0, rel=1e-3)


def prescribed(dem, **options):
    """Two discs moved by hand: `place(x2, v2, turning)` evaluates one step and returns the tangential force on 1."""
    s = dem.Simulation(dem.model([[0.0, 0.0], [1.99, 0.0]], **options))

    def place(x, v, turning=0.0):
        s.state.x[:, 1], s.state.v[:, 1], s.state.spin[:] = x, v, turning
        s.renew_candidates()
        s.evaluate(advance=True)
        n = -np.array(x) / np.linalg.norm(x)
        force = s.state.force[:, 0]
        return force - (force @ n) * n, n

    return place, s.model.dt


def check_spring_turns_with_the_pair(dem):
    """Objectivity: loaded, then turned rigidly by 90 degrees, the force keeps its size and turns along."""
    place, dt = prescribed(dem, mu=5.0)
    place([1.99, 0.0], [0.0, 4.0])
    loaded, _ = place([1.99, 0.0], [0.0, 0.0])
    assert abs(loaded[1]) > 1.0
    rate = math.pi / 2 / 100 / dt
    for k in range(1, 101):
        angle = math.pi / 2 * k / 100
        x = 1.99 * np.array([math.cos(angle), math.sin(angle)])
        force, _ = place(x, rate * np.array([-x[1], x[0]]), rate)
    np.testing.assert_allclose(force, [-loaded[1], loaded[0]], rtol=0, atol=1e-9)


def check_friction_loop(dem):
    """Slide 20 elastic lengths, then back: the force follows -mu f_n + k_t s at once, up to +mu f_n."""
    mu = 0.3
    limit = mu * dem.KN * 0.01
    place, dt = prescribed(dem, mu=mu)
    elastic = limit / (2.0 / 7.0 * dem.KN)
    speed = elastic / 10.0 / dt
    forwards = [place([1.99, 0.0], [0.0, speed])[0][1] for _ in range(200)]
    backwards = [place([1.99, 0.0], [0.0, -speed])[0][1] for _ in range(40)]
    assert forwards[-1] == pytest.approx(limit, rel=1e-9)  # disc 2 drags disc 1 along
    expected = [max(limit - 0.1 * limit * k, -limit) for k in range(40)]
    np.testing.assert_allclose(backwards, expected, rtol=0, atol=0.11 * limit)


def check_plain(dem):
    """A rubbing, damped crowd between rough and smooth walls against the plain DEM."""
    m = dem.cluster(7, 2, squeeze=0.8, speed=3.0, walls=dem.box(5.2, 2, friction=("x0",)), mu=0.4, gn=12.0, gt=5.0)
    s, plain = dem.Simulation(m), dem.Plain(m)
    for _ in range(60):
        s.advance()
        plain.advance()
    np.testing.assert_allclose(s.state.v[:, :9].T, np.array(plain.v)[:, :2], rtol=0, atol=1e-10)
    np.testing.assert_allclose(s.state.spin[0, :9], np.array(plain.w)[:, 2], rtol=0, atol=1e-10)


def check_boundary(dem):
    """Two discs that touch across the periodic boundary repel each other."""
    m = dem.model([[0.5, 0.0], [9.0, 0.0]], periodic=(10.0, 0.0))
    assert dem.run(dem.Simulation(m), 5).state.v[0, 0] > 0.1


def check_fast_particle(dem):
    """Three skins a step towards a resting one, listed or not."""
    m = dem.model([[0.0, 0.0], [8.0, 0.0]], v=[[700.0, 0.0], [0.0, 0.0]], kn=4e6)
    assert abs(dem.run(dem.Simulation(m), 30).state.v[0, 1]) > 1.0


def check_old_springs_are_forgotten(dem):
    place, _ = prescribed(dem, mu=5.0)
    place([1.99, 0.0], [0.0, 5.0])
    place([2.01, 0.0], [0.0, 0.0])
    force, _ = place([1.99, 0.0], [0.0, 0.0])
    assert not force.any()


def check_free_fall_with_drag(dem):
    m = dem.model([[0.0, 0.0]], v=[[3.0, 0.0]], gravity=(0.0, -10.0), drag=2.0, dt=1e-3)
    s = dem.run(dem.Simulation(m), 1000).state
    assert s.v[0, 0] == pytest.approx(3.0 * math.exp(-2.0), rel=5e-3)
    assert s.v[1, 0] == pytest.approx(-5.0 * (1.0 - math.exp(-2.0)), rel=5e-3)


def check_loaded_wall(dem):
    """m d'' = stress * height - gamma d' without particles: d' = u (1 - exp(-gamma t/m)), u = stress * height/gamma."""
    side = dem.wall("side", (90.0, 0.0), (-1.0, 0.0),
                    motion=Loaded(mass=2.0, load=0.0, stress=3.0, span=(0, 1), damping=4.0))
    walls = [dem.wall("bottom", (0.0, 0.0), (0.0, 1.0)), dem.wall("top", (0.0, 5.0), (0.0, -1.0)), side]
    s = dem.run(dem.Simulation(dem.model([[2.0, 2.0]], walls=walls, dt=1e-3)), 500).state
    assert s.wall_rate[2] == pytest.approx(15.0 / 4.0 * (1.0 - math.exp(-1.0)), rel=2e-3)
    assert s.x[0, 3] == pytest.approx(90.0 - s.wall_d[2])


def check_driven_wall(dem):
    top = dem.wall("top", (0.0, 9.0), (0.0, -1.0), motion=Cosine(travel=2.0, duration=0.1))
    s = dem.run(dem.Simulation(dem.model([[2.0, 2.0]], walls=[top], dt=1e-3)), 50).state
    assert s.x[1, 1] == pytest.approx(8.0)


def check_energy(dem):
    m = dem.cluster(1, 2, periodic=(6.0, 6.0), dt=dem.tc / 100)
    s = dem.Simulation(m)
    before = dem.energy(s)
    assert dem.energy(dem.run(s, 500)) == pytest.approx(before, rel=2e-3)


CHECKS = [value for name, value in list(globals().items()) if name.startswith("check_")]


@pytest.mark.parametrize("check", CHECKS, ids=lambda c: c.__name__)
def test_the_kernel_passes(dem, check):
    check(dem)


# --- mutants ---------------------------------------------------------------------------------------

MOVE, NORMAL, TALK = slider.Slider.move, law.NormalLaw.force, slider._ALGORITHMS["talk"]
CROSS, SPIN = interactions.torque_cross, interactions.spin_cross
LOADED, KICK = walls.MovingWalls.acceleration, simulation.Simulation._kick
ALGORITHMS, LINEAR, INTERACTION = slider._ALGORITHMS, linear.LinearNormal, interactions.Interaction


def frictionless(self, memory, rate, base, n, dt, *, advance, mean_rate=None):
    return np.zeros_like(rate), memory


def uncut(s, c, advance):
    force, _, slides = TALK(s, c, advance)
    return force, c.xi + c.stretch, slides


def spring_after_sliding_lost(s, c, advance):
    force, spring, slides = TALK(s, c, advance)
    return force, np.where(slides, 0.0, spring), slides


def unlimited(s, c, advance):
    return -s.stiffness * c.xi - s.damping * c.rate, c.xi + c.stretch, c.rate[0] > np.inf


def damping_that_drives(self, contact, memory):
    return NORMAL(self, dataclasses.replace(contact, v_n=-contact.v_n), memory)


def stiffness_doubled(self, contact, memory):
    return 2.0 * self.normal_stiffness * contact.overlap, memory


def never_clipped(self, contact, memory):
    return NORMAL(dataclasses.replace(self, attraction="allowed"), contact, memory)


def one_sided(self, forces, force, torque):
    for axis, component in enumerate(forces.force):
        force[axis] += np.bincount(forces.contact.i, component, force.shape[1])


def no_image(m, x, i, j):
    return x.take(i, axis=1) - x.take(j, axis=1)


def memory_kept(self, touching, memory):
    for family, kept in self.memory.items():
        kept[:, touching] = memory[family]


def loads_pull(self, wall):
    return -LOADED(self, wall)


def half_an_arm(radius_i, radius_j, overlap, arm):
    return 0.5 * radius_i, 0.5 * radius_j


def full_radius(radius_i, radius_j, overlap, arm):
    return radius_i, radius_j


def no_turning(spin, n):
    return 0.0 * SPIN(spin, n)


def whole_kick(self):
    KICK(self)
    KICK(self)


def wall_the_other_way(self, time):
    return -self.travel * math.sin(0.5 * math.pi * min(time / self.duration, 1.0)) ** 2


MUTANTS = {
    "friction dropped": (slider.Slider, "move", frictionless, check_friction_loop),
    "friction dropped, floor": (slider.Slider, "move", frictionless, check_rolling),
    "Coulomb limit dropped": (ALGORITHMS, "talk", unlimited, check_friction_loop),
    "torque of the wrong sign": (interactions, "torque_cross", lambda a, f: -CROSS(a, f), check_angular_momentum),
    "torque of the wrong sign, floor": (interactions, "torque_cross", lambda a, f: -CROSS(a, f), check_rolling),
    "torque dropped": (interactions, "torque_cross", lambda a, f: 0.0 * CROSS(a, f), check_rolling),
    "slip of the wrong sign": (interactions, "spin_cross", lambda w, n: -SPIN(w, n), check_rolling),
    "spins not in the slip": (interactions, "spin_cross", no_turning, check_rolling),
    "spring not turned": (slider, "_rescaled", lambda turned, old: old, check_spring_turns_with_the_pair),
    "spring shortened as it turns": (
        slider, "_rescaled", lambda turned, old: turned, check_spring_turns_with_the_pair),
    "spring not cut on sliding": (ALGORITHMS, "talk", uncut, check_friction_loop),
    "spring lost on sliding": (ALGORITHMS, "talk", spring_after_sliding_lost, check_friction_loop),
    "spring kept after opening": (
        neighbours.CandidateList, "remember", memory_kept, check_old_springs_are_forgotten),
    "lever arm R": (interactions, "_arms", full_radius, check_angular_momentum),
    "lever arm halved": (interactions, "_arms", half_an_arm, check_plain),
    "damping of the wrong sign": (LINEAR, "force", damping_that_drives, check_restitution),
    "attraction not clipped": (LINEAR, "force", never_clipped, check_no_attraction),
    "stiffness doubled": (LINEAR, "elastic", stiffness_doubled, check_contact_time),
    "no reaction": (INTERACTION, "add_to", one_sided, check_momentum),
    "no nearest image": (interactions, "branch_vectors", no_image, check_boundary),
    "list never renewed": (simulation.Simulation, "renew_candidates", lambda self: None, check_fast_particle),
    "springs lost in a rebuild": (
        neighbours, "_carried", lambda old_key, old, key: np.zeros((len(old), len(key))), check_plain),
    "kick doubled": (simulation.Simulation, "_kick", whole_kick, check_energy),
    "kick doubled, falling": (simulation.Simulation, "_kick", whole_kick, check_free_fall_with_drag),
    "loads of the wrong sign": (walls.MovingWalls, "acceleration", loads_pull, check_loaded_wall),
    "drive of the wrong sign": (Cosine, "displacement", wall_the_other_way, check_driven_wall),
}


@pytest.mark.parametrize("name", MUTANTS)
def test_wrong_physics_is_caught(dem, name, monkeypatch):
    place, attribute, wrong, check = MUTANTS[name]
    put = monkeypatch.setitem if isinstance(place, dict) else monkeypatch.setattr
    put(place, attribute, wrong)
    with pytest.raises(AssertionError):
        check(dem)


def test_every_check_catches_something():
    assert {check for *_, check in MUTANTS.values()} == set(CHECKS)
