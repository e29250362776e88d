"""Slopes of errors that are known."""

import numpy as np
import pytest

from harness.studies.accuracy.fit import fit_order, step_for, why_no_fit

DT = [0.04, 0.02, 0.01, 0.005]


def scattered(order, spread, seed=0):
    rng = np.random.default_rng(seed)
    return np.array([3.0 * dt**order * np.exp(spread * rng.standard_normal(40)) for dt in DT])


@pytest.mark.parametrize("order", [1.0, 2.0])
def test_an_exact_power_is_found_without_error(order):
    fit = fit_order(DT, scattered(order, 0.0), oracle=0.0)
    assert fit.slope == pytest.approx(order, abs=1e-12)
    assert fit.error < 1e-12
    assert fit.at == pytest.approx(3.0 * fit.reference**order)


def test_the_standard_error_covers_the_truth():
    """Of 60 drawn ladders two thirds lie within one standard error, nearly all within two and a half."""
    off = []
    for seed in range(60):
        fit = fit_order(DT, scattered(1.0, 0.6, seed), oracle=0.0)
        off.append(abs(fit.slope - 1.0) / fit.error)
    assert 0.5 < np.mean(np.array(off) < 1.0) < 1.0
    assert np.mean(np.array(off) < 2.5) > 0.9


def test_what_the_oracle_cannot_tell_is_not_fitted():
    errors = scattered(2.0, 0.0)
    assert fit_order(DT, errors, oracle=0.21 * errors[2, 0]) is None
    assert fit_order(DT, errors, oracle=0.19 * errors[2, 0]).rungs == 3
    assert fit_order(DT[:2], errors[:2], oracle=0.0) is None


def test_it_is_told_why_nothing_is_fitted_just_where_nothing_is():
    errors = scattered(2.0, 0.0)
    size = list(np.sqrt((errors**2).mean(axis=1)))
    for rungs, oracle in ((4, 0.0), (4, 0.19 * size[2]), (4, 0.21 * size[2]), (3, 0.0), (2, 0.0), (0, 0.0)):
        fit = fit_order(DT[:rungs], errors[:rungs], oracle=oracle) if rungs else None
        assert (why_no_fit(size[:rungs], 6, oracle=oracle) == "") == (fit is not None)
    assert "2 of 6 rungs have an answer" in why_no_fit(size[:2], 6, oracle=0.0)
    assert "2 of 4 rungs" in why_no_fit(size, 6, oracle=0.21 * size[2])
    assert "lie above 5 times the error of the oracle" in why_no_fit(size, 6, oracle=0.21 * size[2])


def test_the_step_for_an_error_is_read_off_the_line():
    sizes = [3.0 * dt**2 for dt in DT]
    assert step_for(DT, sizes, 3.0 * 0.013**2) == pytest.approx(0.013)
    assert step_for(DT, sizes, 1e-9) is None
    assert step_for(DT, sizes, 1.0) is None


def test_an_error_that_rises_again_counts():
    """Below the target at 0.02 by luck, above it at 0.01: only 0.005 is safe."""
    dt = step_for(DT, [5.0, 0.5, 2.0, 0.5], 1.0)
    assert 0.005 < dt < 0.01
