"""Turned states have turned tensors; in polar frames they have the same."""

import numpy as np
import pytest

from postproc.average import average
from postproc.averaging.frame import polar_turn
from postproc.geometry import positions
from postproc.results import columns_of

TENSORS = ("stress", "fabric", "kinetic_stress", "contact_fabric")


@pytest.fixture(params=[2, 3])
def state(request, states):
    return states.random_contacts(5, request.param, count=300)


def turned(states, state, angle):
    """The state turned about the z axis; the box stays, rings about the axis do not see it."""
    turn = np.eye(state.dimension)
    turn[:2, :2] = [[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]]
    return turn, states.replace(states.moved(state, turn, 0.0), box=state.box)


def test_cartesian_tensors_of_rings_turn_with_the_state(states, state):
    turn, other = turned(states, state, 0.4)
    before, after = (average(s, cells="rings:4:0.2:1.0", frame="cartesian") for s in (state, other))
    for name in TENSORS:
        expected = np.einsum("ac,kcd,bd->kab", turn, before[name], turn)
        np.testing.assert_allclose(after[name], expected, rtol=1e-10, atol=1e-10 * np.abs(expected).max())


def test_polar_tensors_of_rings_do_not(states, state):
    _, other = turned(states, state, 0.4)
    before, after = (average(s, cells="rings:4:0.2:1.0") for s in (state, other))
    for name in TENSORS:
        np.testing.assert_allclose(after[name], before[name], rtol=1e-10, atol=1e-10 * np.abs(before[name]).max())


def test_particles_in_the_polar_frame_are_turned_by_their_own_angle(state):
    cartesian, polar = (average(state, cells="particles", frame=frame) for frame in ("cartesian", "polar"))
    turn = polar_turn(positions(state))
    expected = turn @ cartesian["stress"] @ turn.swapaxes(1, 2)
    np.testing.assert_allclose(polar["stress"], expected, rtol=1e-11, atol=1e-11 * np.abs(expected).max())
    for name in ("stress_isotropic", "stress_deviator", "coordination_number", "normal_elastic_energy"):
        np.testing.assert_allclose(polar[name], cartesian[name], rtol=1e-10)


def test_names_of_components(state):
    axes = ["r", "phi", "z"][: state.dimension]
    averages = average(state, cells="rings:2:0.2:1.0")
    assert averages.frame == "polar"
    assert list(averages.in_cells["kinetic_stress"].components) == [a + b for a in axes for b in axes]
    assert list(averages.of_state["stress_from_walls"].components) == [a + b for a in state.axes for b in state.axes]
    assert "stress_rphi (N/m)" in columns_of(averages.in_cells) or state.dimension == 3
    assert averages["r_outer"] == pytest.approx([0.6, 1.0])


def test_gravity_is_turned_too(states):
    """A disc that hangs still under gravity is balanced in every frame."""
    state = states.snapshot(
        x=[[1.0, 1.0]], radius=[0.5], i=[1], j=[-1], point=[[1.0, 1.5]], force=[[0.0, 9.81]],
        extra={"particles": {"mass": [1.0]}},
    )
    for frame in ("cartesian", "polar"):
        averages = average(state, cells="particles", frame=frame, gravity=(0.0, -9.81))
        assert averages["unbalanced_force"] == pytest.approx([0.0], abs=1e-15)
