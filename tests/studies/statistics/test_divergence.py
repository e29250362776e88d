"""Growth of differences: exact exponentials, random walks with a known drift, what has no rate."""

import numpy as np
import pytest

from harness.studies.statistics.divergence import (
    LOST,
    RISING,
    SATURATED,
    excess,
    largest_so_far,
    reached,
    reaching_error,
    rise_of,
)

TIME = np.linspace(0.0, 0.05, 501)


def test_an_exponential_has_its_rate_without_error():
    rise = rise_of(TIME, 1e-12 * np.exp(700 * TIME))
    assert rise.rate == pytest.approx(700, rel=1e-9)
    assert rise.error == pytest.approx(0, abs=1e-6)
    assert rise.start == pytest.approx(np.log(RISING / 1e-12) / 700, abs=1e-4)


def walk(rng, drift=1.0, scatter=1.5, steps=400):
    """ln D of a random walk that never falls: increments of a gamma distribution, as differences grow in bursts."""
    shape = (drift / scatter) ** 2
    return np.arange(steps + 1.0), 1e-12 * np.exp(np.cumsum([0, *rng.gamma(shape, drift / shape, steps)]))


def test_the_rate_of_a_random_walk_is_known_to_its_error():
    """Drift 0.05 +- 0.12 a step: standardised errors of the rate have mean 0 and rms 1."""
    rng = np.random.default_rng(11)
    rises = [rise_of(*walk(rng, drift=0.05, scatter=0.12, steps=1000)) for _ in range(300)]
    z = np.array([(r.rate - 0.05) / r.error for r in rises])
    assert abs(np.median(z)) < 0.25
    assert 0.75 < np.median(np.abs(z)) / 0.6745 < 1.35


def test_the_time_of_reaching_scatters_as_said():
    rng = np.random.default_rng(12)
    walks = [walk(rng, drift=0.05, scatter=0.12, steps=1000) for _ in range(300)]
    rises = [rise_of(*w) for w in walks]
    waited = [t[reached(d, SATURATED)] - r.start for (t, d), r in zip(walks, rises, strict=True)]
    said = np.median([reaching_error(r, t[reached(d, SATURATED)]) for (t, d), r in zip(walks, rises, strict=True)])
    assert np.std(waited) == pytest.approx(said, rel=0.3)


@pytest.mark.parametrize("so_far", [
    np.full(501, 1e-12), np.full(501, 1e-1), np.full(501, 1e-6), np.where(TIME > 0.02, 1.0, 1e-12), np.zeros(501),
])
def test_what_does_not_grow_on_the_way_has_no_rate(so_far):
    assert rise_of(TIME, so_far) is None


def test_largest_so_far_never_falls_and_ends_at_what_is_no_number():
    assert largest_so_far(np.array([0.0, -2.0, 1.0, 3.0])).tolist() == [0, 2, 2, 3]
    assert largest_so_far(np.array([1.0, np.nan, 1.0])).tolist() == [1, np.inf, np.inf]


def test_reached():
    assert reached(np.array([0.0, 1.0, 2.0]), 1.0) == 2
    assert reached(np.array([0.0, 1.0]), 1.0) is None


def test_excess_is_the_largest_ratio_while_both_are_small():
    response = np.array([1e-12, 1e-10, 1e-6, 1e-1, 1.0])
    difference = np.array([2e-12, 5e-9, 3e-6, 1.0, 1e3])
    found = excess(difference, response, 1e-2)
    assert (found.sample, found.ratio) == (1, pytest.approx(50))


def test_a_difference_that_is_large_at_once_is_seen():
    found = excess(np.array([0.0, 0.5, 0.5]), np.array([0.0, 1e-12, 1e-11]), 1e-2)
    assert found.ratio == pytest.approx(0.5 / 1e-12)
    assert excess(np.array([np.inf, np.inf]), np.array([1e-12, 1e-12]), 1e-2).ratio == np.inf


def test_a_response_lost_in_rounding_counts_as_that():
    assert excess(np.array([1e-12]), np.array([0.0]), 1e-2).ratio == pytest.approx(1e-12 / LOST)
    assert excess(np.zeros(3), np.zeros(3), 1e-2).ratio == 0.0
    assert excess(np.array([]), np.array([]), 1e-2) is None
