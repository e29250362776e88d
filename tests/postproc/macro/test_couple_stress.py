"""Couple stress, curvature, torque stiffness: hand-made contacts, cancellation, signs; axial quantities."""

import numpy as np
import pytest

from postproc.macro.axial import axial, cross, dyads
from postproc.macro.contact_ends import contact_ends
from postproc.macro.couple_stress import torque_stiffness


@pytest.fixture
def unequal(states):
    """Discs of radius 1 and 2 touching along x; force (-2, 3) on the small one, at its right; couple 0.5 on it."""
    return states.snapshot(
        x=[[2.0, 2.0], [5.0, 2.0]], radius=[1.0, 2.0], i=[1], j=[2], point=[[3.0, 2.0]], force=[[-2.0, 3.0]],
        box=np.array([[0.0, 10.0], [0.0, 5.0]]),
        extra={"contacts": {"mz": [0.5], "overlap": [0.0], "ux": [0.0], "uy": [0.6]}},
    )


def test_hand_made_pair(unequal, measure):
    """Torques 1 * 3 and (-2)(-3) = 6 about the centres, normals +1 and -2: -(3 * 1 + 6 * (-2))/50."""
    np.testing.assert_allclose(measure(unequal, "couple_stress"), [[9.0 / 50.0, 0.0]], rtol=1e-14)
    np.testing.assert_allclose(measure(unequal, "contact_couple_stress"), [[-(0.5 + 0.5 * 2.0) / 50.0, 0.0]])


def test_curvature_of_a_hand_made_triangle(states, measure):
    """Three ends on particle 1 alone (walls): theta = l x Delta/l^2, fitted to kappa . l."""
    kappa, rng = np.array([0.3, -0.2]), np.random.default_rng(2)
    l = rng.normal(size=(3, 2))  # noqa: E741
    size = np.linalg.norm(l, axis=1)
    sideways = np.column_stack([-l[:, 1], l[:, 0]]) * (l @ kappa)[:, None]  # theta x l, so that l x Delta/l^2 = theta
    state = states.snapshot(
        x=[[5.0, 5.0]], radius=[1.0], i=[1, 1, 1], j=[-1, -2, -3], point=5.0 + l, force=-l,
        box=np.array([[0.0, 10.0], [0.0, 10.0]]),
        extra={"contacts": {"overlap": 0.1 * size, **states.columns("u", sideways)}},
    )
    np.testing.assert_allclose(measure(state, "curvature"), [kappa], rtol=1e-12)


def test_equal_particles_cancel(states, measure):
    """Both ends of a contact have one torque and opposite branches."""
    state = states.lattice("triangular")
    pushed = states.replace(state, contacts={**state.contacts, "fx": state.contacts["fx"] + 3.0})
    scale = 3.0 * states.R**2 * state.contacts.rows / np.prod(np.diff(state.box))
    np.testing.assert_allclose(measure(pushed, "couple_stress"), 0.0, atol=1e-12 * scale)


def test_rolling_springs_in_a_gradient_of_rotation(states, measure):
    """Couples m = -k (theta_i - theta_j), theta = g . x, on a triangular lattice: M^c = -sqrt(3) k g, as kappa = -g."""
    state, k, g = states.lattice("triangular"), 2.0, np.array([0.3, -0.5])
    n = -state.contacts.vector("fx", "fy")
    n /= np.linalg.norm(n, axis=1, keepdims=True)  # from i to j
    d = 2 * states.R * (1 - 1e-3)
    turning = states.replace(state, contacts={**state.contacts, "mz": k * d * n @ g})
    np.testing.assert_allclose(measure(turning, "contact_couple_stress"), [-np.sqrt(3) * k * g], rtol=1e-10)


def test_torque_stiffness_is_the_least_squares_factor(unequal, measure):
    kappa = np.array([[1.0, 2.0], [0.0, 0.0], [1.0, 0.0]])
    M = np.array([[3.0, 6.0], [1.0, 1.0], [-2.0, 5.0]])
    np.testing.assert_array_equal(torque_stiffness(M, kappa), [3.0, np.nan, -2.0])
    assert np.isnan(measure(unequal, "torque_stiffness")).all()  # one contact: its branches are in line


def test_central_contacts_have_no_curvature_and_no_torque_stiffness(states, measure):
    """Not the ratio of two round-offs."""
    state = states.lattice("triangular")
    assert (measure(state, "curvature") == 0).all()
    assert np.isnan(measure(state, "torque_stiffness")).all()


def test_in_space(states, measure):
    """Component (axis, normal): -(l x f) l summed over ends."""
    state = states.random_contacts(4, 3)
    ends = contact_ends(state)
    expected = -np.einsum("ea,eb->ab", np.cross(ends.l, ends.f), ends.l) / np.prod(np.diff(state.box))
    np.testing.assert_allclose(measure(state, "couple_stress")[0], expected, rtol=1e-12)
    assert measure(state, "curvature").shape == (1, 3, 3)


def test_antisymmetric_stress_is_the_torque_of_the_contacts(states, measure):
    """2 V a = -sum l x f: positive when contacts turn the particles clockwise."""
    for dim in (2, 3):
        state = states.random_contacts(6, dim)
        ends = contact_ends(state)
        torque = cross(ends.l, ends.f).sum(axis=0)
        expected = -torque / (2 * np.prod(np.diff(state.box)))
        np.testing.assert_allclose(measure(state, "stress_antisymmetric")[0], expected, rtol=1e-11)


def test_axial_and_cross_agree_in_plane_and_space():
    rng = np.random.default_rng(0)
    a, b = rng.normal(size=(2, 5, 2))
    flat = [np.column_stack([v, np.zeros(5)]) for v in (a, b)]
    np.testing.assert_allclose(cross(a, b), cross(*flat)[:, 2], rtol=1e-13)
    T = a[:, :, None] * b[:, None, :]
    np.testing.assert_allclose(axial(T), cross(a, b) / 2, rtol=1e-13)
    np.testing.assert_allclose(axial(flat[0][:, :, None] * flat[1][:, None, :])[:, 2], axial(T), rtol=1e-13)
    assert dyads(cross(a, b), a).shape == (5, 2)
    assert dyads(cross(*flat), flat[0]).shape == (5, 3, 3)
