"""Energies in closed form, and what makes them unavailable."""

import numpy as np
import pytest

from postproc.average import average


@pytest.fixture
def state(states):
    """Two discs, one mutual contact (overlap 2, spring 3) and one wall contact at disc 2 (4, 5)."""
    return states.snapshot(
        x=[[0.0, 0.0], [2.0, 0.0]], radius=[1.0, 1.0], i=[1, 2], j=[2, -1],
        point=[[1.0, 0.0], [3.0, 0.0]], force=[[-1.0, 0.3], [-1.0, 0.0]], box=np.array([[0.0, 3.0], [-1.0, 1.0]]),
        extra={
            "particles": {"mass": [2.0, 4.0], "inertia": [0.5, 1.0], "vx": [3.0, 0.0], "vy": [4.0, 1.0],
                          "wz": [2.0, -4.0]},
            "contacts": {"overlap": [2.0, 4.0], "ux": [0.0, 0.0], "uy": [3.0, 5.0], "kn": [10.0, 20.0],
                         "kt": [1.0, 2.0]},
        },
    )


def test_energies(state):
    averages = average(state)
    assert averages["translational_energy"].tolist() == [25.0 + 2.0]
    assert averages["rotational_energy"].tolist() == [1.0 + 8.0]
    assert averages["normal_elastic_energy"].tolist() == [20.0 + 160.0]
    assert averages["tangential_elastic_energy"].tolist() == [4.5 + 25.0]
    assert averages["kinetic_over_elastic_energy"] == pytest.approx([36.0 / 209.5])


def test_a_mutual_contact_is_shared_a_wall_contact_is_not(state):
    each = average(state, cells="particles")
    assert each["normal_elastic_energy"].tolist() == [10.0, 10.0 + 160.0]
    assert each["tangential_elastic_energy"].tolist() == [2.25, 2.25 + 25.0]


def test_given_stiffnesses_take_the_place_of_columns(states, state):
    averages = average(states.without(state, "contacts", "kn", "kt"), kn=2.0, kt=4.0)
    assert averages["normal_elastic_energy"].tolist() == [4.0 + 16.0]
    assert averages["tangential_elastic_energy"].tolist() == [18.0 + 50.0]


def test_without_springs_the_tangential_energy_is_unknown_if_forces_are_not_central(states, state):
    bare = states.without(state, "contacts", "ux", "uy")
    assert average(bare).in_cells["tangential_elastic_energy"].reason == (
        "contacts has no column 'ux', yet some forces have a tangential part"
    )
    assert "kinetic_over_elastic_energy" in str(_refusal(average(bare), "kinetic_over_elastic_energy"))
    central = states.replace(bare, contacts={**bare.contacts, "fy": np.zeros(2)})
    assert average(central)["tangential_elastic_energy"].tolist() == [0.0]


def test_springs_that_an_engine_cannot_tell_make_the_energy_unknown(states, state):
    c = dict(state.contacts)
    unknown = states.replace(state, contacts={**c, "ux": [0.0, np.nan], "uy": [3.0, np.nan]})
    assert average(unknown).in_cells["tangential_elastic_energy"].reason == (
        "contacts.u is not known in 1 of 2 rows"
    )
    assert average(unknown)["normal_elastic_energy"].tolist() == [180.0]


def _refusal(averages, name):
    with pytest.raises(KeyError) as caught:
        _ = averages[name]
    return caught.value
