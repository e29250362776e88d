"""Holm's procedure: by hand, its bounds, and the family-wise rate it promises."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from harness.studies.statistics.multiple import holm


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
