"""Profiles beside each other: what is planted is found, what cannot be known is not passed."""

import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from harness.studies.compare.pairs import Pair
from harness.studies.compare.profile_checks import profile_checks
from harness.studies.compare.profiles import RingProfiles, profile_of
from harness.studies.verdict import Rerun

PAIR = Pair(left="a", right="b", kind="codes")
RERUN = Rerun(scene_file=Path("ring.toml"), out=Path("out"), packings=None)
CELLS = 10


def run(seed, *, frames=400, planted=0.0, noise=0.1, slow=False, absent=(), hidden=0.0):
    """Spin of 1 rad/s in ten cells and v_phi of 2 m/s; `planted` is added to the spin in cell 3, `hidden` in 5."""
    rng = np.random.default_rng(seed)
    scatter = noise * rng.normal(size=(2, frames, CELLS))
    if slow:
        scatter = np.cumsum(scatter, axis=1) / 10
    values = {"spin": 1.0 + scatter[0] + planted * (np.arange(CELLS) == 3)
              + hidden * (np.arange(CELLS) == 5), "v_phi": 2.0 + scatter[1]}
    made = {n: profile_of(v, "1") for n, v in values.items() if n not in absent}
    from harness.studies.compare.profile_quantities import QUANTITIES

    why = {q.name: "not asked for" for q in QUANTITIES if q.name not in made}
    return RingProfiles(
        edges=np.linspace(0.02, 0.04, CELLS + 1), glued=np.zeros(CELLS), frames=frames, spacing=0.1, profiles=made,
        absent=why,
    )


def judged(*both, group="spin", **settings):
    done = {"a": dict(enumerate(a for a, _ in both)), "b": dict(enumerate(b for _, b in both))}
    return next(c for c in profile_checks([PAIR], done, RERUN, **settings) if c.quantity == f"profile: {group}")


def test_equal_codes_agree_and_it_is_said_what_would_have_been_seen():
    check = judged((run(1), run(2)))
    assert check.verdict == "agrees"
    assert check.deviation <= check.chance <= check.tolerance == 0.25
    assert "in 75% of the cells would be seen" in check.why


def test_agreement_needs_a_difference_of_the_margin_to_be_seen():
    """Error bars that hide 25 % hide it, whatever else agrees; with a margin of their size they do not."""
    noisy = (run(1, noise=1.0), run(2, noise=1.0))
    check = judged(noisy)
    assert check.verdict == "inconclusive"
    assert "blind to the margin of 25 %" in check.why
    seen = float(re.search(r"would be seen (\d+) % of spin", check.why).group(1)) / 100
    assert 0.25 < seen < 0.6
    assert judged(noisy, margin=1.05 * seen).verdict == "agrees"
    assert judged(noisy, margin=0.95 * seen).verdict == "inconclusive"


def test_what_it_would_take_is_about_enough():
    check = judged((run(1, noise=1.0), run(2, noise=1.0)))
    seconds = float(re.search(r"takes about (\d+) s to average over", check.why).group(1))
    packings = int(re.search(r"about (\d+) packings of this length", check.why).group(1))
    assert 40 < seconds < 400
    frames = int(1.3 * seconds / 0.1)
    assert judged((run(1, noise=1.0, frames=frames), run(2, noise=1.0, frames=frames))).verdict == "agrees"
    many = [(run(k, noise=1.0), run(k + 500, noise=1.0)) for k in range(int(1.3 * packings))]
    assert judged(*many).verdict == "agrees"


def test_one_cell_further_apart_than_the_margin_is_not_passed_over():
    """A cell whose error bars hide what it shows does not agree because the others do."""
    wild = 1.0 + 24.0 * (np.arange(CELLS) == 5)
    check = judged((run(1, noise=0.1 * wild), run(2, noise=0.1 * wild, hidden=0.45)), false_alarms=0.01)
    assert check.verdict == "inconclusive"
    assert "larger than the margin of 25 %, where it is not seen: spin 11 mm" in check.why


def test_a_planted_difference_is_found_in_its_cell_only():
    check = judged((run(1), run(2, planted=0.08)))
    assert check.verdict == "differs"
    assert "in 1 of 10 cells: spin 7 mm" in check.why
    assert "rerun: grainproof compare ring.toml --engines a,b" in check.why
    assert judged((run(1), run(2, planted=0.08)), group="velocity").verdict == "agrees"


def test_too_few_samples_are_inconclusive_and_say_how_many_more():
    check = judged((run(1, slow=True, frames=60), run(2, slow=True, frames=60, planted=0.3)))
    assert check.verdict == "inconclusive"
    assert "too few autocorrelation times in spin" in check.why
    assert "s to average over would do, there are 6 s" in check.why


def test_error_bars_as_large_as_the_profile_show_nothing():
    check = judged((run(1, noise=20.0), run(2, noise=20.0)))
    assert check.verdict == "inconclusive"
    assert "blind to the margin" in check.why


def test_what_nobody_has_is_not_checked_with_the_reason():
    check = judged((run(1), run(2)), group="torque stiffness")
    assert (check.verdict, check.why) == ("not_checked", "not asked for")


def test_a_missing_run_is_not_checked():
    (check,) = profile_checks([PAIR], {"a": {0: run(1)}}, RERUN)
    assert check.verdict == "not_checked"
    assert "no completed run of b" in check.why


def test_two_packings_have_no_spread_to_judge_by_and_many_have():
    two = [(run(k), run(k + 50)) for k in range(2)]
    assert judged(*two).verdict == "inconclusive"
    assert "their spread needs 3" in judged(*two).why
    many = [(run(k), run(k + 50)) for k in range(12)]
    assert judged(*many).verdict == "agrees"
    planted = [(run(k), run(k + 50, planted=0.2)) for k in range(12)]
    assert judged(*planted).verdict == "differs"


def test_what_a_packing_does_to_both_codes_is_no_difference():
    """Packings scatter by ten times what the codes do; each is compared with itself."""
    rng = np.random.default_rng(5)

    def shifted(of, by):
        spin = of.profiles["spin"]
        return replace(of, profiles={**of.profiles, "spin": replace(spin, mean=spin.mean + by)})

    shifts = rng.normal(size=12)
    planted = [(shifted(run(k), s), shifted(run(k + 50, planted=0.2), s)) for k, s in enumerate(shifts)]
    assert judged(*planted).verdict == "differs"


def test_one_run_that_shows_a_slow_change_lends_its_errors_to_the_others():
    """Of three codes one wanders in cell 3: that the others stay apart there is no finding."""
    apart, wandering = run(2, planted=0.08), run(3)
    series = np.linspace(-1.0, 1.0, 400)[:, None] * (np.arange(CELLS) == 3) + 1.0
    noise = 0.1 * np.random.default_rng(9).normal(size=(400, CELLS))
    slow = profile_of(series + noise, "1")
    wandering = replace(wandering, profiles={**wandering.profiles, "spin": slow})
    done = {"a": {0: run(1)}, "b": {0: apart}, "c": {0: wandering}}
    check = next(c for c in profile_checks([PAIR], done, RERUN) if c.quantity == "profile: spin")
    assert check.verdict != "differs"


def test_false_alarms_are_rare():
    """Of 200 comparisons of equal codes at most a few say that something differs: 1 % is declared."""
    alarms = sum(judged((run(2 * k, frames=150), run(2 * k + 1, frames=150))).verdict == "differs" for k in range(200))
    assert alarms <= 6


@pytest.mark.parametrize("which", ["mean", "error"])
def test_no_number_is_no_agreement(which):
    bad = run(1)
    spin = bad.profiles["spin"]
    broken = replace(spin, **{which: np.full(CELLS, np.nan)})
    check = judged((replace(bad, profiles={**bad.profiles, "spin": broken}), run(2)))
    assert check.verdict == "not_checked"
