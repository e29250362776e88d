"""Contact laws against a scalar evaluation of the same words, and the docstrings' rules one by one."""

import math

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from reference.kernel.laws.contact import Touching
from reference.kernel.laws.linear import LinearNormal
from reference.kernel.laws.sliding import LAMMPS_TURN_THRESHOLD, SpringSliding

ALGORITHMS = ("lammps", "liggghts", "talk")
KT, GT, MU, DT = 4.0, 0.5, 0.5, 0.125
QUICK = settings(max_examples=50, deadline=None, derandomize=True, suppress_health_check=[HealthCheck.filter_too_much])

hundredths = st.integers(-200, 200).map(lambda k: k / 100)
vectors = st.tuples(hundredths, hundredths, hundredths)


def law(algorithm, *, mu=MU, gt=GT):
    return SpringSliding(shear_friction=mu, shear_stiffness=KT, shear_damping=gt, algorithm=algorithm)


def touching(overlap, v_n):
    none = np.zeros(len(overlap), int)
    return Touching(i=none, j=none, n=np.zeros((2, len(overlap))), overlap=np.array(overlap), v_n=np.array(v_n))


def column(*vector):
    return np.array(vector, float)[:, None]


# --- normal ----------------------------------------------------------------------------------------


@QUICK
@given(st.lists(st.tuples(st.floats(1e-9, 1e-2), st.floats(-10, 10)), min_size=1, max_size=5),
       st.floats(0.1, 1e6), st.floats(0, 1e3), st.booleans())
def test_linear_normal_is_the_scalar_formula(dem, contacts, stiffness, damping, clip):
    overlap, v_n = zip(*contacts, strict=True)
    normal = LinearNormal(normal_stiffness=stiffness, normal_damping=damping, clip_attraction=clip)
    expected = [dem.plain_normal(normal, d, v) for d, v in contacts]
    got = normal.force(touching(overlap, v_n))
    np.testing.assert_allclose(got, expected, rtol=1e-14, atol=1e-14 * (stiffness * 1e-2 + damping * 10))


def test_attraction_is_clipped_only_where_asked():
    contact = touching([0.1, 0.1], [5.0, -5.0])
    free = LinearNormal(normal_stiffness=10.0, normal_damping=1.0, clip_attraction=False)
    clipped = LinearNormal(normal_stiffness=10.0, normal_damping=1.0, clip_attraction=True)
    assert free.force(contact).tolist() == [-4.0, 6.0]
    assert clipped.force(contact).tolist() == [0.0, 6.0]


def test_the_force_is_the_slope_of_the_stored_energy():
    normal = LinearNormal(normal_stiffness=3.0, normal_damping=0.0, clip_attraction=False)
    overlap, h = np.array([0.2, 0.5]), 1e-4
    slope = (normal.energy(overlap + h) - normal.energy(overlap - h)) / (2 * h)
    np.testing.assert_allclose(normal.force(touching(overlap, [0.0, 0.0])), slope, rtol=1e-10)
    xi = column(0.3, 0.4)
    assert law("talk").energy(xi).tolist() == [0.5 * KT * 0.25]


# --- sliding: drawn contacts -----------------------------------------------------------------------


@pytest.mark.parametrize("algorithm", ALGORITHMS)
@pytest.mark.parametrize("dim", [2, 3])
@QUICK
@given(st.lists(st.tuples(vectors, vectors, vectors, hundredths), min_size=1, max_size=6),
       st.sampled_from([0.0, 0.1, 0.7]), st.sampled_from([0.0, 0.5]), st.booleans())
def test_sliding_is_the_scalar_algorithm(dem, algorithm, dim, drawn, mu, gt, advance):
    contacts = [c for c in (_contact(dim, *numbers) for numbers in drawn) if c and _clear(*c, mu, gt)]
    chosen = law(algorithm, mu=mu, gt=gt)
    if not contacts:
        return
    xi, n, v_t, f_n = (np.array(part) for part in zip(*contacts, strict=True))
    force, spring = chosen.force(xi.T[:dim], n.T[:dim], v_t.T[:dim], f_n, DT, advance=advance)
    for k, contact in enumerate(contacts):
        f, u = dem.plain_sliding(chosen, *(list(p) if isinstance(p, list) else p for p in contact), DT, advance)
        np.testing.assert_allclose(force[:, k], f[:dim], rtol=0, atol=2e-12)
        np.testing.assert_allclose(spring[:, k], u[:dim], rtol=0, atol=2e-12)


def _contact(dim, xi, axis, v, f_n):
    """A unit normal, a spring of any direction (the contact has turned since), a tangential slip velocity."""
    axis, xi, v = ([*a[:dim], *[0.0] * (3 - dim)] for a in (axis, xi, v))
    size = math.sqrt(sum(c * c for c in axis))
    if size < 0.1:
        return None
    n = [c / size for c in axis]
    along = sum(p * q for p, q in zip(v, n, strict=True))
    return xi, n, [p - along * q for p, q in zip(v, n, strict=True)], f_n


def _clear(xi, n, v_t, f_n, mu, gt):
    """Leave out what round-off decides: springs along the normal, forces on the Coulomb limit."""
    tangent = np.array(xi) - np.dot(xi, n) * np.array(n)
    if any(xi) and np.linalg.norm(tangent) < 1e-3 * np.linalg.norm(xi):
        return False
    turned = tangent * np.linalg.norm(xi) / (np.linalg.norm(tangent) or 1)
    v_t = np.array(v_t)
    springs = [xi, turned, turned + DT * v_t, tangent + DT * v_t]
    sizes = [KT * np.linalg.norm(u) for u in springs] + [np.linalg.norm(KT * np.array(u) + gt * v_t) for u in springs]
    return all(abs(s - limit) > 1e-9 for s in sizes for limit in (mu * abs(f_n),) if s > 0)


# --- sliding: the rules of the docstring -----------------------------------------------------------

TILT = np.array([math.sin(0.3), math.cos(0.3)])[:, None]  # normal of a contact that has turned by 0.3
STILL = column(0.0, 0.0)


@pytest.mark.parametrize(("algorithm", "ratio"), [("lammps", 1.0), ("talk", 1.0), ("liggghts", math.cos(0.3))])
def test_the_turned_spring_keeps_its_length_or_not(algorithm, ratio):
    _, spring = law(algorithm).force(column(0.1, 0.0), TILT, STILL, np.array([100.0]), DT, advance=True)
    assert abs((spring * TILT).sum()) < 1e-16
    assert np.linalg.norm(spring) == pytest.approx(0.1 * ratio, rel=1e-14)
    assert spring[0, 0] > 0


@pytest.mark.parametrize("algorithm", ALGORITHMS)
def test_a_spring_turned_to_nothing_stays_nothing(algorithm):
    _, spring = law(algorithm).force(column(0.0, 0.1), column(0.0, 1.0), STILL, np.array([100.0]), DT, advance=True)
    assert not spring.any()


def test_lammps_turns_only_beyond_its_threshold():
    f_n = np.array([100.0])
    tilt = LAMMPS_TURN_THRESHOLD * MU * 100.0 / (KT * 0.1)  # along * k_t = threshold * limit at spring 0.1
    for factor, turns in ((0.5, False), (2.0, True)):
        n = column(tilt * factor, math.sqrt(1 - (tilt * factor) ** 2))
        _, spring = law("lammps").force(column(0.1, 0.0), n, STILL, f_n, DT, advance=True)
        assert (spring[1, 0] != 0.0) == turns


@pytest.mark.parametrize(("algorithm", "stretched_first"), [("lammps", True), ("liggghts", True), ("talk", False)])
def test_the_spring_is_stretched_before_or_after_the_force(algorithm, stretched_first):
    up, v_t = column(0.0, 1.0), column(0.2, 0.0)
    force, spring = law(algorithm).force(column(0.1, 0.0), up, v_t, np.array([100.0]), DT, advance=True)
    felt = 0.1 + (DT * 0.2 if stretched_first else 0.0)
    assert force[0, 0] == pytest.approx(-KT * felt - GT * 0.2, rel=1e-14)
    assert spring[0, 0] == pytest.approx(0.1 + DT * 0.2, rel=1e-14)


@pytest.mark.parametrize(("algorithm", "slides"), [("lammps", True), ("talk", True), ("liggghts", False)])
def test_what_the_limit_is_tested_on(algorithm, slides):
    """Spring 0.1 k_t = 0.4 is below the limit 0.5, with the dashpot 0.4 + 0.2 above it."""
    up, v_t, f_n = column(0.0, 1.0), column(0.4, 0.0), np.array([1.0])
    xi = column(0.1 - (DT * 0.4 if algorithm != "talk" else 0.0), 0.0)
    force, spring = law(algorithm).force(xi, up, v_t, f_n, DT, advance=True)
    assert force[0, 0] == pytest.approx(-0.5 if slides else -0.6, rel=1e-14)
    if slides:  # spring and dashpot together carry the limit
        assert -KT * spring[0, 0] - GT * 0.4 == pytest.approx(-0.5, rel=1e-14)


def test_liggghts_slides_without_dashpot():
    up, v_t, f_n = column(0.0, 1.0), column(0.4, 0.0), np.array([1.0])
    force, spring = law("liggghts").force(column(1.0, 0.0), up, v_t, f_n, DT, advance=True)
    assert force[0, 0] == pytest.approx(-0.5, rel=1e-14)
    assert spring[0, 0] == pytest.approx(0.5 / KT, rel=1e-14)


@pytest.mark.parametrize(("algorithm", "limit"), [("lammps", 0.5), ("liggghts", 0.5), ("talk", 0.0)])
def test_attractive_contacts(algorithm, limit):
    """The codes take |f_n|; in the talks a contact that pulls has no friction."""
    force, _ = law(algorithm).force(column(1.0, 0.0), column(0.0, 1.0), STILL, np.array([-1.0]), DT, advance=True)
    assert abs(force[0, 0]) == pytest.approx(limit, rel=1e-14)


@pytest.mark.parametrize("algorithm", ALGORITHMS)
def test_without_advance_nothing_changes_but_the_limit_holds(algorithm):
    xi, v_t = column(1.0, 0.3), column(0.4 * math.cos(0.3), -0.4 * math.sin(0.3))
    given_xi = xi.copy()
    force, spring = law(algorithm).force(xi, TILT, v_t, np.array([1.0]), DT, advance=False)
    assert np.array_equal(spring, given_xi)
    assert np.array_equal(xi, given_xi)
    assert np.linalg.norm(force) == pytest.approx(0.5, rel=1e-14)


@pytest.mark.parametrize(("algorithm", "force"), [("lammps", 0.0), ("talk", -0.05), ("liggghts", -0.2)])
def test_set_up_with_a_slip_but_no_spring_yet(algorithm, force):
    """Dashpot 0.2 above the limit 0.05: none (pair granular's rule), cut, or uncut (tested on the spring)."""
    up, v_t, f_n = column(0.0, 1.0), column(0.4, 0.0), np.array([0.1])
    got, spring = law(algorithm).force(STILL, up, v_t, f_n, DT, advance=False)
    assert got[0, 0] == pytest.approx(force, rel=1e-14)
    assert not spring.any()


@pytest.mark.parametrize("algorithm", ALGORITHMS)
def test_the_given_spring_is_not_written_to(algorithm):
    xi = column(1.0, 0.0)
    law(algorithm).force(xi, TILT, column(0.5, 0.0), np.array([1.0]), DT, advance=True)
    assert xi.tolist() == [[1.0], [0.0]]
