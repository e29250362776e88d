"""The shear band: when there is one, and how its width is judged."""

from pathlib import Path

import numpy as np
import pytest

from harness.studies.compare.band import band_checks, band_of
from harness.studies.compare.profiles import Profile, RingProfiles
from harness.studies.verdict import Rerun
from reference.values import published_values

RERUN = Rerun(scene_file=Path("ring.toml"), out=Path("out"), packings=None)
EDGES = np.linspace(0.02, 0.0545, 24)
R = (EDGES[1:] + EDGES[:-1]) / 2
D = 4e-3


@pytest.fixture
def band(ring):
    """band(v) of velocities over the inner ring's, given as a function of (r - R_i)/d."""

    def make(v, error=1e-3):
        wall = 0.5 * 0.02
        mean, cells = wall * v((R - 0.02) / D), len(R)
        profile = Profile(
            unit="m/s", mean=mean, error=np.full(cells, error * wall), samples=np.full(cells, 100.0),
            frames=np.full(cells, 100), short=np.zeros(cells, bool), needed=0.0,
        )
        profiles = RingProfiles(
            edges=EDGES, glued=np.zeros(cells), frames=100, spacing=0.1, profiles={"v_phi": profile},
        )
        return band_of(profiles, ring.scene, ring.system)

    return make


def judged(*bands):
    (check,) = band_checks(["a"], {"a": dict(enumerate(bands))}, RERUN)
    return check


@pytest.mark.parametrize(("width", "verdict"), [(1.05, "agrees"), (1.9, "agrees"), (0.8, "differs"), (2.1, "differs")])
def test_the_talks_range_decides(band, width, verdict):
    b = band(lambda x: 0.7 * np.exp(-x / width))
    assert b.width == pytest.approx(width, rel=1e-3)
    assert b.fit.v0.value == pytest.approx(0.7, rel=1e-3)
    assert judged(b).verdict == verdict


def test_a_width_that_is_not_known_decides_nothing(band):
    assert judged(band(lambda x: 0.7 * np.exp(-x / 1.5), error=0.3)).verdict in ("inconclusive", "not_checked")


def fast_then_slow(x):
    return 0.6 * np.exp(-x / 0.9) + 0.1 * np.exp(-x / 4.0)


def test_a_profile_that_is_no_exponential_is_judged_by_all_its_widths(band):
    """The whole fit lies in the talk's range; its halves do not, and the error bar of the fit does not know."""
    b = band(fast_then_slow)
    assert 1.0 < b.width < 2.0
    inner, outer = (half.s.value / D for half in b.halves)
    assert inner < b.width < 2.0 < outer
    check = judged(b)
    assert check.verdict == "inconclusive"
    assert f"chi^2/dof = {b.fit.chi2:.3g} ({b.freedom} degrees of freedom" in check.why
    assert f"outer {outer:.3g}" in check.why
    assert "measured" in check.why


@pytest.mark.parametrize(("scale", "verdict"), [(1.45, "agrees"), (2.6, "differs")])
def test_widths_that_all_say_the_same_decide(band, scale, verdict):
    """Wavy by 10 %: one exponential does not fit, and every part of it is in the range, or out of it."""
    b = band(lambda x: 0.7 * np.exp(-x / scale) * (1 + 0.1 * np.cos(6 * x)), error=2e-4)
    assert b.misfit
    assert judged(b).verdict == verdict


def test_a_fit_within_its_error_bars_has_no_misfit(band):
    rng = np.random.default_rng(3)
    b = band(lambda x: 0.7 * np.exp(-x / 1.5) + 1e-3 * rng.normal(size=len(x)))
    assert b.misfit == ""
    assert b.freedom == b.fit.points - 2


def test_scatter_about_the_exponential_counts_as_error(band):
    wavy = band(lambda x: 0.7 * np.exp(-x / 1.5) * (1 + 0.3 * np.cos(6 * x)))
    assert wavy.fit.chi2 > 10
    assert wavy.error == pytest.approx(wavy.fit.s.error * np.sqrt(wavy.fit.chi2))


@pytest.mark.parametrize(
    ("v", "why"), [
        (lambda x: 0.01 * np.exp(-x / 1.5), "slips"), (lambda x: 0.2 + 0.5 * np.exp(-x / 1.5), "as a body"),
        (lambda x: 0.7 + 0.01 * x, "does not decay"),
    ],
)
def test_without_a_band_nothing_is_judged(band, v, why):
    check = judged(band(v, error=1e-4))
    assert check.verdict == "not_checked"
    assert why in check.why


def test_nobody_who_ran_is_not_checked():
    (check,) = band_checks(["a"], {}, RERUN)
    assert check.verdict == "not_checked"


def test_several_packings_are_judged_by_their_mean(band):
    check = judged(*(band(lambda x, w=w: 0.7 * np.exp(-x / w)) for w in (0.9, 1.2, 1.5)))
    assert check.verdict == "agrees"
    assert "ours 1.2" in check.why


def test_recalled_values_never_decide():
    values = [v for v in published_values().values() if v.quantity.startswith("shear band")]
    assert [v.name for v in values if v.decides] == ["talk_shear_band_width"]
    assert len(values) == 7
