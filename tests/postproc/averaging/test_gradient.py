"""Gradients are exact for affine fields in every kind of cell and frame, and unknown where they must be."""

import numpy as np
import pytest

from postproc.averaging.frame import polar_turn, turn_tensors, turn_vectors
from postproc.averaging.gradient import affine_fit
from postproc.averaging.registry import CELLS, make_cells
from postproc.geometry import positions

LARGE = [kind for kind in CELLS if kind not in ("particles", "points")]
"""Kinds that fit: one particle has no gradient, coarse graining differentiates its kernel."""


@pytest.fixture(params=[(kind, dim) for kind in LARGE for dim in (2, 3)], ids=str)
def crowded(request, states):
    kind, dim = request.param
    return states.words(kind, dim), states.random_contacts(11, dim, count=900)


def test_affine_fields_have_their_slope_to_round_off(crowded):
    words, state = crowded
    rng = np.random.default_rng(1)
    dim, x, mass = state.dimension, positions(state), state.particles["mass"]
    slope, vector_slope, offset = rng.normal(size=dim), rng.normal(size=(dim, dim)), 1e3
    cells = make_cells(words, state, frame="cartesian")
    for weight in (None, mass):
        found = cells.gradient(x @ slope + offset, weight)
        np.testing.assert_allclose(found, np.broadcast_to(slope, found.shape), rtol=1e-11, atol=1e-11)
        found = cells.gradient(x @ vector_slope.T - offset, weight)
        np.testing.assert_allclose(found, np.broadcast_to(vector_slope, found.shape), rtol=1e-11, atol=1e-11)


def test_a_rigid_rotation_is_a_rotation_in_both_frames(crowded):
    """L = Omega (0, -1; 1, 0) to 1e-12: no rate of strain; about the origin, in Cartesian and polar components."""
    words, state = crowded
    x, Omega = positions(state), 0.7
    v = np.zeros_like(x)
    v[:, 0], v[:, 1] = -Omega * x[:, 1], Omega * x[:, 0]
    rigid = np.zeros((state.dimension,) * 2)
    rigid[0, 1], rigid[1, 0] = -Omega, Omega
    for frame in ("cartesian", "polar"):
        cells = make_cells(words, state, frame=frame)
        found = cells.gradient(cells.turned(v), state.particles["mass"])
        np.testing.assert_allclose(found, np.broadcast_to(rigid, found.shape), atol=1e-12)


@pytest.mark.parametrize(("words", "dim"), [("grid:3x4", 2), ("strips:z:4", 3)])
def test_polar_gradients_of_other_cells_are_turned_by_the_angle_of_their_middle(states, words, dim):
    state = states.random_contacts(11, dim, count=900)
    x, slope = positions(state), np.random.default_rng(1).normal(size=(dim, dim))
    cells = make_cells(words, state, frame="polar")
    turn = polar_turn(cells.mean(x))
    found = cells.gradient(cells.turned(x @ slope.T + 3.0))
    np.testing.assert_allclose(found, turn @ slope @ turn.swapaxes(1, 2), atol=1e-11)
    found = cells.gradient(x @ slope[0])
    np.testing.assert_allclose(found, turn @ slope[0], atol=1e-11)


def test_polar_gradients_of_rings_in_closed_form(states):
    """v_r = a + b r, v_phi = c + d r: L = (b, -v_phi/r; d, v_r/r) at the mean r of the particles."""
    state = states.random_contacts(3, 2, count=600)
    cells = make_cells("rings:4:0.2:1.0", state)
    x = positions(state)
    r = np.hypot(*x.T)
    a, b, c, d = 0.3, -1.2, 0.5, 2.0
    found = cells.gradient(np.column_stack([a + b * r, c + d * r]))
    mean = cells.mean(r)
    expected = np.moveaxis(np.array([[np.full(4, b), -(c + d * mean) / mean], [np.full(4, d), (a + b * mean) / mean]]),
                           2, 0)
    np.testing.assert_allclose(found, expected, rtol=1e-11)
    np.testing.assert_allclose(cells.gradient(a + b * r), np.column_stack([np.full(4, b), np.zeros(4)]), rtol=1e-11)


def test_slopes_of_curved_fields_converge_with_the_square_of_the_width(states):
    """exp(-r) in rings that shrink: the error of dq/dr falls like the square of the ring's width."""
    r = 0.5 + (np.arange(100_000) + 0.5) / 100_000
    angle = np.arange(len(r)) * 2.4
    state = states.snapshot(x=np.column_stack([r * np.cos(angle), r * np.sin(angle)]), radius=np.full(len(r), 1e-9))
    errors = []
    widths = np.array([0.8, 0.4, 0.2])
    for width in widths:
        cells = make_cells(f"rings:{1 - width / 2},{1 + width / 2}", state, weights="centre")
        slope, mean = cells.gradient(np.exp(-r))[0, 0], cells.mean(r)[0]
        errors.append(abs(slope + np.exp(-mean)))
    order = np.polyfit(np.log(widths), np.log(errors), 1)[0]
    assert order == pytest.approx(2.0, abs=0.2)


@pytest.mark.parametrize("x", [[[0.0, 0.0]], [[0.0, 0.0], [1.0, 1.0]], [[0.1, 0.1], [0.2, 0.2], [0.7, 0.7]]])
def test_positions_on_a_line_have_no_gradient(x):
    x = np.array(x)
    fit = affine_fit(cell=np.zeros(len(x), dtype=int), row=np.arange(len(x)), weight=np.ones(len(x)), x=x, count=2)
    assert np.isnan(fit.slope(x[:, 0])).all()
    np.testing.assert_allclose(fit.mean(x)[0], x.mean(axis=0))
    assert np.isnan(fit.mean(x)[1]).all()
    assert np.isnan(fit.place[1]).all()


def test_one_particle_has_no_gradient(states):
    cells = make_cells("particles", states.random_contacts(3, 2))
    assert np.isnan(cells.gradient(np.ones((9, 2)))).all()


def test_periodic_images_keep_gradients_exact(states):
    """A disc that reaches into a cell from the other side counts where its image is."""
    lattice = states.lattice("triangular")
    cells = make_cells("strips:x:4", lattice)
    e = cells.entries
    low, high = lattice.box[0]
    assert (e.x[:, 0] < low).any() or (e.x[:, 0] > high).any() or (e.x[:, 0] == low).any()
    borders = cells.edges
    assert (np.abs(e.x[:, 0] - (borders[e.cell] + borders[e.cell + 1]) / 2) < np.diff(borders)[0] / 2 + states.R).all()


def test_polar_components():
    turn = polar_turn(np.array([[1.0, 0.0], [0.0, 2.0], [-3.0, 0.0], [0.0, 0.0]]))
    np.testing.assert_allclose(turn_vectors(turn, np.tile([1.0, 0.0], (4, 1))), [[1, 0], [0, -1], [-1, 0], [1, 0]],
                               atol=1e-16)
    rng = np.random.default_rng(0)
    turn, T = polar_turn(rng.normal(size=(5, 3))), rng.normal(size=(5, 3, 3))
    np.testing.assert_allclose(turn @ turn.swapaxes(1, 2), np.broadcast_to(np.eye(3), (5, 3, 3)), atol=1e-15)
    np.testing.assert_allclose(turn_tensors(turn, T), turn @ T @ turn.swapaxes(1, 2), atol=1e-14)
