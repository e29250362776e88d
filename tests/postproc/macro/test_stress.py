"""Stress: hand-made states, sum rules on random states, and mutants that must be caught."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import postproc.fields
from postproc.average import average
from postproc.averaging.particles import Particles
from postproc.macro.contact_ends import ContactEnds, contact_ends
from postproc.macro.stress import stress

seeds = st.integers(0, 2**32 - 1)
dims = st.sampled_from((2, 3))
few = settings(max_examples=25, deadline=None)


def box_stress(state, **options):
    return average(state, **options)["stress"][0]


def test_push_from_the_right_is_compression(states):
    """One disc between a left and a right wall, pushed with 3 N: sigma_xx = 3 N * 1 m / 1 m^2."""
    state = states.snapshot(
        x=[[0.5, 0.5]], radius=[0.5], i=[1, 1], j=[-1, -2],
        point=[[0.0, 0.5], [1.0, 0.5]], force=[[3.0, 0.0], [-3.0, 0.0]], box=np.array([[0.0, 1.0], [0.0, 1.0]]),
    )
    np.testing.assert_allclose(box_stress(state), [[3.0, 0.0], [0.0, 0.0]], atol=1e-15)


def test_first_index_is_the_branch_second_the_force(states):
    """One contact on the right of the disc, dragged upwards with 2 N: only sigma_xy, -(1/V) l_x f_y."""
    state = states.snapshot(
        x=[[0.5, 0.5]], radius=[0.25], i=[1], j=[-2], point=[[0.75, 0.5]], force=[[0.0, 2.0]],
        box=np.array([[0.0, 1.0], [0.0, 2.0]]),
    )
    np.testing.assert_allclose(box_stress(state), [[0.0, -0.25 * 2.0 / 2.0], [0.0, 0.0]], atol=1e-15)


def test_branch_vectors_of_unequal_discs(states):
    """Discs of radius 1 and 3 pressed together with 5 N: sigma^p V^p = 5 N * own radius."""
    state = states.snapshot(
        x=[[1.0, 5.0], [5.0, 5.0]], radius=[1.0, 3.0], i=[1], j=[2], point=[[2.0, 5.0]], force=[[-5.0, 0.0]],
        box=np.array([[0.0, 10.0], [0.0, 10.0]]),
    )
    each = average(state, cells="particles")["stress"][:, 0, 0]
    np.testing.assert_allclose(each * np.pi * np.array([1.0, 9.0]), [5.0, 15.0], rtol=1e-15)
    assert box_stress(state)[0, 0] == pytest.approx(5.0 * 4.0 / 100.0, rel=1e-15)


def test_contact_through_a_periodic_face(states):
    """Two discs that touch through the face x = 0 = 10, written with the point at either end."""
    for point in (0.0, 10.0):
        state = states.snapshot(
            x=[[1.0, 5.0], [9.0, 5.0]], radius=[1.0, 1.0], i=[1], j=[2], point=[[point, 5.0]],
            force=[[5.0, 0.0]], box=np.array([[0.0, 10.0], [0.0, 10.0]]), periodic=(True, False),
        )
        np.testing.assert_allclose(box_stress(state), [[5.0 * 2.0 / 100.0, 0.0], [0.0, 0.0]], atol=1e-15)


def test_periodic_state_without_a_box_has_no_stress(states):
    state = states.replace(states.lattice("square"), box=None)
    assert "no box" in average(state, cells="particles").in_cells["stress"].reason


@few
@given(seed=seeds, dim=dims)
def test_balanced_contacts_carry_the_stress_of_the_walls(states, seed, dim):
    """V sigma = sum x (x) f over the boundary, all components, any friction, any contact points."""
    state = states.balanced(seed, dim)
    averages = average(state)
    expected = averages["stress_from_wall_contacts"]
    np.testing.assert_allclose(averages["stress"], expected, rtol=1e-9, atol=1e-10)
    assert averages["unbalanced_force"] == pytest.approx([0.0], abs=1e-9)


@few
@given(seed=seeds, dim=dims)
def test_unbalanced_contacts_differ_from_the_walls_by_the_net_forces(states, seed, dim):
    """V (sigma - sigma_walls) = sum_p (x^p - middle) F^p."""
    state = states.random_contacts(seed, dim)
    averages = average(state)
    ends = contact_ends(state)
    x = state.particles.vector(*state.axes) - state.box.mean(axis=1)
    virial = np.einsum("pa,pb->ab", x, ends.sum_c(ends.f))
    volume = np.prod(np.diff(state.box, axis=1))
    difference = averages["stress"][0] - averages["stress_from_wall_contacts"][0]
    np.testing.assert_allclose(difference * volume, virial, rtol=1e-9, atol=1e-9)


@few
@given(seed=seeds, dim=dims)
def test_total_is_the_sum_over_particles(states, seed, dim):
    state = states.random_contacts(seed, dim)
    volume = np.prod(np.diff(state.box, axis=1))
    each = average(state, cells="particles")
    volumes = Particles(snapshot=state).volumes
    whole = average(state)
    for name in ("stress", "fabric"):
        total = np.tensordot(volumes, each[name], axes=1)
        np.testing.assert_allclose(total, volume * whole[name][0], rtol=1e-10, atol=1e-10)
    assert volumes.sum() == pytest.approx(volume * whole["volume_fraction"][0], rel=1e-12)
    for name in ("normal_elastic_energy", "tangential_elastic_energy", "translational_energy", "rotational_energy"):
        assert each[name].sum() == pytest.approx(whole[name][0], rel=1e-12)


@few
@given(seed=seeds, dim=dims)
def test_tensors_turn_with_the_state_and_do_not_see_shifts(states, seed, dim):
    state = states.random_contacts(seed, dim)
    turn, _ = np.linalg.qr(np.random.default_rng(seed).normal(size=(dim, dim)))
    before = average(state, cells="particles")
    after = average(states.moved(state, turn, np.arange(1.0, dim + 1)), cells="particles")
    for name in ("stress", "fabric", "contact_fabric"):
        np.testing.assert_allclose(after[name], turn @ before[name] @ turn.T, rtol=1e-8, atol=1e-8)
    for name in ("stress_principal", "stress_deviator", "fabric_principal"):
        np.testing.assert_allclose(after[name], before[name], rtol=1e-8, atol=1e-8)


@few
@given(seed=seeds, dim=dims)
def test_swapping_the_partners_of_a_contact_changes_nothing(states, seed, dim):
    """Row (i, j, f) and row (j, i, -f) are one contact."""
    state = states.random_contacts(seed, dim)
    c = state.contacts
    pair = c["j"] > 0
    force = {name: np.where(pair, -c[name], c[name]) for name in c if name[0] == "f"}
    swapped = {**c, **force, "i": np.where(pair, c["j"], c["i"]), "j": np.where(pair, c["i"], c["j"])}
    before, after = (average(s, cells="particles") for s in (state, states.replace(state, contacts=swapped)))
    for name in ("stress", "fabric", "coordination_number", "unbalanced_force", "normal_elastic_energy"):
        np.testing.assert_allclose(after[name], before[name], rtol=1e-10, atol=1e-10)


@few
@given(seed=seeds, dim=dims)
def test_order_of_rows_does_not_matter(states, seed, dim):
    state = states.random_contacts(seed, dim)
    rng = np.random.default_rng(seed)
    order = {g: rng.permutation(getattr(state, g).rows) for g in ("particles", "contacts")}
    shuffled = {g: {k: v[order[g]] for k, v in getattr(state, g).items()} for g in order}
    before, after = (average(s, cells="particles") for s in (state, states.replace(state, **shuffled)))
    for name in ("stress", "coordination_number", "unbalanced_force"):
        np.testing.assert_allclose(after[name], before[name][order["particles"]], rtol=1e-10, atol=1e-10)


@few
@given(seed=seeds, dim=dims)
def test_forces_between_particles_cancel(states, seed, dim):
    """Newton's third law: only the walls are left in the sum of all forces on all particles."""
    state = states.random_contacts(seed, dim)
    ends = contact_ends(state)
    at_wall = state.contacts["j"] < 0
    force = state.contacts.vector(*("f" + a for a in state.axes))
    np.testing.assert_allclose(ends.f.sum(axis=0), force[at_wall].sum(axis=0), atol=1e-12)
    assert len(ends.f) == 2 * (~at_wall).sum() + at_wall.sum()
    assert ends.share.sum() == state.contacts.rows


def test_kinetic_stress_of_two_crossing_streams(states):
    """Masses 1 and 3 kg with momenta that cancel: sigma^k = (1/V) sum m v v, pressure positive."""
    state = states.snapshot(
        x=[[1.0, 1.0], [1.0, 1.0]], radius=[0.1, 0.1], box=np.array([[0.0, 2.0], [0.0, 2.0]]),
        extra={"particles": {"mass": [1.0, 3.0], "vx": [7.0 + 3.0, 7.0 - 1.0], "vy": [-3.0, 1.0]}},
    )
    np.testing.assert_allclose(average(state)["kinetic_stress"][0], 3.0 * np.array([[1, -1], [-1, 1]]), rtol=1e-13)


def _reaction_not_reversed(state):
    ends = contact_ends(state)
    force = state.contacts.vector(*("f" + a for a in state.axes))
    return _changed(ends, f=force[ends.contact])


def _branch_of_the_wrong_partner(state):
    ends = contact_ends(state)
    x = state.particles.vector(*state.axes)
    other = np.where(ends.partner < 0, ends.particle, ends.partner)
    return _changed(ends, l=ends.l + x[ends.particle] - x[other])


def _ends_at_j_forgotten(state):
    ends = contact_ends(state)
    first = np.arange(len(ends.f)) < state.contacts.rows
    return _changed(ends, f=np.where(first[:, None], ends.f, 0.0))


def _walls_forgotten(state):
    ends = contact_ends(state)
    return _changed(ends, f=np.where(ends.partner[:, None] < 0, 0.0, ends.f))


def _nearest_image_ignored(state):
    ends = contact_ends(state)
    point = state.contacts.vector(*("p" + a for a in state.axes))
    return _changed(ends, l=point[ends.contact] - state.particles.vector(*state.axes)[ends.particle])


def _changed(ends, **changes):
    kept = {k: getattr(ends, k) for k in ("count", "particle", "partner", "contact", "l", "f")}
    return ContactEnds(**kept | changes)


MUTANTS = {
    "wrong sign": ("stress", lambda ends, cells: -stress(ends, cells), "test_push_from_the_right_is_compression"),
    "halved": ("stress", lambda ends, cells: stress(ends, cells) / 2, "test_push_from_the_right_is_compression"),
    "transposed": (
        "stress",
        lambda ends, cells: stress(ends, cells).swapaxes(1, 2),
        "test_first_index_is_the_branch_second_the_force",
    ),
    "symmetrised": (
        "stress",
        lambda ends, cells: (stress(ends, cells) + stress(ends, cells).swapaxes(1, 2)) / 2,
        "test_first_index_is_the_branch_second_the_force",
    ),
    "branch of the wrong partner": (
        "contact_ends", _branch_of_the_wrong_partner, "test_branch_vectors_of_unequal_discs",
    ),
    "reaction not reversed": ("contact_ends", _reaction_not_reversed, "test_branch_vectors_of_unequal_discs"),
    "ends at j forgotten": ("contact_ends", _ends_at_j_forgotten, "test_branch_vectors_of_unequal_discs"),
    "walls forgotten": ("contact_ends", _walls_forgotten, "test_push_from_the_right_is_compression"),
    "nearest image ignored": ("contact_ends", _nearest_image_ignored, "test_contact_through_a_periodic_face"),
}
"""Name: (what is replaced in the list of fields, by what, the test that must fail)."""


@pytest.mark.parametrize("name", MUTANTS)
def test_mutant_is_caught(name, states, monkeypatch):
    target, mutant, catcher = MUTANTS[name]
    globals()[catcher](states)  # passes with the right physics
    monkeypatch.setattr(postproc.fields, target, mutant)
    with pytest.raises(AssertionError):
        globals()[catcher](states)


@pytest.mark.parametrize("name", ["transposed", "branch of the wrong partner", "reaction not reversed",
                                  "ends at j forgotten", "walls forgotten", "wrong sign", "halved"])
def test_balance_with_the_walls_catches_the_mutant_too(name, states, monkeypatch):
    target, mutant, _ = MUTANTS[name]
    monkeypatch.setattr(postproc.fields, target, mutant)
    state = states.balanced(1, 2)
    averages = average(state)
    assert not np.allclose(averages["stress"], averages["stress_from_wall_contacts"], rtol=1e-3)
