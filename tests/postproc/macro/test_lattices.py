"""Regular lattices with a known overlap: every average in closed form."""

import numpy as np
import pytest

from postproc.average import average

OVERLAP = 1e-3

# distance s of neighbours, force f: particles per s^dim, contacts of a particle, stress f/s^(dim-1) x
LATTICES = {
    "square": (1.0, 4, 1.0),
    "triangular": (2.0 / np.sqrt(3.0), 6, np.sqrt(3.0)),
    "cubic": (1.0, 6, 1.0),
    "fcc": (np.sqrt(2.0), 12, 2.0 * np.sqrt(2.0)),
}


@pytest.fixture(params=LATTICES, scope="module")
def case(request, states):
    state = states.lattice(request.param, OVERLAP, repeats=4 if request.param != "fcc" else 3)
    return request.param, state, average(state, kn=states.KN)


def test_volume_fraction(case, states):
    kind, state, averages = case
    density, _, _ = LATTICES[kind]
    grain = np.pi * states.R**2 if state.dimension == 2 else 4 / 3 * np.pi * states.R**3
    spacing = 2 * states.R * (1 - OVERLAP)
    assert averages["volume_fraction"] == pytest.approx([density * grain / spacing**state.dimension], rel=1e-13)


def test_coordination_number(case):
    kind, _, averages = case
    _, contacts, _ = LATTICES[kind]
    assert averages["coordination_number"].tolist() == [contacts]
    assert averages["backbone_coordination_number"].tolist() == [contacts]
    assert averages["rattler_fraction"].tolist() == [0.0]


def test_stress_is_isotropic_compression(case, states):
    kind, state, averages = case
    spacing = 2 * states.R * (1 - OVERLAP)
    force = states.KN * 2 * states.R * OVERLAP
    pressure = LATTICES[kind][2] * force / spacing ** (state.dimension - 1)
    expected = pressure * np.eye(state.dimension)
    np.testing.assert_allclose(averages["stress"][0], expected, rtol=1e-11, atol=1e-11 * pressure)
    assert averages["stress_isotropic"] == pytest.approx([pressure], rel=1e-11)
    assert averages["stress_deviator"] == pytest.approx([0.0], abs=1e-10 * pressure)


def test_fabric(case):
    kind, state, averages = case
    _, contacts, _ = LATTICES[kind]
    unit = np.eye(state.dimension) / state.dimension
    expected = averages["volume_fraction"] * contacts * unit
    np.testing.assert_allclose(averages["fabric"][0], expected, rtol=1e-12, atol=1e-12)
    np.testing.assert_allclose(averages["contact_fabric"][0], unit, rtol=1e-12, atol=1e-12)
    assert averages["fabric_trace"] == pytest.approx(averages["volume_fraction"] * contacts, rel=1e-12)


def test_elastic_energy(case, states):
    kind, state, averages = case
    _, contacts, _ = LATTICES[kind]
    each = states.KN * (2 * states.R * OVERLAP) ** 2 / 2
    expected = state.particles.rows * contacts / 2 * each
    assert averages["normal_elastic_energy"] == pytest.approx([expected], rel=1e-9)
    assert averages["tangential_elastic_energy"].tolist() == [0.0]


def test_forces_balance(case):
    assert case[2]["unbalanced_force"] == pytest.approx([0.0], abs=1e-9)


def test_each_particle_of_a_lattice_is_alike(case):
    """sigma^p V^p adds up to sigma V, so on a lattice sigma^p = sigma/nu."""
    _, state, averages = case
    each = average(state, cells="particles")
    expected = np.broadcast_to(averages["stress"] / averages["volume_fraction"], each["stress"].shape)
    np.testing.assert_allclose(each["stress"], expected, rtol=1e-10, atol=1e-10 * expected.max())
    assert set(each["coordination_number"]) == set(averages["coordination_number"])
    np.testing.assert_allclose(np.trace(each["fabric"], axis1=1, axis2=2), each["coordination_number"], rtol=1e-12)


def test_thickness_divides_the_stress_of_a_2d_state_and_nothing_else(states):
    thin, thick = (average(states.lattice("triangular", thickness=h)) for h in (1.0, 4.0))
    np.testing.assert_allclose(thick["stress"], thin["stress"] / 4.0, rtol=1e-14, atol=1e-14)
    np.testing.assert_allclose(thick["fabric"], thin["fabric"], rtol=1e-14, atol=1e-14)
    assert thick["volume_fraction"] == pytest.approx(thin["volume_fraction"], rel=1e-14)
