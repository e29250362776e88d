"""Paired and independent differences: Gosset's and Welch's own numbers, exact cases, false-alarm rates."""

import numpy as np
import pytest

from harness.studies.statistics.difference import (
    Difference,
    half_width,
    independent_difference,
    p_value,
    paired_difference,
)

HYOSCYAMINE = (0.7, -1.6, -0.2, -1.2, -0.1, 3.4, 3.7, 0.8, 0.0, 2.0)
HYOSCINE = (1.9, 0.8, 1.1, 0.1, -0.1, 4.4, 5.5, 1.6, 4.6, 3.4)
"""Hours of sleep gained by ten patients with two drugs: the example of Gosset's paper of 1908."""


def test_gossets_example_paired():
    d = paired_difference(HYOSCYAMINE, HYOSCINE)
    assert (d.dof, d.count, d.paired) == (9, 10, True)
    assert d.value == pytest.approx(-1.58)
    assert d.value / d.error == pytest.approx(-4.0621, abs=5e-5)
    assert p_value(d) == pytest.approx(0.002833, abs=5e-7)


def test_gossets_example_as_two_samples():
    d = independent_difference(HYOSCYAMINE, HYOSCINE)
    assert d.value / d.error == pytest.approx(-1.8608, abs=5e-5)
    assert d.dof == pytest.approx(17.776, abs=5e-4)
    assert p_value(d) == pytest.approx(0.07939, abs=5e-6)


def test_what_packings_do_to_both_cancels_in_pairs_only():
    rng = np.random.default_rng(3)
    packing, a, b = 100 * rng.normal(size=20), rng.normal(size=20), rng.normal(size=20)
    assert paired_difference(packing + a, packing + b).error == pytest.approx(np.sqrt(2 / 20), rel=0.4)
    assert independent_difference(packing + a, packing + b).error > 20


def test_equal_replicates_do_not_differ_and_a_constant_offset_does():
    same = paired_difference([1.0, 2.0, 3.0], [1.0, 2.0, 3.0])
    offset = paired_difference([1.0, 2.0, 3.0], [2.0, 3.0, 4.0])
    assert (same.error, p_value(same)) == (0.0, 1.0)
    assert (offset.value, offset.error, p_value(offset), p_value(offset, 1.0)) == (-1.0, 0.0, 0.0, 1.0)
    assert independent_difference([1.0, 1.0], [1.0, 1.0, 1.0]).dof == 3


def test_a_negligible_difference_is_none():
    d = Difference(value=-1.0, error=0.25, dof=9.0, count=10, paired=True)
    assert p_value(d, 1.0) == p_value(d, 2.0) == 1.0
    assert p_value(d) < p_value(d, 0.5) < 1.0
    assert p_value(d, 0.5) == pytest.approx(p_value(Difference(value=0.5, error=0.25, dof=9.0, count=10, paired=True)))


def test_half_width_is_where_the_p_value_is_the_level():
    d = Difference(value=1.0, error=0.3, dof=7.0, count=8, paired=True)
    h = half_width(d, 0.01)
    assert p_value(Difference(value=h, error=0.3, dof=7.0, count=8, paired=True)) == pytest.approx(0.01)


def test_more_replicates_have_a_smaller_error():
    d = Difference(value=1.0, error=0.3, dof=7.0, count=8, paired=True)
    assert d.with_count(32).error == pytest.approx(0.15)
    assert d.with_count(32).dof == 31
    assert independent_difference(HYOSCINE, HYOSCYAMINE).with_count(40).dof == 78


@pytest.mark.parametrize("bad", [[1.0], [], [1.0, np.nan]])
@pytest.mark.parametrize("design", [paired_difference, independent_difference])
def test_too_few_or_missing_replicates_are_refused(bad, design):
    with pytest.raises(ValueError, match="finite replicates"):
        design(bad, [1.0, 2.0][: len(bad)] or [1.0, 2.0])


@pytest.mark.parametrize("count", [2, 3, 8])
@pytest.mark.parametrize(("design", "exact"), [(paired_difference, True), (independent_difference, False)])
def test_false_alarms_come_at_the_level(count, design, exact):
    """Of normal replicates: exactly at 5 % in pairs; Welch's approximation is on the safe side with very few."""
    rng, trials = np.random.default_rng(count), 3000
    a, b = rng.normal(size=(2, trials, count))
    rate = np.mean([p_value(design(x, 3.0 * y if not exact else y)) < 0.05 for x, y in zip(a, b, strict=True)])
    error = np.sqrt(0.05 * 0.95 / trials)
    assert abs(rate - 0.05) < 3.5 * error if exact else rate < 0.05 + 0.02
