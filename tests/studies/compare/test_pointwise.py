"""Windows and parting: exact deviations, edges of tolerance and strain, what is missing."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from harness.scene.judged import Window
from harness.studies.compare.curves import biaxial_curves
from harness.studies.compare.pairs import Pair
from harness.studies.compare.pointwise import force_deviation, parting_checks, peak_checks, window_checks
from harness.studies.verdict import Rerun

PAIR = Pair(left="a", right="b", kind="codes")
RERUN = Rerun(scene_file=Path("box.toml"), out=Path("out"), packings=None)


@pytest.fixture
def curves(box, mutate):
    """curves(f) are those of the box with the top force multiplied by f(strain)."""

    def make(factor=lambda eps: np.ones_like(eps)):
        true = box.trajectory()
        eps = box.strain(true.series["time"])
        return biaxial_curves(mutate.series(true, top_fy=lambda f: f * factor(eps)), box.system)

    return make


def window(a, b, *, strain=0.02, tolerance=1e-3, pairs=(PAIR,), kind="codes"):
    done = {name: {0: c} for name, c in (("a", a), ("b", b)) if c is not None}
    (check,) = window_checks(pairs, [Window(pairs=kind, strain=strain, tolerance=tolerance)], done, RERUN)
    return check


def parting(*both):
    done = {"a": dict(enumerate(a for a, _ in both)), "b": dict(enumerate(b for _, b in both))}
    (check,) = parting_checks([PAIR], done, RERUN)
    return check


def test_deviation_is_relative_to_the_larger_force(curves):
    true, weak = curves(), curves(lambda eps: np.where(eps > 0.05, 0.75, 1.0))
    deviation = force_deviation(true, weak)
    assert np.array_equal(deviation[true.strain <= 0.05], np.zeros((true.strain <= 0.05).sum()))
    assert deviation[true.strain > 0.05] == pytest.approx(0.25)
    assert np.array_equal(deviation, force_deviation(weak, true))


def test_forces_that_are_both_zero_do_not_differ(curves):
    nothing = curves(lambda eps: 0 * eps)
    assert not force_deviation(nothing, nothing).any()


@pytest.mark.parametrize("which", [0, 1, 2])
def test_a_force_that_is_no_number_never_passes(curves, which):
    bad = curves(lambda eps: np.where(np.arange(len(eps)) == 3, np.nan, 1.0))
    pair = [(bad, curves()), (curves(), bad), (bad, bad)][which]
    assert np.isnan(force_deviation(*pair)[3])
    assert window(*pair).verdict == "differs"
    assert parting(pair).verdict != "agrees"


def test_samples_of_different_steps_are_not_compared(curves, box):
    other = box.changed(("samples = 40", "samples = 20"))
    with pytest.raises(ValueError, match="different steps"):
        force_deviation(curves(), biaxial_curves(other.trajectory(), other.system))


def test_a_deviation_right_at_the_tolerance_agrees(curves):
    pair = curves(), curves(lambda eps: 1 - eps)
    worst = force_deviation(*pair)[pair[0].upto(0.02)].max()
    assert worst == pytest.approx(pair[0].strain[pair[0].strain <= 0.02].max())
    assert window(*pair, tolerance=worst).verdict == "agrees"
    beyond = window(*pair, tolerance=np.nextafter(worst, 0))
    assert beyond.verdict == "differs"
    assert beyond.deviation == worst
    assert beyond.why.endswith("rerun: grainproof compare box.toml --engines a,b --out out")


def test_what_happens_after_the_window_does_not_count(curves):
    late = curves(lambda eps: np.where(eps > 0.02, 2.0, 1.0))
    assert window(curves(), late).verdict == "agrees"
    assert window(curves(), late, strain=0.03).verdict == "differs"


@pytest.mark.parametrize(("a", "b", "why"), [
    (False, True, "no completed run of a"), (True, False, "no completed run of b"),
    (False, False, "no completed run of a and b"),
])
def test_a_missing_run_is_not_checked(curves, a, b, why):
    check = window(curves() if a else None, curves() if b else None)
    assert (check.verdict, check.why, check.deviation) == ("not_checked", why, None)


def test_a_window_without_a_sample_is_not_checked(curves):
    check = window(curves(), curves(), strain=1e-5)
    assert (check.verdict, check.why) == ("not_checked", "no sample lies in this range")


def test_a_window_that_fits_no_pair_is_said(curves):
    check = window(curves(), curves(), kind="same_conventions")
    assert check.verdict == "not_checked"
    assert "declared for same_conventions" in check.why


def test_the_worst_packing_counts(curves):
    wrong = curves(lambda eps: np.full_like(eps, 0.9))
    done = {"a": {0: curves(), 1: curves(), 2: curves()}, "b": {0: curves(), 1: wrong}}
    (check,) = window_checks([PAIR], [Window(pairs="codes", strain=0.02, tolerance=1e-3)], done, RERUN)
    assert check.verdict == "differs"
    assert check.deviation == pytest.approx(0.1)
    assert "of 2 packings" in check.why


def test_parting_at_a_known_strain(curves):
    """Apart by 2 % from sample 25 on: they followed each other up to the strain of sample 24."""
    true = curves()
    apart = curves(lambda eps: np.where(np.arange(len(eps)) >= 25, 1.02, 1.0))
    check = parting((true, apart))
    assert (check.verdict, check.tolerance) == ("inconclusive", 0.01)
    assert f"up to {100 * true.strain[24]:.3g} % strain" in check.why
    assert check.deviation == pytest.approx(1 - 1 / 1.02)


def test_runs_that_follow_each_other_to_the_end_agree(curves):
    check = parting((curves(), curves(lambda eps: 1 + 0.05 * eps)))
    assert (check.verdict, check.why) == ("agrees", "at all times")
    assert check.deviation == pytest.approx(0.005 / 1.005)


def test_no_chaos_excuses_runs_that_differ_at_step_zero(curves):
    both = curves(), curves(lambda eps: np.full_like(eps, 2.0))
    check = parting(both)
    assert check.verdict == "differs"
    assert "apart at the first sample" in check.why
    (check,) = parting_checks(
        [replace(PAIR, kind="same_conventions")], {"a": {0: both[0]}, "b": {0: both[1]}}, RERUN
    )
    assert check.verdict == "differs"
    assert "apart at step 0 already" in check.why


def test_set_ups_of_different_conventions_may_differ_at_step_zero(curves):
    """LAMMPS and LIGGGHTS judge contacts that rub at the start each in its own way; in the next step they agree."""
    both = curves(), curves(lambda eps: np.where(np.arange(len(eps)) == 0, 2.0, 1.0))
    assert parting(both).verdict == "agrees"
    done = {"a": {0: both[0]}, "b": {0: both[1]}}
    (check,) = parting_checks([replace(PAIR, kind="same_conventions")], done, RERUN)
    assert check.verdict == "differs"


def test_parting_tells_the_packing_that_parted_first(curves):
    late, early = (curves(lambda eps, n=n: np.where(np.arange(len(eps)) >= n, 1.5, 1.0)) for n in (30, 10))
    check = parting((curves(), late), (curves(), early))
    assert f"up to {100 * late.strain[9]:.3g} % strain" in check.why


def test_parting_needs_both_runs(curves):
    assert parting_checks([PAIR], {"a": {0: curves()}}, RERUN) == []


# --- peaks ---------------------------------------------------------------------------------------


def hump(strain, *, height=0.4, at=0.03):
    """A factor that makes sigma_zz fall by more than it has risen after strain `at`."""
    return lambda eps: np.where(eps <= strain, 1.0, 1.0 - height * np.minimum((eps - strain) / at, 1.0))


def peaks(*both):
    done = {"a": dict(enumerate(a for a, _ in both)), "b": dict(enumerate(b for _, b in both))}
    return peak_checks([PAIR], done, RERUN)


def test_one_peak_agrees(curves):
    a = curves(hump(0.0312))
    (check,) = peaks((a, a))
    assert (check.verdict, check.deviation, check.level) == ("agrees", 0.0, "L2")
    assert check.why == f"at {a.peak.where} and at {a.peak.where}"


def test_without_a_peak_there_is_no_check(curves):
    assert peaks((curves(), curves())) == []


@pytest.mark.parametrize("other", [hump(0.06), lambda eps: np.ones_like(eps)])
def test_two_peaks_of_runs_that_followed_each_other_differ(curves, other):
    """They part only after the first of the two peaks, and the lower one is no top of the other."""
    (check,) = peaks((curves(hump(0.0312)), curves(other)))
    assert (check.verdict, check.deviation) == ("differs", None)
    assert check.why.endswith("rerun: grainproof compare box.toml --engines a,b --out out")


def test_peaks_after_chaos_are_inconclusive(curves):
    """Apart by 2 % from sample 5 on."""
    def apart(eps):
        return np.where(np.arange(len(eps)) >= 5, 1.02, 1.0)

    a, b = curves(hump(0.0312)), curves(lambda eps: apart(eps) * hump(0.06)(eps))
    (check,) = peaks((a, b))
    assert check.verdict == "inconclusive"
    assert f"later than {100 * a.strain[4]:.3g} %, where the runs had parted" in check.why


def test_a_peak_of_another_height_differs_and_no_chaos_excuses_it_from_step_zero_on(curves):
    (check,) = peaks((curves(hump(0.0312)), curves(lambda eps: 0.95 * hump(0.0312)(eps))))
    assert (check.verdict, check.deviation) == ("differs", pytest.approx(0.05))


def test_the_worst_packing_counts_for_peaks(curves):
    one, other = curves(hump(0.0312)), curves(hump(0.06))
    (check,) = peaks((one, one), (one, other))
    assert check.verdict == "differs"
    assert "of 2 packings" in check.why
