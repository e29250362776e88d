"""Closed forms of prescribed motion, each against a second derivation: step by step, or by what is known otherwise."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from reference.analytic import prescribed
from reference.analytic.adhesive_collision import JkrCollision
from reference.analytic.hertz_collision import HertzCollision, damping_factor_for_restitution, hertz_stiffness
from reference.analytic.hysteretic_collision import ConstantUnloading, OverlapUnloading
from reference.analytic.linear_collision import LinearCollision
from reference.analytic.prescribed import ElasticPair, Slider, held

PAIR = ElasticPair(youngs_modulus=1e8, poisson_ratio=0.25, effective_radius=5e-4)
ROWS = st.lists(st.floats(-1.0, 1.0), min_size=1, max_size=60)


def walk(steps, start=0.0) -> np.ndarray:
    return start + np.cumsum(steps)


# --- the operator ------------------------------------------------------------------------------------


@given(ROWS, ROWS)
def test_play_is_what_two_bounds_carry_row_by_row(shift, room):
    count = min(len(shift), len(room))
    middle, half = walk(shift[:count]), np.abs(room[:count])
    value, expected = 0.0, []
    for low, high in zip(middle - half, middle + half, strict=True):
        value = min(max(value, low), high)
        expected.append(value)
    assert held(middle - half, middle + half) == pytest.approx(expected, abs=1e-14)


# --- normal laws ---------------------------------------------------------------------------------------


@pytest.mark.parametrize("damping", [0.0, 0.6])
def test_linear_along_the_path_of_a_collision(damping):
    pair = LinearCollision(stiffness=1e5, damping=damping, reduced_mass=1e-5)
    time = np.linspace(0.01, 0.99, 50) * pair.duration("allowed")
    overlap, rate = pair.motion(time, 0.3)
    found = prescribed.linear_force(overlap, -rate, stiffness=1e5, damping=damping, clipped=False)
    assert found == pytest.approx(pair.force(time, 0.3), rel=1e-12)
    clipped = prescribed.linear_force(overlap, -rate, stiffness=1e5, damping=damping, clipped=True)
    assert clipped == pytest.approx(np.maximum(found, 0.0))


def test_apart_there_is_no_force():
    apart, fast = np.array([-1e-6, 0.0]), np.array([-1.0, -1.0])
    known = {"clipped": False}
    assert not prescribed.linear_force(apart, fast, stiffness=1e5, damping=1.0, **known).any()
    assert not prescribed.hertz_force(apart, fast, pair=PAIR, restitution=0.5, reduced_mass=1e-5, **known).any()
    assert not prescribed.dmt_force(apart, fast, pair=PAIR, surface_energy=1.0, damping=1.0).any()
    branches = {"loading": 1.0, "adhesion": 1.0, "damping": 1.0}
    assert not prescribed.hysteretic_force(apart, fast, unloading=2.0, **branches).any()
    assert not prescribed.variable_hysteretic_force(apart, fast, limit=2.0, limit_overlap=1.0, **branches).any()


def test_hertz_is_the_slope_of_its_energy_with_the_dashpot_of_its_restitution():
    overlap, rate = np.linspace(1e-6, 5e-5, 20), np.linspace(-1.0, 1.0, 20)
    stiffness = hertz_stiffness(effective_modulus=PAIR.effective_modulus, effective_radius=PAIR.effective_radius)
    twin = HertzCollision(
        stiffness=stiffness, reduced_mass=1e-5, damping_factor=damping_factor_for_restitution(0.6)
    )
    found = prescribed.hertz_force(overlap, -rate, pair=PAIR, restitution=0.6, reduced_mass=1e-5, clipped=False)
    assert found == pytest.approx(twin.force(overlap, rate), rel=1e-12)
    step = 1e-11
    energy = [0.4 * stiffness * (overlap + s) ** 2.5 for s in (step, -step)]
    assert PAIR.normal_force(overlap) == pytest.approx((energy[0] - energy[1]) / (2 * step), rel=1e-5)


@given(ROWS)
@settings(max_examples=60)
def test_hysteretic_by_return_mapping_in_the_force(steps):
    """Elastic trial with k2, then back between the loading and the adhesive line: no largest overlap is kept."""
    k_1, k_2, k_c = 1.0, 3.0, 0.7
    overlap = walk(steps, start=0.3)
    expected, before, force = [], 0.0, 0.0
    for d in overlap:
        if d <= 0.0:
            before = force = 0.0
        else:
            force = min(max(force + k_2 * (d - before), -k_c * d), k_1 * d)
            before = d
        expected.append(force)
    found = prescribed.hysteretic_force(
        overlap, np.zeros(len(overlap)), loading=k_1, unloading=k_2, adhesion=k_c, damping=0.0
    )
    assert found == pytest.approx(expected, abs=1e-13)


def test_variable_hysteretic_on_one_cycle_above_and_below_the_limit():
    k_1, k_p, k_c, limit = 1.0, 3.0, 0.7, 2.0
    for largest in (1.2, 2.0, 2.6):
        up = np.linspace(0.1, largest, 30)
        down = up[-2::-1]
        path = np.concatenate([up, down])
        found = prescribed.variable_hysteretic_force(
            path, np.zeros(len(path)), loading=k_1, limit=k_p, adhesion=k_c, damping=0.0, limit_overlap=limit
        )
        twin = OverlapUnloading(
            loading=k_1, limit=k_p, adhesion=k_c, plasticity_depth=1.0, pair_radius=limit * (k_p - k_1) / k_p,
            reduced_mass=1.0,
        )
        branches = ConstantUnloading(
            loading=k_1, unloading=twin.unloading(largest), adhesion=k_c, reduced_mass=1.0
        )
        expected = branches.force(down, min(largest, limit))
        known = ~np.isnan(found[30:])
        assert np.array_equal(known, expected > -k_c * down)
        assert found[30:][known][1:] == pytest.approx(expected[known][1:], abs=1e-13)
        assert found[:30][up <= limit] == pytest.approx(k_1 * up[up <= limit])
        work = twin.largest_overlap(math.sqrt(2 * np.trapezoid(found[:30], up) + k_1 * 0.1**2))
        assert work == pytest.approx(largest, rel=2e-3)


def test_jkr_is_the_curve_through_its_contact_radius():
    twin = JkrCollision(
        effective_modulus=PAIR.effective_modulus, effective_radius=5e-4, reduced_mass=1.0, surface_energy=5.0
    )
    radius = np.linspace(1.001 * twin.tearing_radius, 8 * twin.tearing_radius, 200)
    overlap = np.array([twin.overlap(a) for a in radius])
    touched = np.concatenate([[1e-6], overlap[::-1]])
    found = prescribed.jkr_force(
        touched, np.zeros(201), pair=PAIR, surface_energy=5.0, damping=0.0, tearing_overlap=1.1 * twin.tearing_overlap
    )
    assert found[1:] == pytest.approx([twin.force(a) for a in radius[::-1]], rel=1e-9, abs=1e-12)
    strongest = radius[np.argmin([twin.force(a) for a in radius])]
    place = prescribed.jkr_overlap_of_largest_pull(PAIR, 5.0)
    assert place == pytest.approx(twin.overlap(strongest), rel=0.05)
    assert prescribed.jkr_force(
        np.array([1e-6, place]), np.zeros(2), pair=PAIR, surface_energy=5.0, damping=0.0, tearing_overlap=2 * place
    )[1] == pytest.approx(-twin.pull_off_force, rel=1e-9)


def test_jkr_bodies_hold_on_only_after_they_have_touched():
    path = np.array([-1e-7, 1e-6, -1e-7, -1e-5, -1e-7])
    found = prescribed.jkr_force(
        path, np.zeros(5), pair=PAIR, surface_energy=5.0, damping=0.0, tearing_overlap=-1e-6
    )
    assert (found != 0.0).tolist() == [False, True, True, False, False]


def test_dmt_is_hertz_and_a_constant_pull():
    overlap = np.array([1e-6, 2e-5])
    found = prescribed.dmt_force(overlap, np.array([0.1, -0.1]), pair=PAIR, surface_energy=5.0, damping=2.0)
    assert found == pytest.approx(PAIR.normal_force(overlap) - 4 * math.pi * 5.0 * 5e-4 - [0.2, -0.2])


# --- sliding -------------------------------------------------------------------------------------------


def friction_path(seed: int):
    """A contact of 80 rows with varying rate, limit, stiffness and damping, opened once."""
    rng = np.random.default_rng(seed)
    rate, limit = np.repeat(rng.uniform(-1, 1, 16), 5), 0.3 + 0.2 * np.sin(np.arange(80) / 7.0 + seed)
    overlap = np.where(np.arange(80) == 50, -1.0, 1.0)
    return overlap, rate, limit, 2.0 + 0.5 * np.cos(np.arange(80) / 11.0), np.full(80, 0.1)


def by_rows(overlap, rate, limit, k, gamma, cut: str, *, carried=None, remembers=False):
    """The rules of the codes, row by row, in one dimension, for dt = 0.2."""
    xi, slides, found = 0.0, False, []
    carried = limit if carried is None else carried
    for d, v, most, stiff, damp, rest in zip(overlap, rate, limit, k, gamma, carried, strict=True):
        if d <= 0.0:
            xi, slides = 0.0, False
            found.append(0.0)
            continue
        xi += 0.2 * v
        test = stiff * xi + (damp * v if cut == "total" else 0.0)
        slides = abs(test) > (rest if slides and remembers else most)
        if slides:
            test = math.copysign(rest, test)
            xi = (test - (damp * v if cut == "total" else 0.0)) / stiff
        elif cut == "spring":
            test += damp * v
        found.append(-test)
    return found


@pytest.mark.parametrize("cut", ["total", "spring"])
@pytest.mark.parametrize("seed", range(6))
def test_friction_by_return_mapping(cut, seed):
    overlap, rate, limit, k, gamma = friction_path(seed)
    slider = Slider(stiffness=k, damping=gamma, dt=0.2, cut=cut)
    assert slider.force(overlap, rate, limit) == pytest.approx(by_rows(overlap, rate, limit, k, gamma, cut), abs=1e-13)


@pytest.mark.parametrize("remembers", [True, False])
def test_dynamic_coefficient_row_by_row(remembers):
    overlap, rate = np.ones(90), np.repeat([0.31, -0.31, 0.31], 30)
    limit, carried, nothing = np.full(90, 0.7), np.full(90, 0.5), np.zeros(90)
    slider = Slider(stiffness=1.0, damping=0.0, dt=0.2, cut="total")
    found = slider.dynamic_force(overlap, rate, limit, carried, remembers=remembers)
    expected = by_rows(overlap, rate, limit, np.ones(90), nothing, "total", carried=carried, remembers=remembers)
    assert found == pytest.approx(expected, abs=1e-12)
    assert np.abs(found).max() > 0.6


def test_dynamic_coefficient_is_silent_once_a_sliding_contact_changes_its_limit():
    limit = np.concatenate([np.full(10, 0.5), np.full(5, 0.4)])
    slider = Slider(stiffness=1.0, damping=0.0, dt=1.0, cut="total")
    found = slider.dynamic_force(np.ones(15), np.full(15, 0.2), limit, 0.5 * limit, remembers=True)
    assert np.isnan(found).tolist() == [False] * 10 + [True] * 5


def test_lagging_spring_answers_with_what_it_was():
    rate = np.concatenate([np.full(6, 0.1), np.full(3, -0.1)])
    slider = Slider(stiffness=1.0, damping=0.0, dt=1.0, cut="total")
    found = slider.lagging_force(np.ones(9), rate, np.full(9, 0.25))
    assert found[:6] == pytest.approx([0.0, -0.1, -0.2, -0.25, -0.25, -0.25])
    assert np.isnan(found[6:]).all()
    free = slider.lagging_force(np.ones(9), rate, np.full(9, 9.0))
    assert free == pytest.approx([0, -0.1, -0.2, -0.3, -0.4, -0.5, -0.6, -0.5, -0.4])


def test_viscous_friction_is_cut_at_the_limit():
    found = prescribed.viscous_force(np.array([-2.0, 0.0, 0.1]), np.array([0.5, 0.5, 0.5]), damping=1.0)
    assert found.tolist() == [0.5, 0.0, -0.1]
