"""Sticking and sliding against a scalar evaluation of the same words, and the docstring's rules one by one."""

import math
from types import SimpleNamespace

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from reference.kernel.laws.slider import LAMMPS_TURN_THRESHOLD, Slider, memory_rows

ALGORITHMS = ("lammps", "liggghts", "talk")
STATEFUL = ("lammps", "talk")
KT, GT, MU, DT = 4.0, 0.5, 0.5, 0.125
QUICK = settings(max_examples=50, deadline=None, derandomize=True, suppress_health_check=[HealthCheck.filter_too_much])

hundredths = st.integers(-200, 200).map(lambda k: k / 100)
vectors = st.tuples(hundredths, hundredths, hundredths)
drawn_contacts = st.lists(st.tuples(vectors, vectors, vectors, hundredths, st.booleans()), min_size=1, max_size=6)


def slider(algorithm, *, mu=MU, gt=GT, mu_d=None):
    return Slider(algorithm=algorithm, stiffness=KT, damping=gt, friction=mu, dynamic_friction=mu_d)


def column(*vector):
    return np.array(vector, float)[:, None]


def pressed(force):
    return np.array([force])


# --- drawn contacts ----------------------------------------------------------------------------------


@pytest.mark.parametrize("algorithm", ALGORITHMS)
@pytest.mark.parametrize("dim", [2, 3])
@pytest.mark.parametrize("turns", [True, False])
@QUICK
@given(drawn_contacts, st.sampled_from([0.0, 0.1, 0.7]), st.sampled_from([0.0, 0.5]), st.sampled_from([None, 0.05]),
       st.booleans())
def test_it_is_the_scalar_algorithm(dem, algorithm, dim, turns, drawn, mu, gt, mu_d, advance):
    mu_d = mu_d if mu_d is None or mu_d < mu else mu
    contacts = [c for c in (contact_of(dim, *numbers) for numbers in drawn) if c and clear(c, mu, mu_d, gt)]
    if contacts:
        compare(dem, slider(algorithm, mu=mu, gt=gt, mu_d=mu_d), dim, contacts, turns, advance)


def compare(dem, chosen, dim, contacts, turns, advance):
    xi, n, v = (np.array([getattr(c, name)[:dim] for c in contacts]).T for name in ("xi", "n", "v"))
    base = np.array([c.base for c in contacts])
    stateful = memory_rows(dim, chosen.algorithm, chosen.dynamic_friction) > dim
    memory = np.vstack([xi, [[float(c.slid) for c in contacts]]]) if stateful else xi
    force, left = chosen.move(memory, v, base, n if turns else None, DT, advance=advance)
    for k, c in enumerate(contacts):
        numbers = dem.plain.numbers(KT, chosen.damping, chosen.friction, c.base, chosen.dynamic_friction)
        f, (u, slid), _ = dem.plain.slide(
            chosen.algorithm, (c.xi, c.slid and stateful), numbers, c.n if turns else None, c.v, DT, advance)
        np.testing.assert_allclose(force[:, k], f[:dim], rtol=0, atol=2e-12)
        np.testing.assert_allclose(left[:dim, k], u[:dim], rtol=0, atol=2e-12)
        if stateful:
            assert left[-1, k] == slid


@QUICK
@given(st.lists(st.tuples(hundredths, hundredths, hundredths), min_size=1, max_size=6), st.booleans())
def test_twisting_is_the_scalar_algorithm(dem, drawn, advance):
    for xi, v, base in drawn:
        numbers = dem.plain.numbers(KT, GT, MU, abs(base))
        test = abs(KT * (xi + (DT * v if advance else 0.0)) + GT * v)
        if abs(test - MU * abs(base)) < 1e-9:
            continue
        f, (u, _), _ = dem.plain.slide("lammps_twisting", ([xi], False), numbers, None, [v], DT, advance)
        force, left = slider("lammps_twisting").move(
            column(xi), column(v), pressed(abs(base)), None, DT, advance=advance)
        np.testing.assert_allclose([force[0, 0], left[0, 0]], [f[0], u[0]], rtol=0, atol=2e-12)


def contact_of(dim, xi, axis, v, base, slid):
    """A unit normal, a spring of any direction (the contact has turned since), a tangential rate."""
    axis, xi, v = ([*a[:dim], *[0.0] * (3 - dim)] for a in (axis, xi, v))
    size = math.sqrt(sum(c * c for c in axis))
    if size < 0.1:
        return None
    n = [c / size for c in axis]
    along = sum(p * q for p, q in zip(v, n, strict=True))
    v = [p - along * q for p, q in zip(v, n, strict=True)]
    return SimpleNamespace(xi=xi, n=n, v=v, base=abs(base), slid=slid)


def clear(c, mu, mu_d, gt):
    """Leave out what round-off decides: springs along the normal, forces on a limit."""
    tangent = np.array(c.xi) - np.dot(c.xi, c.n) * np.array(c.n)
    if any(c.xi) and np.linalg.norm(tangent) < 1e-3 * np.linalg.norm(c.xi):
        return False
    turned, v = tangent * np.linalg.norm(c.xi) / (np.linalg.norm(tangent) or 1), np.array(c.v)
    springs = [np.array(c.xi), turned, np.array(c.xi) + DT * v, turned + DT * v, tangent + DT * v]
    sizes = [KT * np.linalg.norm(u) for u in springs] + [np.linalg.norm(KT * u + gt * v) for u in springs]
    limits = [m * c.base for m in (mu, mu_d) if m is not None]
    return all(abs(s - limit) > 1e-9 for s in sizes for limit in limits if s > 0)


# --- the rules of the docstring ------------------------------------------------------------------------

TILT = np.array([math.sin(0.3), math.cos(0.3)])[:, None]  # normal of a contact that has turned by 0.3
STILL, UP = column(0.0, 0.0), column(0.0, 1.0)


@pytest.mark.parametrize(("algorithm", "ratio"), [("lammps", 1.0), ("talk", 1.0), ("liggghts", math.cos(0.3))])
def test_the_turned_spring_keeps_its_length_or_not(algorithm, ratio):
    _, spring = slider(algorithm).move(column(0.1, 0.0), STILL, pressed(100.0), TILT, DT, advance=True)
    assert abs((spring * TILT).sum()) < 1e-16
    assert np.linalg.norm(spring) == pytest.approx(0.1 * ratio, rel=1e-14)
    assert spring[0, 0] > 0


@pytest.mark.parametrize("algorithm", ALGORITHMS)
def test_a_spring_without_normal_is_not_turned(algorithm):
    _, spring = slider(algorithm).move(column(0.1, 0.02), STILL, pressed(100.0), None, DT, advance=True)
    assert spring[:, 0].tolist() == [0.1, 0.02]


@pytest.mark.parametrize("algorithm", ALGORITHMS)
def test_a_spring_turned_to_nothing_stays_nothing(algorithm):
    _, spring = slider(algorithm).move(column(0.0, 0.1), STILL, pressed(100.0), UP, DT, advance=True)
    assert not spring.any()


def test_lammps_turns_only_beyond_its_threshold():
    tilt = LAMMPS_TURN_THRESHOLD * MU * 100.0 / (KT * 0.1)  # along * k_t = threshold * limit at spring 0.1
    for factor, turns in ((0.5, False), (2.0, True)):
        n = column(tilt * factor, math.sqrt(1 - (tilt * factor) ** 2))
        _, spring = slider("lammps").move(column(0.1, 0.0), STILL, pressed(100.0), n, DT, advance=True)
        assert (spring[1, 0] != 0.0) == turns


@pytest.mark.parametrize(("algorithm", "stretched_first"), [("lammps", True), ("liggghts", True), ("talk", False)])
def test_the_spring_is_stretched_before_or_after_the_force(algorithm, stretched_first):
    force, spring = slider(algorithm).move(column(0.1, 0.0), column(0.2, 0.0), pressed(100.0), UP, DT, advance=True)
    felt = 0.1 + (DT * 0.2 if stretched_first else 0.0)
    assert force[0, 0] == pytest.approx(-KT * felt - GT * 0.2, rel=1e-14)
    assert spring[0, 0] == pytest.approx(0.1 + DT * 0.2, rel=1e-14)


@pytest.mark.parametrize(("algorithm", "slides"), [("lammps", True), ("talk", True), ("liggghts", False)])
def test_what_the_limit_is_tested_on(algorithm, slides):
    """Spring 0.1 k = 0.4 is below the limit 0.5, with the dashpot 0.4 + 0.2 above it."""
    xi = column(0.1 - (DT * 0.4 if algorithm != "talk" else 0.0), 0.0)
    force, spring = slider(algorithm).move(xi, column(0.4, 0.0), pressed(1.0), UP, DT, advance=True)
    assert force[0, 0] == pytest.approx(-0.5 if slides else -0.6, rel=1e-14)
    if slides:  # spring and dashpot together carry the limit
        assert -KT * spring[0, 0] - GT * 0.4 == pytest.approx(-0.5, rel=1e-14)


def test_liggghts_slides_without_dashpot():
    force, spring = slider("liggghts").move(column(1.0, 0.0), column(0.4, 0.0), pressed(1.0), UP, DT, advance=True)
    assert force[0, 0] == pytest.approx(-0.5, rel=1e-14)
    assert spring[0, 0] == pytest.approx(0.5 / KT, rel=1e-14)


@pytest.mark.parametrize("algorithm", ALGORITHMS)
def test_without_advance_nothing_changes_but_the_limit_holds(algorithm):
    xi, v = column(1.0, 0.3), column(0.4 * math.cos(0.3), -0.4 * math.sin(0.3))
    given_xi = xi.copy()
    force, spring = slider(algorithm).move(xi, v, pressed(1.0), TILT, DT, advance=False)
    assert np.array_equal(spring, given_xi)
    assert np.array_equal(xi, given_xi)
    assert np.linalg.norm(force) == pytest.approx(0.5, rel=1e-14)


@pytest.mark.parametrize(("algorithm", "force"), [("lammps", 0.0), ("talk", -0.05), ("liggghts", -0.2)])
def test_set_up_with_a_slip_but_no_spring_yet(algorithm, force):
    """Dashpot 0.2 above the limit 0.05: none (pair granular's rule), cut, or uncut (tested on the spring)."""
    got, spring = slider(algorithm).move(STILL, column(0.4, 0.0), pressed(0.1), UP, DT, advance=False)
    assert got[0, 0] == pytest.approx(force, rel=1e-14)
    assert not spring.any()


def test_liggghts_feels_a_fixed_spring_stretched_at_set_up_without_keeping_it():
    force, spring = slider("liggghts").move(STILL, column(0.4, 0.0), pressed(100.0), None, DT, advance=False)
    assert force[0, 0] == pytest.approx(-KT * DT * 0.4 - GT * 0.4, rel=1e-14)
    assert not spring.any()


def test_a_sliding_twist_resists_the_rate_against_its_own_spring():
    """The spring pulls one way with 4, the limit falls to 0.5 while the rate has turned round: the couple follows."""
    force, spring = slider("lammps_twisting").move(column(1.0), column(-0.4), pressed(1.0), None, DT, advance=True)
    assert force[0, 0] == pytest.approx(0.5, rel=1e-14)
    assert -KT * spring[0, 0] + GT * 0.4 == pytest.approx(0.5, rel=1e-14)
    resting, spring = slider("lammps_twisting").move(column(1.0), column(0.0), pressed(1.0), None, DT, advance=True)
    assert (resting[0, 0], spring[0, 0]) == (0.0, 0.0)


@pytest.mark.parametrize("mu_d", [None, 0.2])
@pytest.mark.parametrize("slid", [0.0, 1.0])
@pytest.mark.parametrize("round_off", [0.0, 1e-17, -1e-17])
def test_a_limit_of_zero_holds_nothing_in_the_talk(mu_d, slid, round_off):
    """Spring and dashpot cancel up to a rounding, which must not decide whether the spring is stretched on."""
    xi = column(-GT * 0.4 / KT + round_off, 0.0)
    memory = xi if mu_d is None else np.vstack([xi, [[slid]]])
    force, left = slider("talk", mu_d=mu_d).move(memory, column(0.4, 0.0), pressed(0.0), UP, DT, advance=True)
    assert not force.any()
    assert left[0, 0] == pytest.approx(-GT * 0.4 / KT, rel=1e-14)
    assert mu_d is None or left[2, 0] == 1.0


@pytest.mark.parametrize("algorithm", ALGORITHMS)
def test_the_given_spring_is_not_written_to(algorithm):
    xi = column(1.0, 0.0)
    slider(algorithm).move(xi, column(0.5, 0.0), pressed(1.0), TILT, DT, advance=True)
    assert xi.tolist() == [[1.0], [0.0]]


# --- static and dynamic coefficient --------------------------------------------------------------------


def forces_of_a_drag(algorithm, mu_d, speeds, gt=0.0):
    """Sizes of the force as a contact is dragged along: limit 0.5 static, 0.5 mu_d/mu dynamic; k v dt = speed/2."""
    chosen, memory = slider(algorithm, gt=gt, mu_d=mu_d), np.zeros((memory_rows(2, algorithm, mu_d), 1))
    sizes = []
    for speed in speeds:
        force, memory = chosen.move(memory, column(speed, 0.0), pressed(1.0), UP, DT, advance=True)
        sizes.append(-force[0, 0])
    return np.array(sizes)


@pytest.mark.parametrize("algorithm", STATEFUL)
def test_static_then_dynamic_then_static(algorithm):
    """Grows to mu f, falls to mu_d f and stays there; sticks when pushed back, and must pass mu f again."""
    forwards, back = [0.1] * 30, [-0.1] * 4
    sizes = forces_of_a_drag(algorithm, 0.3, forwards + back + forwards)
    shift = 0 if algorithm == "lammps" else 1  # the talk stretches after the force
    np.testing.assert_allclose(sizes[shift: 10 + shift], 0.05 * np.arange(1, 11), atol=1e-12)
    np.testing.assert_allclose(sizes[11 + shift: 30], 0.3, atol=1e-12)
    unloaded = sizes[30 + shift: 34 + shift]
    np.testing.assert_allclose(unloaded, 0.3 - 0.05 * np.arange(1, 5), atol=1e-12)
    again = sizes[34 + shift:]
    assert again.max() == pytest.approx(0.5, abs=1e-9)  # up to the static limit
    np.testing.assert_allclose(again[-10:], 0.3, atol=1e-12)


def test_liggghts_has_no_state_and_saws():
    """tan_luding: cut to mu_d f, then stretched up to mu f again, and so on."""
    sizes = forces_of_a_drag("liggghts", 0.3, [0.1] * 60)
    assert memory_rows(2, "liggghts", 0.3) == 2
    assert sizes[20:].max() == pytest.approx(0.5, abs=0.051)
    assert sizes[20:].min() == pytest.approx(0.3, abs=1e-12)
    assert len(np.unique(sizes[20:].round(9))) >= 4


@pytest.mark.parametrize("algorithm", ALGORITHMS)
def test_equal_coefficients_are_one_coefficient(algorithm):
    drag = [0.1] * 25 + [-0.2] * 25
    one, two = forces_of_a_drag(algorithm, None, drag, gt=GT), forces_of_a_drag(algorithm, MU, drag, gt=GT)
    assert np.array_equal(one, two)
