"""Limits and orders of ladders that are known, with and without noise."""

import numpy as np
import pytest

from harness.studies.accuracy import limit as module
from harness.studies.accuracy.limit import Order, find_limit, find_order, order_or_why, power_weights, standard_error

X = np.array([8.0, 4.0, 2.0, 1.0])
TRUE = 10.0


def ladder(order, *, noise=0.0, packings=8, spread=0.5, slope=0.02, seed=0, x=X):
    """Values (R, K, 1): packings scatter by `spread`, all rungs of one alike; rungs by `noise` besides."""
    rng = np.random.default_rng(seed)
    base = spread * rng.standard_normal((1, packings, 1))
    return TRUE + base + slope * x[:, None, None] ** order + noise * rng.standard_normal((len(x), packings, 1))


@pytest.mark.parametrize("order", [0.5, 1.0, 2.0, 3.0])
def test_an_exact_power_is_extrapolated_exactly(order):
    values = ladder(order)
    limit = find_limit(X, values, order)
    assert limit.state == "extrapolated"
    assert np.allclose(limit.each, values[3] - 0.02, rtol=0, atol=1e-9)
    assert limit.systematic[0] == 0.0
    assert limit.error[0] == pytest.approx(values[3].std(ddof=1) / np.sqrt(8))
    seen = find_order(X, values)
    assert (seen.value, seen.rungs) == (pytest.approx(order, rel=1e-4), 4)
    assert seen.error < 1e-4


def test_rungs_may_stand_in_any_order():
    values, mixed = ladder(1.0, noise=0.01), [2, 0, 3, 1]
    a, b = find_limit(X, values, 1.0), find_limit(X[mixed], values[mixed], 1.0)
    assert b.value[0] == pytest.approx(a.value[0], rel=1e-12)
    assert np.allclose(a.weights[mixed], b.weights)


def test_the_order_that_is_seen_is_used_where_the_expected_one_does_not_fit():
    limit = find_limit(X, ladder(2.0, noise=1e-4), 1.0)
    assert limit.state == "extrapolated"
    assert limit.order == pytest.approx(2.0, abs=0.05)
    assert "not 1" in limit.says
    assert limit.systematic[0] > 0.01, "how far the expected order would be off is told"


def test_noise_is_not_extrapolated():
    values = ladder(1.0, slope=0.0, noise=0.1)
    limit = find_limit(X, values, 1.0)
    assert limit.state == "flat"
    assert "floor dominates" in limit.says
    assert limit.value[0] == pytest.approx(values[1:].mean())
    difference = (values[1] - values[3])[:, 0]
    assert limit.systematic[0] == pytest.approx(difference.std(ddof=1) / np.sqrt(8))
    assert find_order(X, values) is None
    assert "no more than noise" in order_or_why(X, values[[0, 1, 2, 0]])
    assert "follow no power" in order_or_why(X, values)
    assert "2 rungs with values" in order_or_why(X[:2], values[:2])
    assert isinstance(order_or_why(X, ladder(2.0, noise=1e-4)), Order)


def test_a_ladder_that_bends_back_is_outside_the_asymptotic_range():
    values = np.tile(np.array([10.0, 12.0, 10.5, 11.5])[:, None, None], (1, 8, 1))
    values += 1e-3 * np.random.default_rng(1).standard_normal(values.shape)
    limit = find_limit(X, values, 1.0)
    assert limit.state == "outside"
    assert "not in the asymptotic range" in limit.says
    assert limit.weights.tolist() == [0.0, 0.0, -1.0, 2.0]
    assert limit.systematic[0] == pytest.approx(1.0, abs=0.01), "the whole correction"


def test_two_rungs_cannot_check_themselves():
    limit = find_limit(X[2:], ladder(1.0)[2:], 1.0)
    assert limit.state == "outside"
    assert "only two rungs" in limit.says
    assert limit.value[0] == pytest.approx(limit.each.mean())
    assert limit.systematic[0] == pytest.approx(0.02)


def test_error_bars_cover_the_truth():
    """Of 200 noisy ladders two thirds lie within one bar of the truth, nearly all within two and a half."""
    off = []
    for seed in range(200):
        limit = find_limit(X, ladder(1.0, noise=0.02, spread=0.05, seed=seed), 1.0)
        off.append(abs(limit.value[0] - TRUE) / limit.bar[0])
    assert 0.5 < np.mean(np.array(off) < 1.0) < 0.95
    assert np.mean(np.array(off) < 2.5) > 0.9


def test_false_alarms_are_as_rare_as_declared():
    states = [find_limit(X, ladder(1.0, slope=0.0, noise=0.1, seed=s), 1.0).state for s in range(300)]
    assert 0.01 < np.mean(np.array(states) != "flat") < 0.12


def test_what_packings_share_cancels():
    """A spread of five does not blur a difference of 0.02 between rungs of the same packings."""
    values = ladder(1.0, spread=5.0, noise=1e-3)
    assert find_limit(X, values, 1.0).state == "extrapolated"
    shuffled = np.stack([np.random.default_rng(k).permutation(v) for k, v in enumerate(values)])
    assert find_limit(X, shuffled, 1.0).state == "flat"


def test_packings_without_a_value_are_left_out_on_all_rungs():
    values = ladder(1.0, noise=1e-3)
    values[2, 5] = np.nan
    limit = find_limit(X, values, 1.0)
    assert limit.packings.tolist() == [0, 1, 2, 3, 4, 6, 7]
    values[:3, 1:] = np.nan
    assert find_limit(X, values, 1.0) is None


def test_a_rung_without_values_is_passed_over():
    values = ladder(1.0)
    values[3] = np.nan
    limit = find_limit(X, values, 1.0)
    assert limit.weights[3] == 0.0
    assert limit.value[0] == pytest.approx(values[2].mean() - 0.04)


def test_curves_are_extrapolated_place_by_place():
    place = np.linspace(0.0, 1.0, 5)
    values = ladder(1.0) * (1.0 + place)
    limit = find_limit(X, values, 1.0)
    assert limit.state == "extrapolated"
    assert np.allclose(limit.value, (values[3].mean(axis=0) - 0.02 * (1.0 + place)), atol=1e-9)


@pytest.mark.parametrize("along", [1, 40])
def test_noise_of_many_places_is_not_taken_for_a_difference(along):
    """Whether places are of their own or all alike."""
    drawn = (np.random.default_rng(s).standard_normal((4, 8, along)) * np.ones(40) for s in range(200))
    states = [find_limit(X, values, 1.0).state for values in drawn]
    assert np.mean(np.array(states) == "flat") > 0.9


def test_weights_are_those_of_richardson():
    for order in (0.5, 1.0, 2.0):
        ratio = 2.0**order
        assert np.allclose(power_weights(np.array([1.0, 2.0]), order), [ratio / (ratio - 1), -1 / (ratio - 1)])
    assert power_weights(X, 1.3).sum() == pytest.approx(1.0)
    assert power_weights(X, 1.3) @ X**1.3 == pytest.approx(0.0, abs=1e-12)


def scattered_apart(each):
    """As if rungs had packings of their own: the scatter of one packing in place of that of the mean."""
    return each.std(axis=0, ddof=1)


MUTANTS = {
    "the order is not used": ("power_weights", lambda x, _: power_weights(x, 1.0)),
    "noise is a trend": ("_differs", lambda *_: True),
    "nothing is a trend": ("_differs", lambda *_: False),
    "the scatter of one packing": ("standard_error", scattered_apart),
    "error bars too small": ("standard_error", lambda each: 0.3 * standard_error(each)),
    "no jackknife": ("_jackknife", lambda *_: 10.0),
    "coarsest rungs": ("_finest", lambda x, v: (np.argsort(-x)[:3][::-1], np.arange(v.shape[1]))),
}
CHECKS = (
    lambda: test_an_exact_power_is_extrapolated_exactly(2.0), test_noise_is_not_extrapolated,
    test_the_order_that_is_seen_is_used_where_the_expected_one_does_not_fit,
    test_packings_without_a_value_are_left_out_on_all_rungs, test_what_packings_share_cancels,
    test_error_bars_cover_the_truth,
)


@pytest.mark.parametrize("mutant", MUTANTS)
def test_wrong_extrapolations_are_caught(mutant, monkeypatch):
    name, wrong = MUTANTS[mutant]
    monkeypatch.setattr(module, name, wrong)
    assert any(_notices(check) for check in CHECKS)


def _notices(check):
    try:
        check()
    except Exception:  # noqa: BLE001 (whatever breaks has noticed)
        return True
    return False


def test_an_order_that_hangs_on_one_packing_is_none():
    """Seven packings fall, the eighth falls much more and bends: without it no power fits."""
    values = np.tile(np.array([10.4, 10.4, 10.4, 10.0])[:, None, None], (1, 8, 1))
    values += 1e-6 * np.random.default_rng(2).standard_normal(values.shape)
    values[:, 7, 0] = 10.0 + 0.4 * X
    assert find_order(X, values) is None
    assert isinstance(order_or_why(X, values), str)
