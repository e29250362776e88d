"""Errors of functions of means: linear ones are their own series, others follow the delta method."""

import numpy as np
import pytest

from postproc.propagation import linearised
from postproc.uncertainty import estimate


def test_a_linear_formula_is_its_series():
    x = np.random.default_rng(1).normal(size=(50, 3))
    assert linearised(lambda m: 2 * m["x"] - 1, {"x": x}) == pytest.approx(2 * x - 1, abs=1e-9)


def test_a_ratio_has_the_error_of_the_delta_method():
    rng = np.random.default_rng(2)
    a, b = 5 + rng.normal(size=(4000, 1)), 2 + 0.1 * rng.normal(size=(4000, 1))
    e = estimate(linearised(lambda m: m["a"] / m["b"], {"a": a, "b": b}))
    assert e.mean[0] == pytest.approx(a.mean() / b.mean(), rel=1e-12)
    assert e.error[0] == pytest.approx(np.sqrt((1 / 2) ** 2 + (5 / 4 * 0.1) ** 2) / np.sqrt(4000), rel=0.05)


def test_the_ratio_of_means_is_not_the_mean_of_ratios():
    a, b = np.ones((2, 1)), np.array([[1.0], [3.0]])
    assert linearised(lambda m: m["a"] / m["b"], {"a": a, "b": b}).mean() == pytest.approx(0.5)


def test_gaps_stay_gaps_and_constants_constant():
    x = np.array([[1.0, 0.1], [np.nan, 0.1], [3.0, 0.1]])
    y = linearised(lambda m: m["x"] ** 2, {"x": x})
    assert np.isnan(y[1, 0])
    assert np.ptp(y[:, 1]) == 0.0
    assert np.nanmean(y[:, 0]) == pytest.approx(4.0)
