"""Verdicts of a whole family: by hand, their rates by simulation, their words."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from harness.studies.compare.pairs import Pair
from harness.studies.statistics.family import ROUND_OFF, Measured, Terms, family_checks, judge_family, judge_tests
from harness.studies.statistics.multiple import correct_together
from harness.studies.verdict import Rerun

TERMS = Terms(false_alarms=0.05, margin=0.05, paired=True)
SAME = Pair(left="a", right="b", kind="same_conventions")
CODES = Pair(left="a", right="b", kind="codes")
RERUN = Rerun(scene_file=Path("box.toml"), out=Path("out"), packings=None)


def measured(a, b, **more):
    return Measured(quantity="q", unit="N/m", values={"a": dict(enumerate(a)), "b": dict(enumerate(b))}, **more)


def one(a, b, *, pair=SAME, terms=TERMS, **more):
    (judged,) = judge_family([measured(a, b, **more)], [pair], terms)
    return judged


@pytest.fixture
def packings():
    """Eight packings of spread 30 about 200, and scatter of size 1 that sums to zero."""
    rng = np.random.default_rng(8)
    noise = rng.normal(size=8)
    return 200 + 30 * rng.normal(size=8), (noise - noise.mean()) / noise.std(ddof=1)


def test_pairs_agree_where_the_spread_over_packings_hides_nothing(packings):
    base, noise = packings
    judged = one(base, base + 2 * noise)
    assert judged.verdict == "agrees"
    assert judged.error == pytest.approx(2 / np.sqrt(8) / base.mean(), rel=1e-3)
    assert one(base, base + 2 * noise, terms=Terms(false_alarms=0.05, margin=0.05, paired=False)).verdict != "agrees"


def test_a_difference_many_errors_large_differs(packings):
    base, noise = packings
    judged = one(base, base + 20 + 2 * noise)
    assert judged.verdict == "differs"
    assert judged.relative == pytest.approx(-20 / (base.mean() + 10))
    assert abs(judged.relative) > judged.chance


def test_a_small_difference_that_is_seen_differs_between_same_conventions_only(packings):
    """1 % +- 0.1 % where 5 % are allowed between conventions."""
    base, noise = packings
    assert one(base, base + 2 + 0.5 * noise).verdict == "differs"
    assert one(base, base + 2 + 0.5 * noise, pair=CODES).verdict == "agrees"
    assert one(base, base + 20 + 0.5 * noise, pair=CODES).verdict == "differs"


def test_round_off_is_no_difference_of_codes_that_compute_the_same(packings):
    base, noise = packings
    assert one(base, base * (1 + 0.5 * ROUND_OFF)).verdict == "agrees"
    assert one(base, base * (1 + 20 * ROUND_OFF) + 1e-6 * noise).verdict == "differs"


def test_no_evidence_is_inconclusive_and_says_what_would_do(packings):
    base, noise = packings
    judged = one(base, base + 40 * noise)
    assert judged.verdict == "inconclusive"
    assert judged.resolvable > judged.chance > abs(judged.relative)
    count = judged.settle.count
    assert 8 < judged.settle.low < count < judged.settle.high < 3000
    spread = np.random.default_rng(1).normal(size=count)
    spread = (spread - spread.mean()) / spread.std(ddof=1)
    more = np.tile(base, count)[:count]
    assert one(more, more + 40 * spread).verdict == "agrees"


def test_equal_to_the_last_bit_agrees(packings):
    judged = one(packings[0], packings[0])
    assert (judged.verdict, judged.error, judged.adjusted, judged.equivalence) == ("agrees", 0.0, 1.0, 0.0)


def test_many_checks_need_a_larger_difference(packings):
    """p = 0.01 alone is seen, among twenty it is not."""
    base, noise = packings
    shift = 3.4995 / np.sqrt(8)  # t of seven degrees of freedom at 0.01
    off, same = measured(base, base + shift + noise), measured(base, base + noise)
    assert judge_family([off], [SAME], TERMS)[0].tested.p == pytest.approx(0.01, abs=2e-4)
    assert judge_family([off], [SAME], TERMS)[0].verdict == "differs"
    among = judge_family([off, *[same] * 19], [SAME], TERMS)
    assert among[0].adjusted == pytest.approx(0.2, abs=4e-3)
    assert among[0].verdict == "agrees"
    assert among[0].resolvable > judge_family([off], [SAME], TERMS)[0].resolvable


def test_replicates_that_only_one_side_has_are_left_out_of_pairs(packings):
    base, noise = packings
    m = Measured(quantity="q", unit="1", values={
        "a": dict(enumerate(base)), "b": {**dict(enumerate(base + noise)), 3: float("nan"), 9: 1e9},
    })
    (judged,) = judge_family([m], [SAME], TERMS)
    assert judged.tested.difference.count == 7


@pytest.mark.parametrize(("a", "b"), [([1.0], [1.0]), ([], []), ([1.0, np.nan], [1.0, 2.0]), ([0.0, 0.0], [0.0, 0.0])])
def test_nothing_to_test_is_no_verdict(a, b):
    assert judge_family([measured(a, b)], [SAME], TERMS) == []


def test_a_scale_of_its_own(packings):
    """A volume strain near zero is measured by the axial strain, not by itself."""
    noise = 1e-4 * packings[1]
    judged = one(noise, -noise, scale=0.01)
    assert judged.error == pytest.approx(2e-4 / np.sqrt(8) / 0.01, rel=1e-6)
    assert judged.verdict == "agrees"


def test_errors_of_single_runs_are_told_by_their_rms():
    m = measured([1.0], [1.0], errors={"a": {0: 3.0, 1: 4.0, 2: np.nan}})
    assert m.run_error("a") == pytest.approx(np.sqrt(12.5))
    assert m.run_error("b") is None


def test_words(packings):
    base, noise = packings
    judged = judge_family([measured(base, base + 20 + 2 * noise), measured(base, base + 40 * noise)], [SAME], TERMS)
    differs, open_ = family_checks(judged, RERUN)
    assert (differs.level, differs.verdict, open_.verdict) == ("L3", "differs", "inconclusive")
    assert differs.deviation > differs.chance
    assert "8 replicates, paired by packing" in differs.why
    assert differs.why.endswith("rerun: grainproof compare box.toml --engines a,b --out out")
    assert "would settle it at half the level" in open_.why
    assert (differs.tolerance, open_.tolerance) == (0.05, 0.05)
    assert "no evidence of none" in open_.why
    assert open_.deviation < open_.chance


def test_the_interval_of_a_number_of_replicates_is_that_of_the_scatter(packings):
    """Eight replicates know their scatter to -29 % and +80 % (90 %): errors go with it, replicates with its square."""
    base, noise = packings
    needed = one(base, base + 40 * noise).settle
    assert needed.low / needed.count == pytest.approx(7 / 14.067, rel=0.05)
    assert needed.high / needed.count == pytest.approx(7 / 2.167, rel=0.05)


def test_errors_that_are_not_to_be_trusted_conclude_nothing(packings):
    base, noise = packings
    for shift in (0.0, 40.0):
        (sound,) = judge_family([measured(base, base + shift + noise)], [SAME], TERMS)
        (judged,) = judge_tests([replace(sound.tested, doubt="too short")], TERMS)
        assert (sound.verdict == "inconclusive", judged.verdict) == (False, "inconclusive")
        (check,) = family_checks([judged], RERUN)
        assert "too short" in check.why
        assert judged.settle is None or "would settle" not in check.why


def test_what_is_not_to_be_trusted_takes_nothing_from_the_others(packings):
    """A p-value from an error that is too small sees nothing, and leaves the others no more than they had."""
    base, noise = packings
    (far,) = judge_family([measured(base, base + 40.0 + noise)], [SAME], TERMS)
    (near,) = judge_family([measured(base, base + noise)], [SAME], TERMS)
    doubtful, sound = judge_tests([replace(far.tested, doubt="too short"), near.tested], TERMS)
    assert far.adjusted < 1e-6
    assert doubtful.adjusted == doubtful.equivalence == 1.0
    assert sound.level == pytest.approx(TERMS.false_alarms / 2)


def test_tests_of_other_kinds_share_the_rate(packings):
    base, noise = packings
    (alone,) = judge_family([measured(base, base + noise)], [SAME], TERMS)
    shared, _ = correct_together(TERMS.false_alarms, [alone.tested.counted], [1.0] * 9)
    (among,) = judge_tests([alone.tested], TERMS, shared)
    assert among.level == pytest.approx(alone.level / 10)
    assert among.adjusted == pytest.approx(min(1.0, 10 * alone.adjusted))
    assert (alone.among, among.among) == (1, 10)
    assert among.equivalence == alone.equivalence
    assert among.chance > alone.chance


def test_agreement_too_is_as_sure_for_all_checks_as_declared():
    """Twenty quantities whose true difference is the margin: any agreement is false, and rare."""
    rng, trials = np.random.default_rng(6), 400
    rows = rng.normal(size=(trials, 20, 2, 6))
    rows[:, :, 0] += 5.0
    families = (judge_family([measured(a, b, scale=100.0) for a, b in of], [CODES], TERMS) for of in rows)
    false = [any(j.verdict == "agrees" for j in family) for family in families]
    exact = 1 - (1 - 0.05 / 20) ** 20
    assert abs(np.mean(false) - exact) < 3.5 * np.sqrt(0.05 * 0.95 / trials)


@pytest.mark.parametrize("paired", [True, False])
def test_a_family_of_equal_codes_raises_as_few_alarms_as_declared(paired):
    """Twenty quantities of two equal codes, six replicates: one alarm or more in 1 - (1 - 0.05/20)^20 of reports."""
    rng, trials = np.random.default_rng(4), 300
    terms, rows = Terms(false_alarms=0.05, margin=0.05, paired=paired), 100 + rng.normal(size=(trials, 20, 2, 6))
    families = (judge_family([measured(a, b) for a, b in of], [SAME], terms) for of in rows)
    alarms = [any(j.verdict == "differs" for j in family) for family in families]
    exact, error = 1 - (1 - 0.05 / 20) ** 20, np.sqrt(0.05 * 0.95 / trials)
    assert abs(np.mean(alarms) - exact) < 3.5 * error
