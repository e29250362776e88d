"""Equivalence and power: closed forms (one degree of freedom, many), Cohen's tables, simulation."""

import numpy as np
import pytest
from scipy.stats import norm

from harness.studies.statistics.difference import Difference, p_value, paired_difference
from harness.studies.statistics.power import (
    detection_power,
    equivalence_p,
    equivalence_power,
    replicates_to_equate,
    replicates_to_see,
    smallest_difference,
)


def difference(value=0.0, error=1.0, count=8, dof=None, paired=True):
    return Difference(value=value, error=error, dof=count - 1.0 if dof is None else dof, count=count, paired=paired)


def test_equivalence_of_two_replicates_in_closed_form():
    """With one degree of freedom t is Cauchy's distribution: P(t > x) = 1/2 - arctan(x)/pi."""
    p = equivalence_p(difference(value=-0.3, count=2), 2.0)
    assert p == pytest.approx(0.5 - np.arctan(1.7) / np.pi)


def test_equivalence_at_the_margin_is_a_coin_and_beyond_it_worse():
    assert equivalence_p(difference(value=2.0), 2.0) == 0.5
    assert equivalence_p(difference(value=3.0), 2.0) > 0.5
    assert [equivalence_p(difference(value=v, error=0.0), 2.0) for v in (1.9, -2.0, 2.1)] == [0.0, 1.0, 1.0]


def test_equivalence_is_claimed_at_the_level_where_the_difference_is_the_margin():
    rng, trials = np.random.default_rng(0), 4000
    claimed = [equivalence_p(paired_difference(x, 0 * x), 1.0) < 0.05 for x in rng.normal(1.0, 0.3, (trials, 8))]
    assert np.mean(claimed) == pytest.approx(0.05, abs=3.5 * np.sqrt(0.05 * 0.95 / trials))


@pytest.mark.parametrize(("effect", "each"), [(0.2, 393.4057), (0.5, 63.76561), (0.8, 25.52458)])
def test_cohens_small_medium_and_large_effects(effect, each):
    """The sizes of two samples that see them four times in five at a two-sided 5 %, from tables."""
    assert detection_power(effect, np.sqrt(2 / each), 2 * each - 2, 0.05) == pytest.approx(0.8, abs=1e-6)


def test_power_without_a_difference_is_the_level_and_far_away_one():
    assert detection_power(0.0, 1.0, 7, 0.01) == 0.01
    assert detection_power(1e-9, 1.0, 7, 0.01) == pytest.approx(0.01, rel=1e-6)
    assert detection_power(1e3, 1.0, 7, 0.01) == pytest.approx(1.0)
    assert detection_power(-2.0, 1.0, 7, 0.05) == detection_power(2.0, 1.0, 7, 0.05)


def test_power_of_many_replicates_is_the_normal_one():
    exact = norm.sf(norm.isf(0.005) - 3.0) + norm.cdf(-norm.isf(0.005) - 3.0)
    assert detection_power(3.0, 1.0, 1e7, 0.01) == pytest.approx(exact, abs=1e-5)


@pytest.mark.parametrize("level", [0.05, 0.001])
@pytest.mark.parametrize("count", [2, 4, 8, 64])
def test_the_smallest_difference_is_seen_four_times_in_five(count, level):
    d = difference(error=0.25, count=count)
    delta = smallest_difference(d, level)
    assert detection_power(delta, 0.25, d.dof, level) == pytest.approx(0.8, abs=1e-5)
    assert smallest_difference(difference(error=0.0), level) == 0.0


def test_the_smallest_difference_by_simulation():
    rng, trials, count = np.random.default_rng(1), 4000, 6
    delta = smallest_difference(difference(error=1 / np.sqrt(count), count=count), 0.01)
    seen = [p_value(paired_difference(x, 0 * x)) < 0.01 for x in rng.normal(delta, 1.0, (trials, count))]
    assert np.mean(seen) == pytest.approx(0.8, abs=3.5 * np.sqrt(0.16 / trials))


def test_power_of_equivalence_with_many_replicates_is_the_normal_one():
    assert equivalence_power(0.0, 3.0, 1.0, 1e7, 0.05) == pytest.approx(2 * norm.cdf(3 - norm.isf(0.05)) - 1, abs=1e-4)


@pytest.mark.parametrize(("delta", "count"), [(0.0, 8), (0.4, 8), (0.4, 3)])
def test_power_of_equivalence_by_simulation(delta, count):
    rng, trials, margin = np.random.default_rng(2), 4000, 1.3
    rows = rng.normal(delta, 1.0, (trials, count))
    shown = np.mean([equivalence_p(paired_difference(x, 0 * x), margin) < 0.05 for x in rows])
    power = equivalence_power(delta, margin, 1 / np.sqrt(count), count - 1, 0.05)
    assert shown == pytest.approx(power, abs=3.5 * np.sqrt(power * (1 - power) / trials) + 2e-3)


def test_more_replicates_settle_it():
    """The least number: one fewer does not do."""
    d = difference(value=0.3, error=0.3)
    see, equate = replicates_to_see(d, 0.01), replicates_to_equate(d, 0.6, 0.05)
    for n, power in ((see, lambda e: detection_power(0.3, e.error, e.dof, 0.01)),
                     (equate, lambda e: equivalence_power(0.3, 0.6, e.error, e.dof, 0.05))):
        assert power(d.with_count(n)) >= 0.8 > power(d.with_count(n - 1))


def test_what_no_number_settles():
    assert replicates_to_see(difference(value=0.0), 0.05) is None
    assert replicates_to_see(difference(value=1e-9), 0.05) is None
    assert replicates_to_equate(difference(value=2.0), 2.0, 0.05) is None
    assert replicates_to_equate(difference(value=0.1), 1e5, 0.05) == 2
