"""Angles of axes, contact histograms and their second order; corrected fabric, contact number density."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from postproc.macro.directions import BINS, non_colinearity, orientation, second_order
from postproc.macro.tensors import principal
from postproc.snapshot import MissingColumn


def axis(degrees):
    return np.array([[np.cos(np.radians(degrees)), np.sin(np.radians(degrees))]])


@pytest.mark.parametrize(("degrees", "expected"), [(0, 0), (30, 30), (90, 90), (-90, 90), (120, -60), (210, 30)])
def test_orientation_is_that_of_an_axis(degrees, expected):
    assert orientation(axis(degrees)) == pytest.approx([expected], abs=1e-12)


@settings(max_examples=50, deadline=None)
@given(a=st.floats(-360, 360), b=st.floats(-89.9, 89.9))
def test_non_colinearity_turns_the_first_into_the_second(a, b):
    for arrow in (1.0, -1.0):
        assert non_colinearity(arrow * axis(a), axis(a + b)) == pytest.approx([b], abs=1e-9)
    flat = [np.column_stack([axis(v), [[0.0]]]) for v in (a, a + b)]
    assert non_colinearity(*flat) == pytest.approx([abs(b)], abs=1e-6)


def test_isotropic_tensors_have_no_angle():
    none = principal(np.eye(2)[None]).major
    assert np.isnan(non_colinearity(none, axis(3.0))).all()
    assert np.isnan(orientation(none)).all()


def test_histogram_of_lattices(states, measure):
    """Square: four peaks of a quarter each, in the bins that begin at 0, 90, 180, 270 degrees."""
    angle = np.radians(5.0)
    turn = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
    pair = states.snapshot(x=[[0.0, 0.0], [2.0, 0.0], [0.0, 2.0]], radius=[1.0] * 3, i=[1, 1], j=[2, 3],
                           point=[[1.0, 0.0], [0.0, 1.0]], force=np.zeros((2, 2)))
    state = states.replace(states.moved(pair, turn, np.zeros(2)), box=np.array([[-9.0, 9.0]] * 2))
    expected = np.zeros(BINS)
    expected[[0, 9, 18, 27]] = 0.25 * BINS / (2 * np.pi)
    np.testing.assert_allclose(measure(state, "contact_directions")[0], expected, rtol=1e-12)
    assert np.isnan(measure(state, "wall_contact_directions")).all()


def test_walls_are_counted_apart(states, measure):
    state = states.random_contacts(3, 2)
    both = [measure(state, name, "particles") for name in ("contact_directions", "wall_contact_directions")]
    per_contact = 2 * np.pi / BINS
    for found, walls in zip(both, (False, True), strict=True):
        known = ~np.isnan(found[:, 0])
        np.testing.assert_allclose(found[known].sum(axis=1) * per_contact, 1.0, rtol=1e-12)
        j = state.contacts["j"]
        touched = state.contacts["i"][j < 0] if walls else np.append(state.contacts["i"][j > 0], j[j > 0])
        assert np.array_equal(np.flatnonzero(known) + 1, np.unique(touched))


def test_a_pair_on_a_floor(states, measure):
    """Contacts of particles to the right and left, those with the floor downwards; none of one among the other."""
    state = states.snapshot(x=[[1.0, 1.0], [3.0, 1.0]], radius=[1.0, 1.0], i=[1, 1, 2], j=[2, -1, -1],
                            point=[[2.0, 1.001], [1.001, 0.0], [3.001, 0.0]], force=np.zeros((3, 2)),
                            box=np.array([[0.0, 4.0]] * 2))
    share = 2 * np.pi / BINS
    pairs, walls = (measure(state, name)[0] * share for name in ("contact_directions", "wall_contact_directions"))
    np.testing.assert_allclose(pairs[[0, 17]], 0.5)
    assert pairs.sum() == pytest.approx(1.0)
    assert (walls[27], walls.sum()) == pytest.approx((1.0, 1.0))


def test_histogram_in_a_polar_frame_is_turned(states, measure):
    """A chain of discs along a radius at any angle has contacts at 0 and 180 degrees from r."""
    for degrees in (5.0, 100.0, 260.0):
        r = axis(degrees)
        state = states.snapshot(x=np.array([[1.0], [3.0]]) * r, radius=[1.0, 1.0], i=[1], j=[2], point=2.0 * r,
                                force=[[0.0, 0.0]], box=np.array([[-9.0, 9.0]] * 2))
        found = measure(state, "contact_directions", "rings:1:0:5")[0] * 2 * np.pi / BINS
        assert found[[0, -1]].sum() == pytest.approx(0.5)
        assert found[[BINS // 2, BINS // 2 - 1]].sum() == pytest.approx(0.5)


@settings(max_examples=30, deadline=None)
@given(amplitude=st.floats(0.01, 1.0), degrees=st.floats(-89, 89), bins=st.sampled_from((8, 12, 36)))
def test_second_order_of_a_density_that_has_no_other(amplitude, degrees, bins):
    """Exact bin means of (1 + a cos 2(phi - phi_0))/2 pi."""
    edges = np.linspace(0, 2 * np.pi, bins + 1)
    phi_0 = np.radians(degrees)
    integral = edges + amplitude / 2 * np.sin(2 * (edges - phi_0))
    density = np.diff(integral) / np.diff(edges) / (2 * np.pi)
    fit = second_order(density[None])
    assert fit.amplitude == pytest.approx([amplitude], rel=1e-9)
    assert fit.angle == pytest.approx([degrees], abs=1e-9)


def test_second_order_is_four_times_the_deviator_of_the_contact_fabric(states, measure):
    state = states.random_contacts(2, 2, count=120)
    inner = states.replace(state, contacts={k: v[state.contacts["j"] > 0] for k, v in state.contacts.items()})
    fit = second_order(measure(inner, "contact_directions"))
    parts = principal(measure(inner, "contact_fabric"))
    assert fit.amplitude == pytest.approx(4 * parts.deviator, rel=0.05)  # binning of a few thousand directions
    assert fit.angle == pytest.approx(orientation(parts.major), abs=3.0)


def test_bins_need_a_plane(states, measure):
    for name in ("contact_directions", "fabric_orientation"):
        with pytest.raises(MissingColumn, match="needs a 2D state"):
            measure(states.random_contacts(3, 3), name)


def test_contact_number_density_counts_every_contact_once(states, measure):
    state = states.random_contacts(3, 2)
    area = np.prod(np.diff(state.box))
    assert measure(state, "contact_number_density") == pytest.approx([state.contacts.rows / area], rel=1e-13)


def test_particles_of_one_size_need_no_correction(states, measure):
    for kind in ("triangular", "fcc"):
        state = states.lattice(kind, repeats=3)
        assert measure(state, "polydispersity") == pytest.approx([1.0], rel=1e-14)
        np.testing.assert_allclose(measure(state, "fabric_corrected"), measure(state, "fabric"), rtol=1e-14)


@pytest.mark.parametrize(("dim", "tolerance"), [(2, 4e-4), (3, 1.2e-3)])
@pytest.mark.parametrize("widest", [1.1, 1.5, 3.0])
def test_polydispersity_against_the_shielding_it_is_expanded_from(states, measure, dim, tolerance, widest):
    """C(a) ~ 1/arcsin(1/(1 + a/<a>)), in 3D 1/(1 - cos) of that angle: <V C>/(<V><C>) summed over uniform radii."""
    a = np.linspace(1.0, widest, 501)
    angle = np.arcsin(1 / (1 + a / a.mean()))
    C = 1 / angle if dim == 2 else 1 / (1 - np.cos(angle))
    exact = (a**dim * C).mean() / ((a**dim).mean() * C.mean())
    state = states.snapshot(x=np.zeros((501, dim)), radius=a, box=np.array([[-1.0, 1.0]] * dim))
    found = measure(state, "polydispersity")[0]
    assert found == pytest.approx(exact, rel=tolerance * ((widest - 1) / 2) ** 2)
    assert found > 1.0005
