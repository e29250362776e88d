"""Ratios and fits, against numbers that are known."""

import numpy as np
import pytest

from harness.studies.bench.statistics import exponent, growth, ratio, spread

COUNTS = (100, 1000, 3000, 10_000, 100_000)


def test_a_ratio_is_taken_round_by_round():
    """A machine that becomes ten times slower half-way changes both times and no ratio."""
    slow = np.array([1.0, 1.0, 10.0, 10.0])
    assert ratio(2.0 * slow, slow) == (2.0, 2.0, 2.0)
    assert ratio(slow, np.empty(0)) is None
    assert spread(np.array([3.0, 1.0, 2.0])) == (2.0, 1.0, 3.0)


def test_an_exact_power_has_its_exponent_and_no_error():
    found = exponent(COUNTS, [5e-8 * n**1.25 for n in COUNTS])
    assert found.value == pytest.approx(1.25, abs=1e-12)
    assert found.error == pytest.approx(0.0, abs=1e-12)
    assert found.sizes == 4


def test_small_sizes_do_not_count():
    """A fixed cost that spoils the small sizes leaves the exponent alone."""
    assert exponent(COUNTS, [1e9, *COUNTS[1:]]).value == pytest.approx(1.0, abs=1e-12)


def test_the_error_is_that_of_the_slope():
    """Against the covariance of numpy's own fit."""
    rng = np.random.default_rng(3)
    counts = np.array([1000, 2000, 5000, 20_000, 50_000])
    seconds = counts**0.98 * np.exp(0.05 * rng.standard_normal(5))
    line, covariance = np.polyfit(np.log(counts), np.log(seconds), 1, cov=True)
    found = exponent(counts, seconds)
    assert found.value == pytest.approx(line[0], rel=1e-9)
    assert found.error == pytest.approx(np.sqrt(covariance[0, 0]), rel=1e-9)


def test_two_sizes_are_no_exponent():
    assert exponent(COUNTS[:3], [1.0, 2.0, 3.0]) is None


def test_growth_leaves_out_what_is_always_there():
    assert growth(COUNTS, [3e7 + 500.0 * n for n in COUNTS]) == pytest.approx(500.0)
    assert growth((100, 1000), (1.0, 2.0)) is None
    assert growth((1000, 1000), (1.0, 2.0)) is None
