"""Localisation of uniform, banded and empty deformation."""

import numpy as np
import pytest

from postproc.macro.localisation import localisation
from postproc.results import Unavailable

X = np.stack(np.meshgrid((np.arange(40) + 0.5) / 40, (np.arange(40) + 0.5) / 40), axis=-1).reshape(-1, 2)
V = np.full(1600, 1 / 1600)


def test_uniform():
    found = localisation(np.full(1600, -0.3), V, X)
    assert (found.participation, found.half) == pytest.approx((1.0, 0.5), rel=1e-12)
    np.testing.assert_allclose(found.centre, 0.5)


def test_a_band_takes_its_part_of_the_volume():
    """One eighth of the box along x at 0.3 < y < 0.425."""
    inside = (X[:, 1] > 0.3) & (X[:, 1] < 0.425)
    found = localisation(inside.astype(float), V, X)
    assert (found.participation, found.half) == pytest.approx((0.125, 0.0625), rel=1e-12)
    np.testing.assert_allclose(found.centre, [0.5, 0.3625], rtol=1e-12)
    np.testing.assert_allclose(found.direction, [1.0, 0.0], atol=1e-12)
    np.testing.assert_allclose(found.spread**2, (np.array([1600, 25]) - 1) / 1600 / 12, rtol=1e-12)


def test_an_inclined_band_points_along_itself():
    angle = np.radians(55.0)
    along, across = (X - 0.5) @ [np.cos(angle), np.sin(angle)], (X - 0.5) @ [-np.sin(angle), np.cos(angle)]
    found = localisation(np.exp(-(across / 0.05) ** 2) * (np.abs(along) < 0.4), V, X)
    assert np.degrees(np.arctan2(*found.direction[::-1])) == pytest.approx(55.0, abs=0.5)


def test_cells_of_unequal_volume_and_unknown_rate():
    rate, volumes = np.array([2.0, 1.0, np.nan]), np.array([1.0, 4.0, 9.0])
    found = localisation(rate, volumes, np.array([[0.0], [1.0], [2.0]]))
    assert found.participation == pytest.approx(36.0 / (5.0 * 8.0))
    assert found.half == pytest.approx((1.0 + 1.0) / 5.0)  # all of the first, a quarter of the second
    assert found.centre == pytest.approx([4.0 / 6.0])


def test_nothing_deforms():
    assert localisation(np.zeros(3), np.ones(3), np.zeros((3, 2))) == Unavailable(reason="nothing deforms in 3 cells")
