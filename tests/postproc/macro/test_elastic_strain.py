"""Elastic strain: affine deformations come back exactly; stiffnesses of lattices in closed form."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from postproc.macro.contact_ends import contact_ends
from postproc.macro.springs import contact_deformation
from postproc.snapshot import MissingColumn

KN, KT = 1e5, 3e4


def strained(states, seed, dim, eps, kn=1.0, kt=1.0):
    """Return random particles that touch on straight branches, some a wall, deformed by u = -eps . x (none turns)."""
    rng = np.random.default_rng(seed)
    n, box = 7, np.array([[0.0, 3.0]] * dim)
    x = rng.uniform(0.5, 2.5, (n, dim))
    i, j = np.array([(a, b) for a in range(n) for b in range(a) if (a + b) % 2]).T
    part = rng.uniform(0.2, 0.8, (len(i), 1))
    at_wall = x[:dim].copy()
    at_wall[np.arange(dim), np.arange(dim)] = 0.0
    point = np.concatenate([x[i] + part * (x[j] - x[i]), at_wall])
    branch = np.concatenate([x[j] - x[i], at_wall - x[:dim]])
    moved = branch @ eps.T
    n_out = branch / np.linalg.norm(branch, axis=1, keepdims=True)
    overlap = (moved * n_out).sum(axis=1)
    u = moved - overlap[:, None] * n_out
    return states.snapshot(
        x=x, radius=np.ones(n), i=np.concatenate([i, np.arange(dim)]) + 1,
        j=np.concatenate([j + 1, -np.arange(1, dim + 1)]), point=point, box=box,
        force=-kn * overlap[:, None] * n_out - kt * u,
        extra={"contacts": {"overlap": overlap, **states.columns("u", u)}},
    )


@settings(max_examples=20, deadline=None)
@given(seed=st.integers(0, 2**32 - 1), dim=st.sampled_from((2, 3)))
def test_affine_strain_comes_back(states, measure, seed, dim):
    """Any eps, also antisymmetric (the sample turns, its particles do not); particles of any sizes; walls."""
    eps = np.random.default_rng(seed + 1).normal(size=(dim, dim))
    state = strained(states, seed, dim, eps)
    np.testing.assert_allclose(measure(state, "elastic_strain"), [eps], atol=1e-9)


def test_affine_strain_comes_back_to_twelve_digits(states, measure):
    eps = np.array([[1e-3, 4e-4], [-2e-4, 5e-4]])
    found = measure(strained(states, 5, 2, eps), "elastic_strain")
    np.testing.assert_allclose(found, [eps], rtol=0, atol=1e-12 * np.abs(eps).max())
    assert measure(strained(states, 5, 2, eps), "elastic_strain_isotropic") == pytest.approx([7.5e-4], rel=1e-12)


def test_it_is_the_least_squares_solution(states, measure):
    """Deformations of no affine field: the same as numpy's solver over all ends."""
    state = states.random_contacts(3, 2)
    ends = contact_ends(state)
    sign = np.repeat([1.0, -1.0], [state.contacts.rows, len(ends.contact) - state.contacts.rows])
    u = sign[:, None] * state.contacts.vector("ux", "uy")[ends.contact]
    deformation = contact_deformation(ends, state.contacts["overlap"], u)
    expected = np.linalg.lstsq(ends.l, deformation, rcond=None)[0].T
    np.testing.assert_allclose(measure(state, "elastic_strain")[0], expected, rtol=1e-10, atol=1e-12)


def test_hand_made_pair(states):
    """Radii 1 and 2, overlap 0.3, u = (0, 0.6) of i: l = 1 and 1.7 of 2.7, and the reverse at j."""
    state = states.snapshot(x=[[0.0, 0.0], [2.7, 0.0]], radius=[1.0, 2.0], i=[1], j=[2], point=[[1.0, 0.0]],
                            force=[[0.0, 0.0]])
    ends = contact_ends(state)
    found = contact_deformation(ends, np.array([0.3]), np.array([[0.0, 0.6], [0.0, -0.6]]))
    expected = np.array([[1.0 * 0.3, 1.0 * 0.6], [-1.7 * 0.3, -1.7 * 0.6]]) / 2.7
    np.testing.assert_allclose(found, expected, rtol=1e-14, atol=1e-16)


@pytest.mark.parametrize(("kind", "stiffness"), [("triangular", np.sqrt(3)), ("square", 1.0)])
def test_compressed_lattice(states, measure, kind, stiffness):
    """Spacing 2R(1 - o): eps = o/(1 - o) 1, and tr sigma/tr eps = 2 K, sqrt(3) k_n (square: k_n)."""
    o = 1e-3
    state = states.lattice(kind, o)
    np.testing.assert_allclose(measure(state, "elastic_strain")[0], o / (1 - o) * np.eye(2), rtol=1e-10, atol=1e-14)
    assert measure(state, "bulk_stiffness") == pytest.approx([stiffness * states.KN], rel=1e-11)


def test_sheared_lattice(states, measure):
    """Triangular, pure shear by springs k_n, k_t: dev sigma/dev eps = 2 G = sqrt(3)/2 (k_n + k_t); one direction."""
    state = states.lattice("triangular")
    n = -state.contacts.vector("fx", "fy")
    n /= np.linalg.norm(n, axis=1, keepdims=True)
    eps = 1e-3 * np.array([[0.4, 1.0], [1.0, -0.4]])
    moved = 2 * states.R * (1 - 1e-3) * n @ eps
    overlap = (moved * n).sum(axis=1)
    u = moved - overlap[:, None] * n
    force = -KN * overlap[:, None] * n - KT * u
    sheared = states.replace(state, contacts={
        **state.contacts, "overlap": overlap, **states.columns("u", u), **states.columns("f", force),
    })
    np.testing.assert_allclose(measure(sheared, "elastic_strain")[0], eps, rtol=1e-10, atol=1e-14)
    assert measure(sheared, "shear_stiffness") == pytest.approx([np.sqrt(3) / 2 * (KN + KT)], rel=1e-10)
    assert measure(sheared, "non_colinearity_stress_strain") == pytest.approx([0.0], abs=1e-8)


def test_strain_turns_with_the_sample(states, measure):
    eps = np.array([[1e-3, 4e-4], [-2e-4, 5e-4]])
    angle = 0.7
    turn = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
    state = strained(states, 5, 2, eps)
    turned = states.replace(states.moved(state, turn, np.array([3.0, -1.0])), box=state.box)
    np.testing.assert_allclose(measure(turned, "elastic_strain")[0], turn @ eps @ turn.T, atol=1e-14)


def test_contacts_in_one_line_have_no_strain(states, measure):
    chain = states.snapshot(
        x=[[1.0, 1.0], [3.0, 1.0], [5.0, 1.0]], radius=[1.0] * 3, i=[1, 2], j=[2, 3], point=[[2.0, 1.0], [4.0, 1.0]],
        force=[[-1.0, 0.0]] * 2, box=np.array([[0.0, 6.0], [0.0, 2.0]]), extra={"contacts": {"overlap": [0.1, 0.1]}},
    )
    assert np.isnan(measure(chain, "elastic_strain")).all()
    assert np.isnan(measure(chain, "bulk_stiffness")).all()


def test_springs_that_are_not_known_leave_no_strain(states, measure):
    state = states.random_contacts(3, 2)
    with pytest.raises(MissingColumn, match="contacts has no column 'ux', yet some forces have a tangential part"):
        measure(states.without(state, "contacts", "ux", "uy"), "elastic_strain")
    unknown = np.where(np.arange(state.contacts.rows) == 2, np.nan, 0.0)
    with pytest.raises(MissingColumn, match="contacts.u is not known in 1 of"):
        measure(states.replace(state, contacts={**state.contacts, "ux": unknown}), "elastic_strain")
