"""Normal laws over drawn histories against scalar formulas, and against the branches of the closed forms."""

import dataclasses

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from reference.analytic.hertz_collision import effective_modulus, hertz_stiffness
from reference.analytic.hysteretic_collision import ConstantUnloading
from reference.kernel.laws.contact import Touching

WORDS = ("linear", "hertz", "hysteretic", "hysteretic_variable", "dmt")
PLASTIC = ("hysteretic", "hysteretic_variable")
QUICK = settings(max_examples=40, deadline=None, derandomize=True)

histories = st.lists(st.tuples(st.floats(1e-6, 0.3), st.floats(-5.0, 5.0)), min_size=1, max_size=12)
contacts = st.lists(st.tuples(histories, st.floats(0.1, 2.0), st.floats(0.1, 2.0)), min_size=1, max_size=3)


def law_of(dem, word, **changes):
    return dem.laws(None, normal=dem.table("normal", word, **changes))["normal"]


def touching(overlap, v_n=0.0, a=0.5, m=0.5):
    overlap, v_n, a, m = (np.array(q, float) for q in np.broadcast_arrays(np.atleast_1d(overlap), v_n, a, m))
    none = np.zeros(len(overlap), int)
    return Touching(i=none, j=none, n=np.zeros((2, len(overlap))), overlap=overlap, v_n=v_n, reduced_radius=a,
                    reduced_mass=m)


def forces_along(law, overlaps):
    """Elastic force at one overlap after the other."""
    memory, forces = np.zeros((law.memory_rows(2), 1)), []
    for overlap in overlaps:
        force, memory = law.elastic(touching(overlap), memory)
        forces.append(force[0])
    return np.array(forces)


@pytest.mark.parametrize("word", WORDS)
@QUICK
@given(contacts, st.booleans())
def test_it_is_the_scalar_formula_over_a_history(dem, word, drawn, clip):
    law = law_of(dem, word)
    if clip and "attraction" in dem.tables["normal", word]:
        law = dataclasses.replace(law, attraction="clipped")
    length = min(len(history) for history, _, _ in drawn)
    a, m = ([c[k] for c in drawn] for k in (1, 2))
    memory, tops = np.zeros((law.memory_rows(2), len(drawn))), [0.0] * len(drawn)
    for step in range(length):
        d, v = ([c[0][step][k] for c in drawn] for k in (0, 1))
        total, elastic, memory = law.force(touching(d, v, a, m), memory)
        expected = [dem.plain.normal(law, *numbers) for numbers in zip(d, v, a, m, tops, strict=True)]
        f_n, f_el, pull, tops = (list(column) for column in zip(*expected, strict=True))
        np.testing.assert_allclose(total, f_n, rtol=1e-12, atol=1e-9)
        np.testing.assert_allclose(elastic, f_el, rtol=1e-12, atol=1e-9)
        adhesion = law.adhesion(touching(d, v, a, m))
        np.testing.assert_allclose(0.0 if adhesion is None else adhesion, pull, rtol=1e-13)
        if law.memory_rows(2):
            np.testing.assert_allclose(memory[0], tops, rtol=1e-12)


@pytest.mark.parametrize("word", ["linear", "hertz"])
def test_attraction_is_clipped_only_where_asked(dem, word):
    contact = touching([0.01, 0.01], [50.0, -50.0])
    free, _, _ = law_of(dem, word).force(contact, None)
    clipped, elastic, _ = law_of(dem, word, attraction="clipped").force(contact, None)
    assert free[0] < 0.0 == clipped[0]
    assert clipped[1] == free[1] > elastic[1] > 0.0


@pytest.mark.parametrize("word", ["linear", "hertz", "dmt"])
def test_the_force_is_the_slope_of_the_stored_energy(dem, word):
    law, overlap, h = law_of(dem, word), np.array([0.05, 0.2]), 1e-5
    slope = (law.energy(touching(overlap + h)) - law.energy(touching(overlap - h))) / (2 * h)
    np.testing.assert_allclose(law.elastic(touching(overlap), None)[0], slope, rtol=1e-8)


def test_hertz_is_the_closed_form(dem):
    law = law_of(dem, "hertz")
    modulus = effective_modulus(young=(3e4, 3e4), poisson=(0.3, 0.3))
    stiffness = hertz_stiffness(effective_modulus=modulus, effective_radius=0.5)
    overlap = np.array([1e-4, 0.03, 0.2])
    np.testing.assert_allclose(law.elastic(touching(overlap), None)[0], stiffness * overlap**1.5, rtol=1e-14)


def test_dmt_pulls_off_with_four_pi_w_a(dem):
    law = law_of(dem, "dmt")
    assert law.elastic(touching(1e-12), None)[0][0] == pytest.approx(-4 * np.pi * 5.0 * 0.5, rel=1e-10)


# --- plastic loops ---------------------------------------------------------------------------------------


def test_one_loop_of_constant_unloading_is_the_closed_form(dem):
    """Up to 0.1 along k_1, back along k_2 and -k_c delta to nothing."""
    law, top = law_of(dem, "hysteretic"), 0.1
    closed = ConstantUnloading(loading=4e3, unloading=1e4, adhesion=2e3, reduced_mass=1.0)
    back = np.linspace(top, 1e-6, 200)
    up = forces_along(law, back[::-1])
    np.testing.assert_allclose(up, 4e3 * back[::-1], rtol=1e-14)
    np.testing.assert_allclose(forces_along(law, [top, *back])[1:], closed.force(back, top), rtol=0, atol=1e-10)


@pytest.mark.parametrize("word", PLASTIC)
def test_the_strongest_pull_and_the_energy_lost(dem, word):
    """A loop costs the energy of the closed form: integral of f over delta, trapezia on a fine grid."""
    law, top = law_of(dem, word), 0.06
    k_2 = 1e4 if word == "hysteretic" else 4e3 + 8e3 * 0.06 / (1.5 * 0.05)
    closed = ConstantUnloading(loading=4e3, unloading=k_2, adhesion=2e3, reduced_mass=1.0)
    path = np.concatenate([np.linspace(1e-9, top, 4001), np.linspace(top, 1e-9, 4001)])
    force = forces_along(law, path)
    assert force.min() == pytest.approx(closed.largest_attraction(top), rel=2e-3)
    lost = ((force[1:] + force[:-1]) / 2 * np.diff(path)).sum()
    brought_in = 0.5 * 4e3 * top**2
    assert lost / brought_in == pytest.approx(1.0 - closed.restitution_squared, rel=2e-3)


@pytest.mark.parametrize("word", PLASTIC)
def test_unloading_and_reloading_are_one_line(dem, word):
    """Below the largest overlap and above the adhesive branch nothing is lost, and loading goes on where it stopped."""
    law, top = law_of(dem, word), 0.05
    swing = np.linspace(top, 0.04, 20)
    forces = forces_along(law, [top, *swing, *swing[::-1], 0.055])
    np.testing.assert_allclose(forces[1:21], forces[40:20:-1], rtol=1e-12)
    assert forces[-1] == pytest.approx(4e3 * 0.055, rel=1e-14)


@pytest.mark.parametrize("word", PLASTIC)
def test_the_adhesive_branch_draws_the_largest_overlap_back(dem, word):
    """Pulled to delta on -k_c delta, then pressed again: along k_2 from there, below the old loading line."""
    law, top, low = law_of(dem, word), 0.06, 0.01
    memory = np.zeros((1, 1))
    for overlap in [top, *np.linspace(top, low, 3000)]:
        force, memory = law.elastic(touching(overlap), memory)
    assert force[0] == pytest.approx(-2e3 * low, rel=1e-12)
    assert low < memory[0, 0] < top
    drawn_back = memory[0, 0]
    assert law.elastic(touching(drawn_back), memory)[0][0] == pytest.approx(4e3 * drawn_back, rel=1e-12)


def test_beyond_the_limit_loading_and_unloading_follow_the_largest_stiffness(dem):
    """k_p (delta - delta*) + k_1 delta*, delta* = k_p/(k_p - k_1) phi_f 2 a* = 0.075, reversible above it."""
    law = law_of(dem, "hysteretic_variable")
    path = np.array([0.075, 0.1, 0.15, 0.1, 0.08])
    np.testing.assert_allclose(forces_along(law, path), 1.2e4 * (path - 0.075) + 4e3 * 0.075, rtol=1e-12)


def test_without_plasticity_or_adhesion_it_is_a_spring(dem):
    law = law_of(dem, "hysteretic", unloading_stiffness=4e3, adhesion_stiffness=0.0)
    path = np.array([0.1, 0.05, 0.01, 0.12])
    np.testing.assert_allclose(forces_along(law, path), 4e3 * path, rtol=1e-14)
    assert law.adhesion(touching(0.1)) is None


def test_what_a_first_loading_would_need(dem):
    for word, expected in (("linear", 1e4 * 0.1), ("hysteretic", 4e3 * 0.1), ("hysteretic_variable", 4e3 * 0.1)):
        assert law_of(dem, word).loading(touching(0.1))[0] == pytest.approx(expected, rel=1e-14)
