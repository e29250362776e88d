"""Holm's procedure: by hand, its bounds, and the family-wise rate it promises."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from harness.studies.statistics.multiple import correct_together, holm


def test_by_hand():
    assert holm([0.01, 0.02, 0.03, 0.04, 0.05]) == pytest.approx([0.05, 0.08, 0.09, 0.09, 0.09])
    assert holm([0.5, 0.001]) == pytest.approx([0.5, 0.002])
    assert holm([0.9, 0.8]) == pytest.approx([1.0, 1.0])
    assert holm([]).size == 0


@pytest.mark.parametrize("bad", [[-0.1], [1.1], [np.nan]])
def test_what_is_no_probability_is_refused(bad):
    with pytest.raises(ValueError, match="between 0 and 1"):
        holm(bad)


@given(st.lists(st.floats(0, 1), min_size=1, max_size=30))
def test_between_the_p_values_and_bonferroni(p):
    adjusted, p = holm(p), np.array(p)
    assert (adjusted >= p).all()
    assert (adjusted <= np.minimum(1.0, len(p) * p)).all()
    assert (np.diff(adjusted[np.argsort(p, kind="stable")]) >= 0).all()


@pytest.mark.parametrize("common", [0.0, 0.7])
def test_one_false_alarm_in_a_family_is_as_rare_as_declared(common):
    """20 checks, independent or of common cause: exactly 1 - (1 - 0.05/20)^20 if independent, less if not."""
    from scipy.stats import norm

    rng, trials = np.random.default_rng(5), 4000
    z = np.sqrt(1 - common) * rng.normal(size=(trials, 20)) + np.sqrt(common) * rng.normal(size=(trials, 1))
    rate = np.mean([(holm(row) < 0.05).any() for row in 2 * norm.sf(np.abs(z))])
    exact, error = 1 - (1 - 0.05 / 20) ** 20, np.sqrt(0.05 * 0.95 / trials)
    assert abs(rate - exact) < 3.5 * error if common == 0 else rate < exact


KINDS = st.lists(st.lists(st.sampled_from([0.0, 1e-6, 1e-4, 1e-3, 0.004, 0.01, 0.02, 0.05, 0.3, 1.0]), max_size=8),
                 min_size=1, max_size=4)


@given(KINDS, st.sampled_from([0.01, 0.05, 0.3]))
def test_kinds_that_are_corrected_together_are_one_family_at_one_level(kinds, rate):
    """The level is that of Holm's procedure: a test is seen by its own p just where it is by its adjusted one."""
    every = holm([p for kind in kinds for p in kind])
    found = correct_together(rate, *kinds)
    assert np.concatenate([c.adjusted for c in found]).tolist() == every.tolist()
    for kind, c in zip(kinds, found, strict=True):
        assert c.among == len(every)
        assert [p <= c.level * (1 + 1e-12) for p in kind] == (c.adjusted <= rate * (1 + 1e-12)).tolist()


def test_who_sees_something_leaves_more_to_the_others():
    few, many = correct_together(0.05, [0.5, 0.6])[0], correct_together(0.05, [1e-9, 1e-9], [0.5, 0.6])[1]
    assert few.level == many.level == pytest.approx(0.025)
    (none,) = correct_together(0.05, [])
    assert (none.level, none.among) == (0.05, 0)
