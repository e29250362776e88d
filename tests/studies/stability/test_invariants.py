"""Every invariant holds on a motion that is known exactly, and is broken by a mutant of it."""

import numpy as np
import pytest

from harness.scene.contact import HystereticNormal
from harness.scene.expect import Twin
from harness.scene.system import Constant, Loaded, Wall
from harness.studies.stability.invariants import KINDS
from harness.studies.stability.seen import NotKnown

TIME = 0.1 * np.arange(41)
FLOOR = Wall(index=1, name="floor", point=(0.0, 0.0), normal=(0.0, 1.0), friction=False)


def swing(states, grow=0.0):
    """A disc of 1 kg on the spring of a plane, 0.1 m deep at most and never leaving it; grow: of amplitude."""
    omega, depth = np.sqrt(states.stiffness), 0.1 * (1 + grow * TIME)
    y = 1.0 - depth * np.cos(omega * TIME)
    v = depth * omega * np.sin(omega * TIME)
    return states.seen(_along_y(y), v=_along_y(v), walls=(_sprung_floor(),))


def _sprung_floor():
    return FLOOR


def _along_y(values):
    return np.stack([np.zeros_like(values), values], axis=1)[:, None, :]


def pushed(states, grow=0.0):
    """The same where the disc is always pressed: it swings between no overlap and 0.2 m under its weight."""
    omega, rest = np.sqrt(states.stiffness), 0.1
    depth = rest + rest * (1 + grow * TIME) * np.cos(omega * TIME)
    y, v = 1.0 - depth, rest * (1 + grow * TIME) * omega * np.sin(omega * TIME)
    return states.seen(_along_y(y), v=_along_y(v), walls=(FLOOR,), gravity=(0.0, -rest * states.stiffness))


def turning_pair(states, wobble=0.0, spin=0.0):
    """Two discs turn about each other once a second, at a distance of 1.9 m."""
    angle = 2 * np.pi * TIME
    arm = 0.95 * (1 + wobble * TIME)[:, None] * np.stack([np.cos(angle), np.sin(angle)], axis=1)
    v = 2 * np.pi * np.stack([-arm[:, 1], arm[:, 0]], axis=1)
    spins = np.stack([2 * np.pi + spin * TIME, np.full_like(TIME, 2 * np.pi)], axis=1)[:, :, None]
    return states.seen(np.stack([-arm, arm], axis=1), v=np.stack([-v, v], axis=1), spin=spins)


def flying(states, push=0.0):
    """Three discs fly apart under their weight."""
    v0 = np.array([[1.0, 0.0], [-1.0, 2.0], [0.0, 5.0]])
    g = np.array([0.0, -10.0])
    t = TIME[:, None, None]
    v = v0 + g * t + push * t
    x = np.array([[0.0, 0.0], [9.0, 0.0], [20.0, 0.0]]) + v0 * t + g * t**2 / 2 + push * t**2 / 2
    return states.seen(x, v=v, gravity=(0.0, -10.0))


def meeting(states, e=1.0, through=False):
    """Two discs meet head on at t = 2 and part with e times their speed; they touch for an instant."""
    x = np.where(TIME <= 2.0, 3.0 - TIME, 1.0 + e * (TIME - 2.0) * (-1.0 if through else 1.0))
    v = np.where(TIME <= 2.0, -1.0, -1.0 if through else e)
    flat = np.zeros_like(TIME)
    places, speeds = (np.stack([np.stack([s * y, flat], axis=1) for s in (-1.0, 1.0)], axis=1) for y in (x, v))
    return states.seen(places, v=speeds)


def stack(states, off=0.0):
    """Three discs of 1, 2 and 4 kg stand in balance under 1 m/s^2; contacts as an engine tells them."""
    weights = np.array([7.0, 6.0, 4.0])
    depth = weights / states.stiffness
    y = np.array([1.0 - depth[0], 0.0, 0.0])
    y[1], y[2] = y[0] + 2 - depth[1], y[0] + 4 - depth[1] - depth[2] + off
    contacts = {
        "i": np.array([1.0, 2.0, 3.0]), "j": np.array([-1.0, 1.0, 2.0]), "px": np.zeros(3), "py": np.zeros(3),
        "fx": np.zeros(3), "fy": weights * (1 + off), "overlap": depth,
    }
    x = np.repeat(np.stack([np.zeros(3), y], axis=1)[None], 3, axis=0)
    return states.seen(x, mass=[1.0, 2.0, 4.0], walls=(FLOOR,), gravity=(0.0, -1.0), contacts=contacts)


def slowing(states, kick=0.0):
    """A disc that only loses speed, but for a kick at the end."""
    v = np.exp(-TIME)
    v[-1] += kick
    return states.seen(_along_y(5.0 - np.exp(-TIME)), v=_along_y(v))


def pressed_wall(states, missing=0.0):
    """A wall pressed with 3 N, carried by a disc."""
    wall = Wall(index=1, name="press", point=(0.0, 0.0), normal=(0.0, 1.0), friction=False,
                motion=Loaded(mass=1.0, load=3.0, stress=0.0, span=None, damping=0.0))
    zero, count = np.zeros_like(TIME), len(TIME)
    series = {"step": np.arange(count, dtype=float), "time": TIME, "press_d": zero, "press_v": zero, "press_fx": zero,
              "press_fy": np.full(count, -3.0 * (1 - missing))}
    return states.seen(_along_y(np.full(count, 0.97)), walls=(wall,), series=series)


def swinging(states, walk=0.0):
    """Forty swings, seen at forty-one times that are no multiple of the period; walk: of the middle, in amplitudes."""
    t = np.linspace(0.0, 40.0, 400)
    x = np.sin(2.2 * t) + walk * t / t[-1]
    return states.seen(np.stack([x, np.zeros_like(x)], axis=1)[:, None, :])


def triangles(states, missing=0):
    """Six discs in a ring of six contacts, each held by three walls' contacts: twelve contacts, two a disc."""
    i = np.concatenate([np.arange(1.0, 7.0), np.arange(1.0, 7.0)])
    j = np.concatenate([np.roll(np.arange(1.0, 7.0), -1), -np.ones(6)])
    if missing:
        i, j = np.append(i, [1.0, 2.0, 3.0]), np.append(j, [4.0, 5.0, 6.0])
    zero = np.zeros(len(i))
    contacts = {"i": i, "j": j, "px": zero, "py": zero, "fx": zero, "fy": zero, "overlap": zero + 0.01}
    x = np.stack([3 * np.arange(6.0), np.zeros(6)], axis=1)
    return states.seen(np.repeat(x[None], 3, axis=0), contacts=contacts)


def diagonal(states, off=0.0):
    s = 5.0 - TIME
    return states.seen(np.stack([s, s + off * TIME], axis=1)[:, None, :])


def leapfrogs(states, error=0.0):
    """Three discs on a circle of 4.5 m, always pressed, as velocity Verlet moves them; error: of late forces."""
    x, v, frames = np.array([0.0, 1.5, 3.0]), np.array([0.1, 0.0, -0.1]), []

    def force(x):
        gap = np.roll(x, -1) - x + np.array([0.0, 0.0, 4.5])
        push = states.stiffness * (2.0 - gap)
        return np.roll(push, 1) - push

    for k in range(30):
        frames.append((x, v))
        half = v + 0.05 * force(x)
        x = x + 0.1 * half
        v = half + 0.05 * force(x) * (1 + error * (k >= 20))
    flat = np.zeros_like(x)
    places, speeds = (np.array([np.stack([f[k], flat], axis=1) for f in frames]) for k in (0, 1))
    return states.seen(places, v=speeds, periodic=(4.5, 0.0))


SKEW = np.array([2.0, 3.0, 6.0]) / 7.0
ACROSS = np.array([6.0, 2.0, -3.0]) / 7.0


def turning_cluster(states):
    """Four spheres turn about (2, 3, 6)/7 once a second as one body; the line from 1 to 2 is at right angles to it."""
    third = np.cross(SKEW, ACROSS)
    start = np.array([ACROSS + SKEW, SKEW - ACROSS, third - SKEW, -third - SKEW])
    along = np.outer(start @ SKEW, SKEW)
    angle = 2 * np.pi * TIME[:, None, None]
    x = along + np.cos(angle) * (start - along) + np.sin(angle) * np.cross(SKEW, start)
    v = 2 * np.pi * np.cross(SKEW, x)
    return states.seen(x, v=v, spin=np.broadcast_to(2 * np.pi * SKEW, x.shape))


EXACT = {
    "finite": (turning_pair, lambda s: s.altered(turning_pair(s), 3, vx=lambda v: v * np.nan)),
    "contained": (turning_pair, lambda s: s.without_last(turning_pair(s), 7)),
    "meets": (turning_pair, flying),
    "overlap": (flying, lambda s: s.altered(flying(s), 2, x=lambda x: 0 * x, y=lambda y: 0 * y)),
    "energy": (pushed, lambda s: pushed(s, grow=0.01)),
    "neighbouring_energy": (leapfrogs, lambda s: leapfrogs(s, error=1e-3)),
    "energy_drift": (pushed, lambda s: pushed(s, grow=0.01)),
    "energy_not_created": (pushed, lambda s: pushed(s, grow=0.01)),
    "energy_falls": (slowing, lambda s: slowing(s, kick=0.1)),
    "kinetic_kept": (meeting, lambda s: meeting(s, e=1.001)),
    "momentum": (flying, lambda s: flying(s, push=1e-3)),
    "angular_momentum": (turning_pair, lambda s: turning_pair(s, spin=1e-3)),
    "residual": (stack, lambda s: stack(s, off=1e-3)),
    "quiet": (stack, lambda s: s.altered(stack(s), -1, vx=lambda v: v + 0.1)),
    "column": (stack, lambda s: stack(s, off=1e-3)),
    "wall_load": (pressed_wall, lambda s: pressed_wall(s, missing=0.01)),
    "isostatic": (triangles, lambda s: triangles(s, missing=3)),
    "free_flight": (flying, lambda s: flying(s, push=1e-3)),
    "restitution": (meeting, lambda s: meeting(s, e=0.9)),
    "order": (meeting, lambda s: meeting(s, through=True)),
    "rigid": (turning_pair, lambda s: turning_pair(s, wobble=1e-3)),
    "on_diagonal": (diagonal, lambda s: diagonal(s, off=1e-3)),
}
"""By name: the motion that has it, and a mutant that does not."""

WITH_VALUES = {
    "end_velocities": (meeting, lambda s: meeting(s, e=0.9), {"values": (-1.0, 0.0, 1.0, 0.0)}),
    "turns": (turning_pair, lambda s: s.altered(turning_pair(s), 3, vx=lambda v: 2 * v, vy=lambda v: 2 * v),
              {"values": (4.0,)}),
}


@pytest.mark.parametrize("name", EXACT)
def test_it_holds_where_it_must_and_a_mutant_breaks_it(states, name):
    good, mutant = EXACT[name]
    measure, promise = KINDS[name].measure, states.promise(name)
    assert measure(good(states), promise) <= 1e-9
    assert not measure(mutant(states), promise) <= 1e-6


@pytest.mark.parametrize("name", WITH_VALUES)
def test_closed_forms_with_values(states, name):
    good, mutant, more = WITH_VALUES[name]
    assert KINDS[name].measure(good(states), states.promise(name, **more)) <= 1e-9
    assert KINDS[name].measure(mutant(states), states.promise(name, **more)) > 1e-3


def test_a_swing_that_walks_is_found(states):
    measure, promise = KINDS["no_ratchet"].measure, states.promise("no_ratchet")
    assert measure(swinging(states), promise) < 0.02
    assert measure(swinging(states, walk=0.5), promise) > 0.3


def test_every_invariant_has_a_motion_here():
    assert set(KINDS) == {*EXACT, *WITH_VALUES, "no_ratchet", "twin"}


# --- in space ---------------------------------------------------------------------------------------------

OF_CLUSTERS = {"turns": {"values": (4.0 * SKEW[2],)}, "rigid": {}, "angular_momentum": {}, "momentum": {}}


@pytest.mark.parametrize("name", OF_CLUSTERS)
def test_a_cluster_may_turn_about_any_axis(states, name):
    assert KINDS[name].measure(turning_cluster(states), states.promise(name, **OF_CLUSTERS[name])) <= 1e-9


@pytest.mark.parametrize("axis", "xyz")
def test_no_component_is_overlooked_in_space(states, axis):
    run, measure = turning_cluster(states), {name: KINDS[name].measure for name in OF_CLUSTERS}
    spun = states.altered(run, 7, **{f"w{axis}": lambda w: w + 0.01})
    pushed = states.altered(run, 7, **{f"v{axis}": lambda v: v + 0.01})
    moved = states.altered(run, 7, **{axis: lambda x: x * 1.01})
    assert measure["angular_momentum"](spun, states.promise("angular_momentum")) > 1e-6
    assert measure["momentum"](pushed, states.promise("momentum")) > 1e-6
    assert measure["rigid"](moved, states.promise("rigid")) > 1e-6


@pytest.mark.parametrize("axis", "xyz")
def test_a_sphere_leaves_the_space_diagonal_along_any_axis(states, axis):
    run = states.seen(np.repeat(1.0 + TIME[:, None, None], 3, axis=2))
    off = states.altered(run, 7, **{axis: lambda x: x + 1e-3})
    assert KINDS["on_diagonal"].measure(run, states.promise("on_diagonal")) <= 1e-12
    assert KINDS["on_diagonal"].measure(off, states.promise("on_diagonal")) == pytest.approx(1e-3)


def test_a_sphere_behind_one_of_three_skew_walls_is_lost(states):
    normals = (SKEW, ACROSS, np.cross(SKEW, ACROSS))
    walls = tuple(
        Wall(index=k, name=f"wall{k}", point=(0.0, 0.0, 0.0), normal=tuple(n), friction=False)
        for k, n in enumerate(normals, start=1)
    )
    inside = np.sum(normals, axis=0)
    for n in normals:
        run = states.seen((inside - 1.5 * TIME[:, None] * n)[:, None, :], walls=walls)
        assert KINDS["contained"].measure(run.up_to(0.5), states.promise("contained")) == 0
        assert KINDS["contained"].measure(run, states.promise("contained")) == 1


# --- twins -----------------------------------------------------------------------------------------------


def rescaled(states, run, *, length, time, shift, error=0.0):
    x = np.array([f.x for f in run.frames]) * length + np.array(shift)
    v, spin = np.array([f.v for f in run.frames]) * length / time, np.array([f.spin for f in run.frames]) / time
    return states.seen(x, v=v * (1 + error), spin=spin, radius=run.frames[0].radius * length)


def test_a_twin_differs_by_its_scales_alone(states):
    run = turning_pair(states)
    promise = states.promise("twin", twin=Twin(case="other", length_scale=2.0, time_scale=4.0, shift=(8.0, -8.0)))
    scales = {"length": 2.0, "time": 4.0, "shift": (8.0, -8.0)}
    assert KINDS["twin"].measure(rescaled(states, run, **scales), promise, run) <= 1e-14
    assert KINDS["twin"].measure(rescaled(states, run, **scales, error=1e-6), promise, run) > 1e-7
    with pytest.raises(NotKnown, match="other frames"):
        KINDS["twin"].measure(run.up_to(1.0), promise, run)


# --- energies --------------------------------------------------------------------------------------------


def test_energy_of_a_free_swing_counts_springs_and_motion(states):
    """On its spring the disc's energy is k A^2/2 while it is pressed; above the plane the formula has no spring."""
    run = swing(states)
    assert run.kinetic[0] + run.elastic[0] == pytest.approx(states.stiffness * 0.1**2 / 2)


def test_what_driven_walls_do_is_no_creation(states):
    """A disc taken along by a wall that moves with 2 m/s and pushes with 3 N for 4 s gains 24 J."""
    motion = Constant(velocity=(0.0, 2.0))
    wall = Wall(index=1, name="ram", point=(0.0, 0.0), normal=(0.0, 1.0), friction=False, motion=motion)
    v = np.sqrt(2.0 * 6.0 * TIME)
    series = {"step": np.arange(41.0), "time": TIME, "ram_d": 2 * TIME, "ram_v": np.full(41, 2.0),
              "ram_fx": np.zeros(41), "ram_fy": np.full(41, -3.0)}
    run = states.seen(_along_y(5.0 + TIME), v=_along_y(v), walls=(wall,), series=series)
    assert run.work()[-1] == pytest.approx(24.0)
    assert KINDS["energy_not_created"].measure(run, states.promise("energy_not_created")) <= 1e-12


def test_contacts_with_memory_have_no_potential(states):
    law = HystereticNormal(loading_stiffness=10.0, unloading_stiffness=20.0, adhesion_stiffness=0.0, normal_damping=0.0)
    x = np.array([[[0.0, 0.0], [1.8, 0.0]]] * 3)
    run = states.seen(x, normal=law)
    assert run.at_start == pytest.approx(10.0 * 0.2**2 / 2)
    with pytest.raises(NotKnown, match="no potential"):
        KINDS["energy"].measure(run, states.promise("energy"))


def test_a_run_is_cut_at_until(states):
    run = states.altered(turning_pair(states), 30, x=lambda x: x * np.nan)
    assert KINDS["finite"].measure(run.up_to(2.0), states.promise("finite")) == 0
    assert KINDS["finite"].measure(run, states.promise("finite")) == 2


def test_a_particle_behind_a_wall_is_lost(states):
    run = states.seen(_along_y(1.0 - TIME), walls=(FLOOR,))
    assert KINDS["contained"].measure(run, states.promise("contained")) == 1


def test_overlaps_are_seen_across_a_seam(states):
    x = np.array([[[0.5, 5.0], [9.5, 5.0]]] * 2)
    run = states.seen(x, periodic=(10.0, 0.0))
    assert KINDS["overlap"].measure(run, states.promise("overlap")) == pytest.approx(1.0)


def test_a_nan_is_never_a_small_size(states):
    broken = states.altered(pushed(states), 5, y=lambda y: y * np.nan)
    for name in ("energy", "energy_not_created"):
        assert not KINDS[name].measure(broken, states.promise(name)) <= 1e9


def test_walls_take_momentum(states):
    with pytest.raises(NotKnown, match="walls or drag"):
        KINDS["momentum"].measure(pushed(states), states.promise("momentum"))
