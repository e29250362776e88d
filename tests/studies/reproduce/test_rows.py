"""Rows and their verdicts: only a value that was seen decides, and only where the error bar allows it."""

import numpy as np
import pytest

from harness.studies.reproduce.protocol import Measured
from harness.studies.reproduce.rows import (
    Spread,
    Within,
    compared,
    half_width,
    held_against,
    larger_than,
    over_packings,
)
from reference.values import collect

TALK = """
[angle]
quantity = "angle"
value = 13.0
unit = "deg"
kind = "published"
origin = "talk"
seen = true
conditions = "mu = 0"
"""


@pytest.fixture
def talk():
    return collect([TALK])["angle"]


def test_mean_and_error_over_packings():
    m = over_packings("a", [1.0, 3.0, float("nan")])
    assert (m.value, m.packings, m.values) == (2.0, 2, (1.0, 3.0))
    assert m.error == pytest.approx(1.0)  # s = sqrt(2), over sqrt(2)
    assert over_packings("a", [1.0]).error is None
    assert np.isnan(over_packings("a", []).value)


def test_half_width_is_students():
    """t(0.975, 2) = 4.3027 (tables)."""
    assert half_width(over_packings("a", [1.0, 2.0, 3.0])) == pytest.approx(4.3027 / 3**0.5, rel=1e-4)
    assert half_width(Measured(engine="a", value=1.0, error=0.5, packings=1)) == pytest.approx(0.98)
    assert half_width(over_packings("a", [1.0])) is None


@pytest.mark.parametrize(("values", "goal", "verdict"), [
    ([12.9, 13.0, 13.1], Within(tolerance=2.0), "agrees"),
    ([16.9, 17.0, 17.1], Within(tolerance=2.0), "differs"),
    ([14.0, 15.0, 16.0], Within(tolerance=2.0), "inconclusive"),     # the error bar reaches across
    ([10.0, 13.0, 16.0], Within(tolerance=2.0), "inconclusive"),     # right on average, and not known
    ([13.0], Within(tolerance=2.0), "inconclusive"),
    ([13.5, 13.6, 13.7], Within(tolerance=0.15, relative=True), "agrees"),
    ([12.0, 13.5, 14.0], Spread(), "agrees"),
    ([14.0, 14.1, 14.2], Spread(), "differs"),
    ([14.0, 14.1], Spread(), "inconclusive"),
    ([], Spread(), "not_checked"),
])
def test_verdicts(talk, values, goal, verdict):
    assert held_against(talk, over_packings("a", values), goal).verdict == verdict


def test_a_recalled_value_decides_nothing():
    recalled = collect([TALK.replace("seen = true", "seen = false")])["angle"]
    row = held_against(recalled, over_packings("a", [13.0, 13.0, 13.0]), Within(tolerance=2.0))
    assert row.verdict == "inconclusive"
    assert "recalled" in row.why


def test_a_small_size_states_and_decides_nothing(talk):
    row = held_against(talk, over_packings("a", [20.0, 20.1, 20.2]), Within(tolerance=2.0), quick=True)
    assert row.verdict == "inconclusive"
    assert row.deviation == pytest.approx(7.1)


def test_values_are_found_by_name():
    row = compared("talk_geometrical_angle", over_packings("a", [13.0, 13.1, 13.2]), Within(tolerance=2.0))
    assert (row.verdict, row.talk.value, row.unit) == ("agrees", 13.0, "deg")


@pytest.mark.parametrize(("values", "verdict"), [
    ([1.9, 2.0, 2.1], "agrees"), ([0.1, 0.2, 0.3], "differs"), ([0.5, 1.0, 1.6], "inconclusive"),
    ([2.0], "inconclusive"), ([], "not_checked"),
])
def test_words_without_a_number(values, verdict):
    assert larger_than(1.0, over_packings("a", values), quantity="q", against="talk").verdict == verdict
