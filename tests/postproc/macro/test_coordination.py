"""Coordination numbers and rattlers, against a definition by brute force."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from postproc.average import average
from postproc.macro.contact_ends import contact_ends
from postproc.macro.coordination import backbone


def _network(states, count, pairs, walls=()):
    """Contacts given as pairs of ids; walls: ids that touch wall 1."""
    x = np.column_stack([np.arange(count), np.zeros(count)])
    i = [a for a, _ in pairs] + list(walls)
    j = [b for _, b in pairs] + [-1] * len(walls)
    point = np.full((len(i), 2), 0.3)
    return states.snapshot(
        x=x, radius=np.ones(count), i=i, j=j, point=point, force=np.ones((len(i), 2)),
        box=np.array([[0.0, 1.0], [0.0, 1.0]]),
    )


def test_walls_count_as_contacts(states):
    averages = average(_network(states, 2, [(1, 2)], walls=[1, 2]))
    assert averages["coordination_number"].tolist() == [2.0]
    assert averages["backbone_coordination_number"].tolist() == [2.0]


def test_a_tail_of_rattlers_is_removed_step_by_step(states):
    """Triangle 1-2-3 with a tail 3-4-5 and a loner 6: removing 5 makes 4 a rattler."""
    state = _network(states, 6, [(1, 2), (2, 3), (1, 3), (3, 4), (4, 5)])
    averages = average(state)
    assert averages["coordination_number"].tolist() == pytest.approx([10 / 6])
    assert averages["backbone_coordination_number"].tolist() == [2.0]
    assert averages["rattler_fraction"].tolist() == [0.5]
    each = average(state, cells="particles")
    assert each["rattler_fraction"].tolist() == [0, 0, 0, 1, 1, 1]
    np.testing.assert_array_equal(each["backbone_coordination_number"], [2, 2, 2, np.nan, np.nan, np.nan])


def test_minimum_is_the_users(states):
    """A triangle stands with 2 contacts each, not with 3."""
    state = _network(states, 3, [(1, 2), (2, 3), (1, 3)])
    averages = average(state, minimum_contacts=3)
    assert averages["rattler_fraction"].tolist() == [1.0]
    assert np.isnan(averages["backbone_coordination_number"]).all()


@settings(max_examples=40, deadline=None)
@given(seed=st.integers(0, 2**32 - 1), minimum=st.integers(0, 4))
def test_backbone_is_the_largest_set_that_holds_itself(states, seed, minimum):
    """Brute force, one particle at a time in random order: the result must not depend on the order."""
    rng = np.random.default_rng(seed)
    pairs = [(a, b) for a in range(1, 10) for b in range(a + 1, 10) if rng.random() < 0.3]
    walls = [p for p in range(1, 10) if rng.random() < 0.2]
    stays = set(range(1, 10))

    def contacts_of(p):
        return sum(p in pair and set(pair) <= stays for pair in pairs) + walls.count(p)

    while weak := [p for p in stays if contacts_of(p) < minimum]:
        stays.remove(rng.choice(weak))
    found, contacts = backbone(contact_ends(_network(states, 9, pairs, walls)), minimum)
    assert set(np.flatnonzero(found) + 1) == stays
    assert [contacts_of(p) if p in stays else 0 for p in range(1, 10)] == contacts.tolist()
