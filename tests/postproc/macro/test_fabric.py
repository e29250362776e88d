"""Fabric of hand-made states."""

import numpy as np
import pytest

from postproc.average import average


@pytest.fixture
def pair(states):
    """Discs of radius 1 and 2 touching along x; the large one also touches a wall below it."""
    return states.snapshot(
        x=[[1.0, 2.0], [4.0, 2.0]], radius=[1.0, 2.0], i=[1, 2], j=[2, -1],
        point=[[2.0, 2.0], [4.0, 0.0]], force=np.zeros((2, 2)), box=np.array([[0.0, 10.0], [0.0, 10.0]]),
    )


def test_fabric_weighs_contacts_by_particle_volume(pair):
    """V F = sum V^p sum n n: pi (1 + 4) along x, 4 pi along y."""
    np.testing.assert_allclose(average(pair)["fabric"][0], np.pi * np.diag([5.0, 4.0]) / 100.0, rtol=1e-14)


def test_contact_fabric_counts_ends_in_the_cell(pair):
    """Two ends along x, one along y: trace 1."""
    np.testing.assert_allclose(average(pair)["contact_fabric"][0], np.diag([2.0, 1.0]) / 3.0, rtol=1e-14)


def test_fabric_of_a_particle_is_the_sum_over_its_contacts(pair):
    each = average(pair, cells="particles")
    np.testing.assert_allclose(each["fabric"], [np.diag([1.0, 0.0]), np.diag([1.0, 1.0])], atol=1e-15)


def test_no_contacts_is_no_fabric_but_not_unknown(states):
    state = states.snapshot(x=[[0.5, 0.5]], radius=[0.1], box=np.array([[0.0, 1.0], [0.0, 1.0]]))
    averages = average(state)
    assert (averages["fabric"] == 0).all()
    assert (averages["stress"] == 0).all()
    assert np.isnan(averages["contact_fabric"]).all()
    assert np.isnan(averages["unbalanced_force"]).all()
