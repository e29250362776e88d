"""All rows of the table of fields at once: frames, dimensions, units."""

import dataclasses

import numpy as np
import pytest

from postproc.averaging.registry import make_cells
from postproc.fields import COMPONENTS, IN_CELLS, PER_THICKNESS, Subject
from postproc.results import Unavailable
from postproc.undefined import OTHERWISE, Gaps

ANGLE = 0.7
TURN = np.array([[np.cos(ANGLE), -np.sin(ANGLE)], [np.sin(ANGLE), np.cos(ANGLE)]])

OF_THE_FRAME = {"fabric_orientation", "stiffness_anisotropy", "contact_directions", "wall_contact_directions"}
"""Plain numbers that refer to the first axis of the frame."""

IN_THE_PLANE = {
    "sliding_rotation", "rolling_rotation", "rotation", "rotation_gradient", "fabric_orientation", "contact_directions",
    "wall_contact_directions", "principal_stiffness_anisotropy",
}


@pytest.fixture
def state(states):
    full = states.random_contacts(11, 2, count=60)
    rotation, couple = np.linspace(-1, 1, 60), np.linspace(-1, 1, full.contacts.rows)
    return states.replace(
        full, particles={**full.particles, "rotation": rotation}, contacts={**full.contacts, "mz": couple}
    )


def subject_of(states, state, cells, turn=None, **settings):
    """Take displacements since an affine reference; with a turn, both states turned about the origin, without a box."""
    x = state.particles.vector("x", "y")
    before = states.replace(state, particles={
        **state.particles, **states.columns("", x @ np.array([[1.02, 0.01], [-0.03, 0.99]]).T + 0.05),
        "rotation": state.particles["rotation"] ** 2})
    if turn is not None:
        state, before = (states.moved(s, turn, np.zeros(2)) for s in (state, before))
    return Subject(cells=make_cells(cells, state, **settings), reference=before, rate=1.0, gravity=None)


def values_of(subject):
    found = {field.name: field.evaluate(subject) for field in IN_CELLS}
    assert not [n for n, r in found.items() if isinstance(r, Unavailable)]
    return {name: result.values for name, result in found.items()}


def same(found, expected, name):
    scale = np.nanmax(np.abs(expected), initial=1e-300)
    np.testing.assert_allclose(found, expected, rtol=1e-9, atol=1e-9 * scale, err_msg=name)


def test_polar_components_do_not_see_a_turn_about_the_centre(states, state):
    """Every field in rings; directions histograms too, since no direction lies within round-off of a bin's border."""
    first, second = (values_of(subject_of(states, state, "rings:3:0:4", turn)) for turn in (np.eye(2), TURN))
    for name, values in first.items():
        same(second[name], values, name)


def test_cartesian_components_turn_with_the_state(states, state):
    """Vectors and tensors of every rank turn, numbers stay; over one cell that holds everything."""
    first, second = (
        values_of(subject_of(states, state, "rings:1:0:9", turn, frame="cartesian")) for turn in (np.eye(2), TURN)
    )
    for field in IN_CELLS:
        before, after = first[field.name], second[field.name]
        if field.name in OF_THE_FRAME or field.rank in ("stiffness", "histogram") or field.name.endswith("_major"):
            continue
        if field.rank in ("vector", "couple"):
            same(after, before @ TURN.T, field.name)
        elif field.rank == "tensor":
            same(after, TURN @ before @ TURN.T, field.name)
        else:
            same(after, before, field.name)


def test_stiffness_turns_as_a_tensor_of_fourth_rank(states, state):
    first, second = (subject_of(states, state, "rings:1:0:9", turn, frame="cartesian") for turn in (np.eye(2), TURN))
    expected = np.einsum("ai,bj,ck,dl,xijkl->xabcd", TURN, TURN, TURN, TURN, first.stiffness)
    same(second.stiffness, expected, "stiffness")


def test_points_turn_their_averages(states, state):
    """Coarse graining: polar components are the Cartesian ones turned by the angle of the point."""
    plain, polar = (subject_of(states, state, "points:4x4", frame=frame) for frame in ("cartesian", "polar"))
    angle = np.arctan2(plain.cells.points[:, 1], plain.cells.points[:, 0])
    turn = np.stack([np.stack([np.cos(angle), np.sin(angle)], -1), np.stack([-np.sin(angle), np.cos(angle)], -1)], 1)
    for field in IN_CELLS:
        before, after = (field.evaluate(subject) for subject in (plain, polar))
        if field.rank == "histogram":
            assert "in the Cartesian frame only" in after.reason
        elif field.rank in ("vector", "couple"):
            turned = np.einsum("kab,kb->ka", turn, before.values)
            same(np.abs(after.values) if field.name.endswith("_major") else after.values,
                 np.abs(turned) if field.name.endswith("_major") else turned, field.name)
        elif field.rank == "tensor":
            same(after.values, np.einsum("kab,kcd,kbd->kac", turn, turn, before.values), field.name)
        elif field.rank != "stiffness" and field.name not in OF_THE_FRAME:
            same(after.values, before.values, field.name)
    expected = np.einsum("xai,xbj,xck,xdl,xijkl->xabcd", turn, turn, turn, turn, plain.stiffness)
    same(polar.stiffness, expected, "stiffness")


@pytest.mark.parametrize("cells", ["box", "inner", "particles", "strips:z:3", "rings:3:0:1"])
def test_in_space_every_field_has_its_shape_or_a_reason(states, cells):
    state = states.random_contacts(5, 3, count=80)
    couples = {"m" + a: np.linspace(-1, 1, state.contacts.rows) for a in "xyz"}
    state = states.replace(state, contacts={**state.contacts, **couples})
    subject = Subject(cells=make_cells(cells, state), reference=state, rate=1.0)
    for field in IN_CELLS:
        result = field.evaluate(subject)
        assert isinstance(result, Unavailable) == (field.name in IN_THE_PLANE), field.name
        if field.name not in IN_THE_PLANE:
            assert result.components == COMPONENTS[field.rank](subject.cells.axes)
            assert result.values[0].size == max(len(result.components), 1), field.name


def test_units_of_a_state_per_thickness_lose_a_length(states, state):
    """What is per volume is per area: the same numbers; with a thickness they are divided by it."""
    thick = dataclasses.replace(state, thickness=0.5)
    thin, other = (Subject(cells=make_cells("box", s), reference=s, rate=1.0) for s in (state, thick))
    for field in IN_CELLS:
        a, b = field.evaluate(thin), field.evaluate(other)
        assert a.unit == PER_THICKNESS.get(field.unit, field.unit)
        assert b.unit == field.unit
        if field.unit in PER_THICKNESS:
            same(b.values, a.values / 0.5, field.name)
        elif field.name != "inertial_number":
            same(b.values, a.values, field.name)


@pytest.mark.parametrize("cells", ["particles", "strips:x:9"])
def test_every_gap_has_a_reason_of_its_own(states, state, cells):
    """Sparse contacts, cells of one particle: no NaN is left with the general phrase."""
    few = {k: v[state.contacts["i"] % 4 == 0] for k, v in state.contacts.items()}
    sparse = states.replace(state, contacts=few)
    subject = Subject(cells=make_cells(cells, sparse), reference=sparse, rate=1.0)
    gaps = Gaps(cells=subject.cells)
    found = {field.name: gaps.explain(field.name, field.evaluate(subject)) for field in IN_CELLS}
    with_gaps = {name for name, result in found.items() if np.isnan(result.values).any()}
    assert with_gaps >= {"wall_contact_directions", *(("torque_stiffness",) if cells == "particles" else ())}
    assert [name for name in with_gaps if OTHERWISE in found[name].undefined] == []
