"""The closed forms against the integrated law, and against what LIGGGHTS gave."""

import math

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from reference.analytic.hysteretic_collision import ConstantUnloading, OverlapUnloading

MASS, SPEED = 4.2e-6, 0.3
STIFFNESSES = [
    (1e5, 1e5, 0.0), (1e5, 2e5, 0.0), (1e5, 2e5, 4e5), (1e5, 5e5, 1e4), (1e5, 5e5, 3.3e4), (1e5, 1.2e5, 1e7),
]
STICKING = [(1e5, 5e5, 3.4e4), (1e5, 5e5, 1e6), (1e5, 2.1e5, 2e6)]


def law(d, largest, *, k1, k2, kc, shift=math.inf):
    """Luding's cases in the order he prints them; `shift` caps d0 (the plastic limit)."""
    d0 = min((1 - k1 / k2) * largest, shift)
    back = k2 * (d - d0)
    if back >= k1 * d and d0 < shift:
        return k1 * d
    return back if back > -kc * d else -kc * d


def loading(k1, k2, kc, mass, speed, shift=math.inf):
    """Time and size of the largest overlap."""
    scale = speed * math.sqrt(mass / k1)

    def rates(t, y):
        return [y[1], -law(y[0], y[0], k1=k1, k2=k2, kc=kc, shift=shift) / mass]

    def top(t, y):
        return y[1]

    top.terminal = True
    run = solve_ivp(rates, (0, 10 * scale / speed), [0, speed], method="DOP853", rtol=1e-12, atol=1e-15 * scale,
                    events=top)
    return run.t_events[0][0], run.y_events[0][0][0]


def unloading(k1, k2, kc, mass, largest, shift=math.inf):
    """Time and speed of parting, or None if the pair turns round before; in two pieces, either side of d_min."""
    unit = math.sqrt(mass / k1)
    d_min = k2 * min((1 - k1 / k2) * largest, shift) / (k2 + kc)
    state, time = [largest, -1e-300], 0.0
    for end in (d_min, 0.0):

        def rates(t, y):
            return [y[1], -law(y[0], largest, k1=k1, k2=k2, kc=kc, shift=shift) / mass]

        def reached(t, y, end=end):
            return y[0] - end

        def turned(t, y):
            return y[1]

        reached.terminal, reached.direction = True, -1
        turned.terminal, turned.direction = True, 1
        run = solve_ivp(rates, (0, 100 * unit), state, method="DOP853", rtol=1e-12, atol=1e-15 * largest,
                        events=[reached, turned])
        if run.t_events[0].size == 0:
            assert run.t_events[1].size == 1
            return None
        time, state = time + run.t_events[0][0], run.y_events[0][0]
        if end == 0:
            break
    return time, -state[1]


def constant(k1, k2, kc):
    return ConstantUnloading(loading=k1, unloading=k2, adhesion=kc, reduced_mass=MASS)


@pytest.mark.parametrize("stiffnesses", STIFFNESSES)
def test_constant_unloading(stiffnesses):
    pair = constant(*stiffnesses)
    up, largest = loading(*stiffnesses, MASS, SPEED)
    down, speed = unloading(*stiffnesses, MASS, largest)
    assert not pair.sticks
    assert pair.largest_overlap(SPEED) == pytest.approx(largest, rel=1e-9)
    assert pair.restitution == pytest.approx(speed / SPEED, rel=1e-9)
    assert pair.duration == pytest.approx(up + down, rel=1e-9)


@pytest.mark.parametrize("stiffnesses", STICKING)
def test_sticking(stiffnesses):
    pair = constant(*stiffnesses)
    assert unloading(*stiffnesses, MASS, 1e-5) is None
    assert pair.sticks
    assert pair.restitution_squared < 0
    assert pair.restitution == 0.0
    assert pair.duration == math.inf


@pytest.mark.parametrize("k2", [2.05e5, 3e5, 5e5, 5e6])
def test_threshold_of_sticking(k2):
    """A per mille of adhesion to either side decides; below 2 k1 nothing sticks."""
    least = constant(1e5, k2, 0.0).sticking_adhesion
    assert constant(1e5, k2, least).restitution_squared == pytest.approx(0, abs=1e-12)
    assert unloading(1e5, k2, 0.999 * least, MASS, 1e-5) is not None
    assert unloading(1e5, k2, 1.001 * least, MASS, 1e-5) is None
    assert constant(1e5, 1.99e5, 1e12).sticks is False


def test_branches_meet():
    pair = constant(1e5, 5e5, 2e4)
    largest = 1e-5
    d0, d_min = pair.release_overlap(largest), pair.overlap_of_attraction(largest)
    assert pair.force(largest, largest) == pytest.approx(1e5 * largest, rel=1e-12)
    assert pair.force(d0, largest) == pytest.approx(0, abs=1e-12)
    assert pair.force(d_min, largest) == pytest.approx(pair.largest_attraction(largest), rel=1e-12)
    overlap = np.linspace(-1e-6, largest, 400)
    force = pair.force(overlap, largest)
    assert force.min() == pytest.approx(-2e4 * d_min, rel=0.01)
    assert np.all(force[overlap <= 0] == 0)
    assert force[overlap > 0] == pytest.approx(
        [law(d, largest, k1=1e5, k2=5e5, kc=2e4) for d in overlap[overlap > 0]], rel=1e-12
    )


def variable(adhesion):
    return OverlapUnloading(loading=100.0, limit=500.0, adhesion=adhesion, plasticity_depth=0.05, pair_radius=1e-3,
                            reduced_mass=4 / 3 * math.pi * 2000 * 1e-9)


@pytest.mark.parametrize("adhesion", [0.0, 25.0])
@pytest.mark.parametrize("part", [0.05, 0.4, 0.999, 1.001, 1.5, 6.0])
def test_overlap_unloading(adhesion, part):
    """Slower and faster than the speed that reaches the plastic limit."""
    pair = variable(adhesion)
    speed, depth = part * pair.limit_speed, 0.05 * 1e-3
    shift = depth if part > 1 else math.inf
    k2 = 500.0 if part > 1 else pair.unloading(speed * math.sqrt(pair.reduced_mass / 100.0))
    _, largest = loading(100.0, k2, adhesion, pair.reduced_mass, speed, shift)
    _, parting = unloading(100.0, k2, adhesion, pair.reduced_mass, largest, shift)
    assert pair.largest_overlap(speed) == pytest.approx(largest, rel=1e-9)
    assert pair.restitution(speed) == pytest.approx(parting / speed, rel=1e-9)


def test_sticking_speeds():
    pair = variable(50.0)
    low, high = pair.sticking_speeds
    assert 0 < low < pair.limit_speed < high
    for speed, sticks in [(0.999 * low, False), (1.001 * low, True), (0.999 * high, True), (1.001 * high, False)]:
        assert (pair.restitution(speed) == 0) is sticks
        largest = pair.largest_overlap(speed)
        shift = 0.05e-3 if speed > pair.limit_speed else math.inf
        outcome = unloading(100.0, pair.unloading(largest), 50.0, pair.reduced_mass, largest, shift)
        assert (outcome is None) is sticks
    assert variable(0.0).sticking_speeds is None
    assert variable(33.0).sticking_speeds is None


@pytest.mark.parametrize(("adhesion", "measured"), [(0.0, 0.9185369), (100.0, 0.9112957)])
def test_as_measured_in_liggghts(adhesion, measured):
    """LIGGGHTS 3.8.0, model luding, one sphere frozen, 0.01 m/s, time step 1e-6 s."""
    assert variable(adhesion).restitution(0.01) == pytest.approx(measured, rel=2e-6)


@pytest.mark.parametrize("memory", ["kept", "lowered"])
@pytest.mark.parametrize(("adhesion", "speed"), [(100.0, 0.01), (25.0, 0.15), (33.0, 0.21)])
def test_lowered_memory_changes_nothing(adhesion, speed, memory):
    """The largest overlap lowered on the adhesive branch, and k2 evaluated anew."""
    pair = variable(adhesion)
    e, steps_on_branch = stepped(pair, speed, memory)
    assert steps_on_branch > 100
    assert e == pytest.approx(pair.restitution(speed), abs=1e-6)


def stepped(pair, speed, memory, steps=2000):
    """Velocity Verlet with so many steps in the loading half; restitution, and steps on the adhesive branch."""
    k1, kc, mass = pair.loading, pair.adhesion, pair.reduced_mass
    dt = 0.5 * math.pi * math.sqrt(mass / k1) / steps
    d, v, largest, a, adhesive = 0.0, speed, 0.0, 0.0, 0
    while d > 0 or v > 0:
        v += 0.5 * dt * a
        d += dt * v
        largest = max(largest, d)
        k2 = pair.unloading(largest)
        a = -law(d, largest, k1=k1, k2=k2, kc=kc) / mass if d > 0 else 0.0
        if d > 0 and a == kc * d / mass:
            adhesive += 1
            largest = (k2 + kc) / (k2 - k1) * d if memory == "lowered" else largest
        v += 0.5 * dt * a
    return -v / speed, adhesive


def test_the_two_laws_differ():
    """With k2 = kp from the start energy is lost at any speed; with a small plasticity depth none at low speed."""
    pair = variable(0.0)
    assert pair.restitution(1e-6 * pair.limit_speed) == pytest.approx(1, abs=1e-5)
    assert constant(100.0, 500.0, 0.0).restitution == pytest.approx(math.sqrt(0.2), rel=1e-12)


@pytest.mark.parametrize("stiffnesses", [(0.0, 1.0, 0.0), (2.0, 1.0, 0.0), (1.0, 2.0, -1.0)])
def test_impossible_stiffnesses(stiffnesses):
    with pytest.raises(ValueError, match="loading|adhesion"):
        constant(*stiffnesses)


@pytest.mark.parametrize("change", [{"limit": 100.0}, {"adhesion": -1.0}, {"plasticity_depth": 0.0}])
def test_impossible_plasticity(change):
    given = {"loading": 100.0, "limit": 500.0, "adhesion": 0.0, "plasticity_depth": 0.05}
    with pytest.raises(ValueError, match="expected"):
        OverlapUnloading(**(given | change), pair_radius=1e-3, reduced_mass=1.0)
