"""Published values: the prediction interval, what may decide, and what may not."""

import math

import numpy as np
import pytest
from scipy import stats

from harness.studies.compare.published import prediction_half_width, published_check, published_checks
from reference.values import Published

NINE = [9.0, 10.0, 11.0]
"""Mean 10, s = 1: the next of its kind lies within t(0.975, 2) sqrt(4/3) = 4.9683 of 10."""
HALF = 4.968275423


def value(number: float, **changes) -> Published:
    facts = {
        "name": "v", "quantity": "plateau sigma_zz", "value": number, "unit": "N/m", "kind": "published",
        "origin": "a talk", "seen": True, "conditions": "none",
    }
    return Published(**(facts | changes))


def check(number: float, ours=NINE, **changes):
    return published_check(value(number, **changes), "lammps", ours, "grainproof again")


def test_half_width_on_known_numbers():
    assert prediction_half_width(np.array(NINE)) == pytest.approx(HALF, abs=1e-6)
    assert 4.302652729749462 * math.sqrt(4 / 3) == pytest.approx(HALF, abs=1e-6)


@pytest.mark.parametrize("n", [2, 3, 5, 30])
def test_half_width_is_that_of_scipy(n):
    ours = np.random.default_rng(n).normal(180.0, 7.0, n)
    scale = ours.std(ddof=1) * math.sqrt(1 + 1 / n)
    low, high = stats.t.interval(0.95, n - 1, loc=ours.mean(), scale=scale)
    assert 2 * prediction_half_width(ours) == pytest.approx(high - low, rel=1e-12)


def test_the_interval_holds_the_next_value_95_times_in_100():
    rng = np.random.default_rng(7)
    ours, following = rng.normal(183.0, 5.0, (4000, 3)), rng.normal(183.0, 5.0, 4000)
    inside = [abs(o.mean() - f) <= prediction_half_width(o) for o, f in zip(ours, following, strict=True)]
    assert np.mean(inside) == pytest.approx(0.95, abs=0.012)


@pytest.mark.parametrize(("number", "verdict"), [
    (10.0, "agrees"), (10 + HALF - 1e-5, "agrees"), (10 - HALF + 1e-5, "agrees"),
    (10 + HALF + 1e-5, "differs"), (10 - HALF - 1e-5, "differs"),
])
def test_three_packings_give_a_verdict(number, verdict):
    made = check(number)
    assert (made.verdict, made.level, made.left, made.right) == (verdict, "L3", "lammps", "a talk")
    assert made.deviation == pytest.approx(abs(10 - number) / number)
    assert made.tolerance == pytest.approx(HALF / number, rel=1e-6)
    assert made.why.startswith("ours 10 N/m, standard deviation 1 over 3 packings")
    assert made.why.endswith("rerun: grainproof again") is (verdict == "differs")


@pytest.mark.parametrize("count", [1, 2])
def test_fewer_packings_decide_nothing(count):
    made = check(1e6, NINE[:count])
    assert (made.verdict, made.tolerance) == ("inconclusive", None)
    assert made.why.endswith("--packings 3")


@pytest.mark.parametrize("number", [10.0, 1e6])
def test_a_recalled_value_never_decides(number):
    made = check(number, seen=False)
    assert made.verdict == "inconclusive"
    assert "recalled" in made.why


def test_a_known_difference_is_one_only_outside():
    assert check(10.0, known_difference="other walls").verdict == "agrees"
    made = check(50.0, known_difference="other walls")
    assert (made.verdict, made.why.split("; ")[-1]) == ("known_difference", "other walls")


def test_nothing_and_nan_are_not_checked():
    assert (check(10.0, []).verdict, check(10.0, []).why) == ("not_checked", "no completed run of lammps")
    made = check(10.0, [9.0, math.nan, 11.0])
    assert (made.verdict, made.why) == ("not_checked", "not a number in 1 of 3 packings")


def test_equal_packings_leave_no_room():
    assert check(10.0, [10.0] * 3).verdict == "agrees"
    assert check(10.0 + 1e-9, [10.0] * 3).verdict == "differs"


def test_a_negative_value_has_a_positive_tolerance():
    assert check(-10.0, [-9.0, -10.0, -11.0]).tolerance == pytest.approx(HALF / 10, rel=1e-6)


def test_every_engine_is_checked_or_said_to_be_missing(box):
    scene = box.changed(("[0.05, 0.1]", '[0.05, 0.1]\npublished = ["talk_frictionless_100"]')).scene
    macro = {("a", k): {"plateau sigma_zz": v} for k, v in enumerate([180.0, 183.0, 186.0])}
    checks = published_checks(scene, ["a", "b"], macro, lambda *engines: "again")
    assert [(c.left, c.verdict) for c in checks] == [("a", "agrees"), ("b", "not_checked")]
