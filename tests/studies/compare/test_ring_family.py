"""Numbers of rings between codes, and common offsets of profiles: planted ones are found, the unknown is not passed."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from harness.studies.compare.band import V_0, WIDTH, Band, band_in_time
from harness.studies.compare.pairs import Pair
from harness.studies.compare.profile_checks import profile_checks
from harness.studies.compare.profile_quantities import QUANTITIES
from harness.studies.compare.profile_tests import compared_profiles
from harness.studies.compare.profiles import RingProfiles, mean_over, number_of, profile_of
from harness.studies.compare.ring_balances import RingBalances
from harness.studies.compare.ring_family import number_tests
from harness.studies.compare.significance import Difference
from harness.studies.statistics.family import Terms, family_checks, judge_tests
from harness.studies.verdict import Rerun

PAIR = Pair(left="a", right="b", kind="codes")
RERUN = Rerun(scene_file=Path("ring.toml"), out=Path("out"), packings=None)
CELLS, FRAMES = 12, 600
EDGES = np.linspace(0.02, 0.044, CELLS + 1)
DEPTH = (EDGES[1:] + EDGES[:-1]) / 2 - 0.02
D = 4e-3


def profiles_of(**series):
    made = {name: profile_of(values, "1") for name, values in series.items()}
    return RingProfiles(
        edges=EDGES, glued=np.zeros(CELLS), frames=FRAMES, spacing=0.1, profiles=made,
        absent={q.name: "not asked for" for q in QUANTITIES if q.name not in made},
    )


def spin_of(seed, offset=0.0, noise=0.5):
    rng = np.random.default_rng(seed)
    return profiles_of(spin=1.0 + offset + noise * rng.normal(size=(FRAMES, CELLS)))


def balances_of(seed, torque=1.0, noise=0.3, slow=False):
    rng = np.random.default_rng(seed)
    scatter = np.cumsum(rng.normal(size=FRAMES)) / 20 if slow else rng.normal(size=FRAMES)
    of = number_of(torque * (1.0 + noise * scatter), "N m")
    return RingBalances(r=DEPTH + 0.02, inner=of, outer=of, total=of, drift=of, drag=None, mean_pressure=of)


def band(**facts):
    return Band(fit=None, why="", diameter=D, wall=1.0, reach=0.02, **facts)


def judged(a, b, balances, margin=0.25):
    profiles = {e: dict(enumerate(of)) for e, of in (("a", a), ("b", b))}
    everything = {e: dict(enumerate(of)) for e, of in zip("ab", balances, strict=True)}
    bands = {e: {k: band() for k in of} for e, of in profiles.items()}
    tested = compared_profiles([PAIR], profiles)
    several = len(a) > 1
    found = judge_tests(
        number_tests([PAIR], profiles, everything, bands, tested),
        Terms(false_alarms=0.05, margin=margin, paired=several),
    )
    return {c.quantity: c for c in family_checks(found, RERUN)}, profiles


EQUAL = ([balances_of(1)], [balances_of(2)])


def test_equal_codes_agree_within_the_margin():
    found, _ = judged([spin_of(3)], [spin_of(4)], EQUAL)
    assert {q: c.verdict for q, c in found.items()} == {
        "torque on the inner ring": "agrees", "torque on the outer ring": "agrees", "pressure": "agrees",
        "mean over cells of spin": "agrees",
    }
    assert "one run each, errors of time averages" in found["pressure"].why


def test_an_offset_of_all_cells_is_found_where_no_cell_differs():
    """5 % in twelve cells whose own errors are 3 % each: seen in their mean, in none of them."""
    a, b = spin_of(3), spin_of(4, offset=0.05)
    found, profiles = judged([a], [b], EQUAL, margin=0.05)
    checks = profile_checks([PAIR], profiles, RERUN, false_alarms=0.01)
    cells = next(c for c in checks if c.quantity == "profile: spin")
    assert cells.verdict != "differs"
    assert found["mean over cells of spin"].verdict == "differs"
    assert found["mean over cells of spin"].deviation == pytest.approx(0.05, rel=0.4)


def test_a_torque_that_is_another_differs_and_a_small_difference_of_conventions_agrees():
    off, _ = judged([spin_of(3)], [spin_of(4)], ([balances_of(1)], [balances_of(2, torque=1.5)]))
    assert off["torque on the inner ring"].verdict == "differs"
    assert off["torque on the inner ring"].why.endswith("--engines a,b --out out")
    small, _ = judged([spin_of(3)], [spin_of(4)], ([balances_of(1)], [balances_of(2, torque=1.1)]))
    assert small["torque on the inner ring"].verdict == "agrees"


def test_series_that_are_too_short_conclude_nothing():
    found, _ = judged([spin_of(3)], [spin_of(4)], ([balances_of(1, slow=True)], [balances_of(2, torque=3.0)]))
    check = found["pressure"]
    assert check.verdict == "inconclusive"
    assert "nothing is concluded" in check.why
    assert "s to average over would do, there are 60 s" in check.why


def test_over_packings_each_is_compared_with_itself():
    shifts = np.random.default_rng(5).normal(size=8)
    a = [spin_of(k, offset=s) for k, s in enumerate(shifts)]
    b = [spin_of(k + 50, offset=s) for k, s in enumerate(shifts)]
    balances = [[balances_of(k + of) for k in range(8)] for of in (0, 100)]
    found, _ = judged(a, b, balances)
    assert found["mean over cells of spin"].verdict == "agrees"
    assert "8 replicates, paired by packing" in found["pressure"].why


def test_the_error_of_a_mean_over_cells_is_that_of_its_series():
    """Cells that move as one: the mean is known no better than each of them."""
    rng = np.random.default_rng(2)
    together = profile_of(1.0 + rng.normal(size=(FRAMES, 1)) * np.ones(CELLS), "1")
    apart = profile_of(1.0 + rng.normal(size=(FRAMES, CELLS)), "1")
    every = np.ones(CELLS, bool)
    assert mean_over(together, every).error[0] == pytest.approx(1 / np.sqrt(FRAMES), rel=0.3)
    assert mean_over(apart, every).error[0] == pytest.approx(1 / np.sqrt(FRAMES * CELLS), rel=0.3)
    weights = np.arange(CELLS, dtype=float)
    assert mean_over(apart, every, weights).mean[0] == pytest.approx(np.average(apart.mean, weights=weights))


def test_gaps_do_not_move_the_mean_over_cells():
    series = 1.0 + np.random.default_rng(2).normal(size=(FRAMES, CELLS))
    series[::3, 4] = np.nan
    p = profile_of(series, "1")
    assert mean_over(p, np.ones(CELLS, bool)).mean[0] == pytest.approx(p.mean.mean(), rel=1e-12)


def test_a_band_in_time_scatters_as_its_fits_do():
    """Independent runs of an exponential with noise: the error of v_0 and s is the spread of their fits."""
    def one(seed):
        v = 0.7 * np.exp(-DEPTH / (1.5 * D)) * (1 + 0.5 * np.random.default_rng(seed).normal(size=(FRAMES, CELLS)))
        p = profiles_of(v_phi=v)
        from harness.studies.compare.band import _fit

        return p, replace(band(), fit=_fit(p, p.profiles["v_phi"].mean, band()))

    fits = [one(k)[1].fit for k in range(40)]
    found = band_in_time(*one(99))
    for name, values in ((V_0, [f.v0.value for f in fits]), (WIDTH, [f.s.value / D for f in fits])):
        assert found[name].error[0] == pytest.approx(np.std(values, ddof=1), rel=0.35)
        assert found[name].mean[0] == pytest.approx(np.mean(values), abs=4 * found[name].error[0])


def test_without_a_band_it_has_no_numbers():
    assert band_in_time(spin_of(1), band()) == {}


@pytest.mark.parametrize("freedom", [4.0, 11.0, 50.0])
@pytest.mark.parametrize("level", [1e-2, 1e-5])
def test_what_would_be_seen_is_seen_with_the_power_that_is_said(freedom, level):
    from harness.studies.statistics.power import detection_power

    one = np.ones(1)
    d = Difference(value=0 * one, error=one, freedom=freedom * one, short=one < 0, used=one > 0)
    assert detection_power(float(d.seen_from(level)[0]), 1.0, freedom, level) == pytest.approx(0.8, abs=0.01)
