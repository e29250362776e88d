"""Invariants, principal values and directions; strength."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from postproc.macro.strength import friction_angle, stress_ratio
from postproc.macro.tensors import principal


def test_mohr_circle_in_2d():
    """Centre 3, radius 2, major direction at 30 degrees from x."""
    angle = np.radians(30.0)
    n = np.array([np.cos(angle), np.sin(angle)])
    parts = principal((np.eye(2) + 4.0 * np.outer(n, n))[None])
    assert parts.isotropic == pytest.approx([3.0])
    assert parts.deviator == pytest.approx([2.0])
    np.testing.assert_allclose(parts.values, [[5.0, 1.0]], rtol=1e-14)
    np.testing.assert_allclose(parts.major, [n], rtol=1e-14)


def test_triaxial_state_in_3d():
    """sqrt(J_2) = (s_1 - s_3)/sqrt(3) when two principal values are equal."""
    parts = principal(np.diag([1.0, 4.0, 1.0])[None])
    assert parts.isotropic == pytest.approx([2.0])
    assert parts.deviator == pytest.approx([np.sqrt(3.0)])
    np.testing.assert_array_equal(parts.values, [[4.0, 1.0, 1.0]])
    np.testing.assert_array_equal(parts.major, [[0.0, 1.0, 0.0]])


def test_an_isotropic_tensor_has_no_direction_and_nan_stays_nan():
    parts = principal(np.stack([np.eye(2), np.full((2, 2), np.nan), np.diag([1.0, 2.0])]))
    assert np.isnan(parts.major[:2]).all()
    assert parts.major[2].tolist() == [0.0, 1.0]
    assert parts.deviator[0] == 0.0
    assert np.isnan(parts.values[1]).all()


@settings(max_examples=50, deadline=None)
@given(seed=st.integers(0, 2**32 - 1), dim=st.sampled_from((2, 3)))
def test_parts_belong_to_the_symmetric_part(seed, dim):
    tensor = np.random.default_rng(seed).normal(size=(5, dim, dim))
    symmetric = (tensor + tensor.swapaxes(1, 2)) / 2
    parts = principal(tensor)
    assert (np.diff(parts.values, axis=1) <= 0).all()
    image = np.einsum("kab,kb->ka", symmetric, parts.major)
    np.testing.assert_allclose(image, parts.values[:, :1] * parts.major, atol=1e-12)
    np.testing.assert_allclose(np.linalg.norm(parts.major, axis=1), 1.0, rtol=1e-14)
    np.testing.assert_allclose(parts.values.sum(axis=1), dim * parts.isotropic, atol=1e-12)
    squares = dim * parts.isotropic**2 + 2 * parts.deviator**2
    np.testing.assert_allclose((parts.values**2).sum(axis=1), squares, rtol=1e-12)
    assert (parts.major[:, -1] > 0).all()


@pytest.mark.parametrize("degrees", [0.0, 13.0, 27.0, 30.0])
def test_friction_angle_is_that_of_mohr_coulomb(degrees):
    """s_1/s_3 = (1 + sin phi)/(1 - sin phi); 3 at 30 degrees."""
    sine = np.sin(np.radians(degrees))
    values = np.array([[1 + sine, 1 - sine]]) * 50.0
    assert friction_angle(values) == pytest.approx([degrees], abs=1e-12)
    assert stress_ratio(values) == pytest.approx([(1 + sine) / (1 - sine)])


def test_tension_has_no_secant_friction_angle():
    values = np.array([[3.0, -1.0], [-1.0, -3.0], [0.0, 0.0], [2.0, 0.0]])
    np.testing.assert_array_equal(friction_angle(values), [np.nan, np.nan, np.nan, 90.0])
    assert np.isnan(stress_ratio(values)).all()
