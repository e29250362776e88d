"""The two models: stresses made from known stiffnesses give them back; residuals say what a model misses."""

import dataclasses

import numpy as np
import pytest

from postproc.macro.constitutive import ASYMMETRIC, Measured, no_rotations, unit_deviator, with_rotations
from postproc.macro.tensors import principal
from postproc.results import Unavailable

K = 40
TRUE = {"E_0": -50.0, "E_1": 80.0, "G_0": 20.0, "G_1": 15.0, "S": 7.0, "R": -3.0}


@pytest.fixture
def measured():
    """Random strains, fabrics and rotations, and the stress that the model with rotations makes of them."""
    rng = np.random.default_rng(8)
    strain = rng.normal(size=(K, 2, 2)) * 1e-3
    fabric = 2.0 * np.eye(2) * rng.uniform(0.8, 1.2, K)[:, None, None]
    sliding, rolling = rng.normal(size=(2, K)) * 1e-3
    parts, trace = principal(strain), np.trace(fabric, axis1=1, axis2=2)
    E, G = (TRUE[f"{name}_0"] + TRUE[f"{name}_1"] * trace for name in "EG")
    stress = (
        (E * parts.isotropic)[:, None, None] * np.eye(2)
        + (G * parts.deviator)[:, None, None] * unit_deviator(parts.major)
        + (TRUE["S"] * sliding + TRUE["R"] * rolling)[:, None, None] * ASYMMETRIC
    )
    return Measured(stress=stress, strain=strain, fabric=fabric, sliding=sliding, rolling=rolling)


def test_with_rotations_gives_the_stiffnesses_back(measured):
    found = with_rotations(measured)
    assert {n: e.value for n, e in found.stiffnesses.items()} == pytest.approx(TRUE, rel=1e-9)
    assert found.cells == K
    assert max(found.missed.values()) < 1e-11
    np.testing.assert_allclose(found.predicted, measured.stress, atol=1e-14)


def test_without_rotations_misses_the_asymmetric_part_and_only_that(measured):
    found = no_rotations(measured)
    assert set(found.stiffnesses) == {"E_0", "E_1", "G_0", "G_1"}
    assert found.missed["asymmetric"] == pytest.approx(1.0, rel=1e-12)
    assert found.missed["isotropic"] < 1e-11
    assert found.missed["deviatoric"] < 1e-11
    odd = (measured.stress - measured.stress.swapaxes(1, 2)) / 2
    np.testing.assert_allclose(found.residual, odd, atol=1e-14)


def test_a_wrong_orientation_shows_in_the_deviatoric_residual(measured):
    turned = dataclasses.replace(measured, fabric=measured.fabric + 0.1 * np.diag([1.0, -1.0]))
    assert no_rotations(turned, "fabric").missed["deviatoric"] > 0.5
    assert no_rotations(turned, "stress").missed["deviatoric"] < 1e-9


def test_errors_come_from_the_scatter(measured):
    """Noise on the stress of few cells: variances of many repetitions against the mean claimed ones."""
    few = Measured(**{k: v[:5] for k, v in dataclasses.asdict(measured).items()})
    rng = np.random.default_rng(1)
    found = [
        with_rotations(dataclasses.replace(few, stress=few.stress + 1e-3 * rng.normal(size=(5, 2, 2)))).stiffnesses
        for _ in range(1000)
    ]
    for name, true in TRUE.items():
        values, errors = (np.array([getattr(f[name], part) for f in found]) for part in ("value", "error"))
        assert values.mean() == pytest.approx(true, abs=5 * values.std() / np.sqrt(1000)), name
        assert (errors**2).mean() == pytest.approx(values.var(), rel=0.2), name


def test_noise_shows_as_what_is_missed(measured):
    noise = np.random.default_rng(1).normal(size=(K, 2, 2)) * 1e-3
    found = with_rotations(dataclasses.replace(measured, stress=measured.stress + noise))
    assert 0 < found.missed["isotropic"] < 0.1


def test_cells_without_a_field_are_left_out(measured):
    strain = measured.strain.copy()
    strain[3] = np.nan
    found = with_rotations(dataclasses.replace(measured, strain=strain))
    assert found.cells == K - 1
    assert np.isnan(found.residual[3]).all()
    assert found.stiffnesses["E_1"].value == pytest.approx(80.0, rel=1e-9)


def test_what_is_not_determined_is_said(measured):
    one_fabric = dataclasses.replace(measured, fabric=np.broadcast_to(np.eye(2), (K, 2, 2)))
    assert no_rotations(one_fabric) == Unavailable(reason="40 cells with all fields do not determine E_0 and E_1")
    two = Measured(**{k: v[:2] for k, v in dataclasses.asdict(measured).items()})
    assert no_rotations(two) == Unavailable(reason="2 cells with all fields do not determine E_0 and E_1")
    at_rest = dataclasses.replace(measured, rolling=np.zeros(K))
    assert with_rotations(at_rest) == Unavailable(reason="40 cells with all fields do not determine S and R")
    with pytest.raises(ValueError, match="expected sliding and rolling rotations"):
        with_rotations(dataclasses.replace(measured, sliding=None))
    with pytest.raises(ValueError, match="expected one of strain, fabric, stress, got 'velocity'"):
        no_rotations(measured, "velocity")
