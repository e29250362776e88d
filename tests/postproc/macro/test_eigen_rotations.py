"""Sliding and rolling parts of rotations."""

import numpy as np
import pytest

from postproc.snapshot import MissingColumn


def spinning(states, state, spin, velocity=None):
    x = state.particles.vector("x", "y")
    v = np.zeros_like(x) if velocity is None else velocity(x)
    return states.replace(state, particles={
        **state.particles, "wz": spin, "mass": np.ones(len(x)), **states.columns("v", v)})


def test_pair_of_unequal_discs(states, measure):
    """Radii 1 and 2, spins 3 and -6: (1 * 3 - 2 * 6)/3 = -3; rolling (3 + 6)/2 along n, whichever is listed first."""
    x, radius, spin = np.array([[0.0, 0.0], [3.0, 0.0], [0.0, 9.0]]), [1.0, 2.0, 1.0], np.array([3.0, -6.0, 0.0])
    for i, j in ((1, 2), (2, 1)):
        state = states.snapshot(x=x, radius=radius, i=[i], j=[j], point=[[1.0, 0.0]], force=[[0.0, 0.0]],
                                box=np.array([[-9.0, 9.0]] * 2))
        state = spinning(states, state, spin)
        assert measure(state, "sliding_rotation") == pytest.approx([-3.0], rel=1e-12)
        np.testing.assert_allclose(measure(state, "rolling_rotation"), [[4.5, 0.0]], rtol=1e-14)


def test_rigid_rotation_neither_slides_nor_rolls(states, measure):
    state = states.random_contacts(3, 2)
    state = spinning(states, state, np.full(9, 0.7), lambda x: 0.7 * np.column_stack([-x[:, 1], x[:, 0]]))
    assert measure(state, "sliding_rotation") == pytest.approx([0.0], abs=1e-12)
    np.testing.assert_allclose(measure(state, "rolling_rotation"), 0.0, atol=1e-15)


def test_walls_are_left_out(states, measure):
    state = states.random_contacts(3, 2)
    spin = np.random.default_rng(1).normal(size=9)
    inner = states.replace(state, contacts={k: v[state.contacts["j"] > 0] for k, v in state.contacts.items()})
    for name in ("sliding_rotation", "rolling_rotation"):
        np.testing.assert_allclose(*(measure(spinning(states, s, spin), name) for s in (state, inner)), rtol=1e-12)


def test_gears_roll_and_do_not_slide(states, measure):
    """Square lattice, spins +1 and -1 like a chess board: no contact slips, neighbours' differences cancel in sum."""
    state = states.lattice("square")
    board = np.round(state.particles.vector("x", "y") / (2 * states.R * (1 - 1e-3))).sum(axis=1)
    gears = spinning(states, state, (-1.0) ** board)
    assert measure(gears, "sliding_rotation") == pytest.approx([0.0], abs=1e-12)
    np.testing.assert_allclose(measure(gears, "rolling_rotation"), 0.0, atol=1e-12)


def test_they_need_a_plane(states, measure):
    for name in ("sliding_rotation", "rolling_rotation"):
        with pytest.raises(MissingColumn, match="need a 2D state"):
            measure(states.random_contacts(3, 3), name)
