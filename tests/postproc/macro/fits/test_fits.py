"""Fits give back what made the points, with errors that are those of many noisy repetitions, or say why not."""

import numpy as np
import pytest

from postproc.macro.fits.least_squares import fit_line, points
from postproc.macro.fits.power_law import fit_power_law
from postproc.macro.fits.saturation import fit_saturation
from postproc.macro.fits.shear_band import fit_shear_band
from postproc.macro.fits.yield_locus import mohr_coulomb
from postproc.results import Unavailable

R_I, D, WALL = 0.1032, 8e-3, 1.03e-2
RING = {"inner_radius": R_I, "wall_speed": WALL, "diameter": D}
V0, S = 0.75, 1.5 * D
r = R_I + (np.arange(30) + 0.5) * 2.5e-3
band = WALL * V0 * np.exp(-(r - R_I) / S)


def spread(fit, truth, size, seeds=300):
    """Fit noisy copies; return mean and deviation of the estimates, and the mean claimed error."""
    found = [fit(truth + size * np.random.default_rng(k).normal(size=len(truth))) for k in range(seeds)]
    values, errors = (np.array([getattr(f, part) for f in found]) for part in ("value", "error"))
    return values.mean(), values.std(), errors.mean()


@pytest.mark.parametrize("error", [None, np.full(30, 1e-6)])
@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_shear_band_is_exact_on_an_exponential(error, sign):
    fit = fit_shear_band(r, sign * band, error, **{**RING, "wall_speed": sign * WALL})
    assert (fit.v0.value, fit.s.value) == pytest.approx((V0, S), rel=1e-7)
    assert fit.method == ("logarithmic" if error is None else "weighted")
    assert (fit.low, fit.high) == pytest.approx((1.25e-3, 46.25e-3))
    assert fit.points == 19
    assert fit.chi2 == pytest.approx(0.0, abs=1e-12)


def test_shear_band_error_is_the_spread_of_noisy_profiles():
    noise = 0.02 * WALL
    for part, truth in (("s", S), ("v0", V0)):
        mean, deviation, claimed = spread(
            lambda v, part=part: getattr(fit_shear_band(r, v, np.full(30, noise), **RING), part), band, noise)
        assert mean == pytest.approx(truth, rel=0.02)
        assert claimed == pytest.approx(deviation, rel=0.12)
    relative = 0.1
    _, deviation, claimed = spread(lambda n: fit_shear_band(r, band * np.exp(n), **RING).s, np.zeros(30), relative)
    assert claimed == pytest.approx(deviation, rel=0.12)


def test_a_plateau_of_noise_spoils_the_logarithmic_fit_and_the_range_keeps_it_out():
    floor = band + 1e-3 * WALL
    assert fit_shear_band(r, floor, high=3.0, **RING).s.value == pytest.approx(S, rel=0.02)
    assert fit_shear_band(r, floor, high=9.0, **RING).s.value > 1.04 * S


@pytest.mark.parametrize(("v", "error", "options", "reason"), [
    (band, None, {"high": 0.7}, "2 usable points between 0 and 0.7 diameters from the wall, at least 3 are needed"),
    (np.full(30, np.nan), np.ones(30), {}, "0 usable points between 0 and 6 diameters"),
    (np.where(np.arange(30) == 3, -1.0, 1.0) * band, None, {}, "1 of 19 velocities between 0 and 6 diameters"),
    (np.exp(r) * WALL, None, {}, "the profile does not decay: slope of ln v 1 "),
    (np.exp(r) * WALL, np.full(30, 1e-3 * WALL), {}, "the profile does not decay"),
    (-band, np.full(30, 1e-3 * WALL), {}, "the grains at the wall move against it: v0 = -0.75 "),
    (0 * band, np.full(30, 1e-3 * WALL), {}, "the "),
    (band, np.full(30, 30 * WALL), {}, "the width is not determined between 0 and 6 diameters from the wall"),
])
def test_shear_band_says_why_it_cannot(v, error, options, reason):
    found = fit_shear_band(r, v, error, **options, **RING)
    assert isinstance(found, Unavailable)
    assert found.reason.startswith(reason)


def test_a_wall_at_rest_is_a_wrong_call():
    with pytest.raises(ValueError, match="wall_speed: expected a speed other than 0, got 0"):
        fit_shear_band(r, band, **{**RING, "wall_speed": 0.0})


@pytest.mark.parametrize("exponent", [0.0, -2.0, 0.7])
@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_power_law_is_exact(exponent, sign):
    fit = fit_power_law(r, sign * 3.0 * r**exponent, 0.01 * r**exponent)
    assert fit.exponent.value == pytest.approx(exponent, abs=1e-12)
    assert fit.amplitude.value * fit.scale**-exponent == pytest.approx(sign * 3.0, rel=1e-12)
    assert fit_power_law(r, r**exponent).exponent.error == pytest.approx(0.0, abs=1e-12)


def test_given_errors_count_also_where_the_points_lie_on_the_line():
    x = np.array([0.0, 1.0, 5.0])
    fit = fit_line(points(x, 2 * x, np.full(3, 0.3)))
    assert fit.parameter(0).error == pytest.approx(0.3 / np.sqrt(((x - x.mean()) ** 2).sum()), rel=1e-12)


def test_power_law_error_is_the_spread():
    y = r**-2.0
    mean, deviation, claimed = spread(
        lambda n: fit_power_law(r, y * (1 + n), 0.05 * y).exponent, np.zeros(30), 0.05)
    assert mean == pytest.approx(-2.0, abs=0.01)
    assert claimed == pytest.approx(deviation, rel=0.12)


def test_power_law_says_why_it_cannot():
    assert fit_power_law(r, r - r.mean()) == Unavailable(
        reason="no power law: of 30 values 15 are positive, 15 negative")
    assert fit_power_law(r, r, low=0.1045, high=0.108).reason.startswith("1 usable points")


eps = np.linspace(0.0, 0.03, 40)


@pytest.mark.parametrize(("initial", "plateau", "rate"), [(0.0, 0.34, 150.0), (0.05, 0.4, 60.0), (0.3, 0.1, 300.0)])
@pytest.mark.parametrize("error", [None, np.full(40, 0.01)])
def test_saturation_is_exact(initial, plateau, rate, error):
    y = plateau - (plateau - initial) * np.exp(-rate * eps)
    fit = fit_saturation(eps, y, error, initial=initial)
    assert (fit.plateau.value, fit.rate.value) == pytest.approx((plateau, rate), rel=1e-6)
    assert fit.reached == pytest.approx(1 - np.exp(-rate * 0.03), rel=1e-6)


def test_saturation_error_is_the_spread():
    y = 0.34 * (1 - np.exp(-150 * eps))
    for part in ("plateau", "rate"):
        _, deviation, claimed = spread(
            lambda v, part=part: getattr(fit_saturation(eps, v, np.full(40, 0.01)), part), y, 0.01)
        assert claimed == pytest.approx(deviation, rel=0.12)


def test_saturation_says_why_it_cannot():
    line = fit_saturation(eps, 3.0 * eps + 0.01 * np.random.default_rng(0).normal(size=40), np.full(40, 0.01))
    assert isinstance(line, Unavailable)
    assert line.reason.startswith(("the plateau is not determined up to a strain of 0.03", "the approach does not"))
    explosion = fit_saturation(eps, np.exp(200 * eps) - 1)
    assert isinstance(explosion, Unavailable)
    assert fit_saturation(eps[:2], eps[:2]) == Unavailable(
        reason="2 usable points with 0 <= strain <= inf, at least 3 are needed")


# the talk's table: p_x = 100 and 500; angle and cohesion as worked out by hand
TABLE = [(183, 798, 12.2, 11.8), (234, 853, 12.4, 31.9), (264, 915, 13.8, 39.7), (310, 941, 12.9, 60.6),
         (336, 972, 13.2, 70.2)]


@pytest.mark.parametrize(("low", "high", "angle", "cohesion"), TABLE)
def test_mohr_coulomb_of_the_talk(low, high, angle, cohesion):
    line = mohr_coulomb([100, 500], [low, high])
    assert line.angle.value == pytest.approx(angle, abs=0.06)
    assert line.cohesion.value == pytest.approx(cohesion, abs=0.06)
    assert np.isnan([line.angle.error, line.cohesion.error, line.ratio.error]).all()


def test_mohr_coulomb_error_is_the_spread():
    phi, c, p = np.radians(27.0), 40.0, np.array([20.0, 50.0, 100.0, 200.0, 500.0])
    K = (1 + np.sin(phi)) / (1 - np.sin(phi))
    s1 = K * p + 2 * c * np.sqrt(K)
    exact = mohr_coulomb(p, s1)
    assert (exact.angle.value, exact.cohesion.value) == pytest.approx((27.0, 40.0), rel=1e-10)
    for part in ("angle", "cohesion"):
        _, deviation, claimed = spread(
            lambda v, part=part: getattr(mohr_coulomb(p, v, np.full(5, 10.0)), part), s1, 10.0)
        assert claimed == pytest.approx(deviation, rel=0.12)


def test_mohr_coulomb_says_why_it_cannot():
    assert mohr_coulomb([100], [200]).reason == "1 usable points to fit, at least 3 are needed"
    assert mohr_coulomb([100, 100], [200, 210]).reason == "both points have one sigma_3"
    falling = mohr_coulomb([1, 2, 3], [4, 3, 2])
    assert falling.reason == "slope -1 of sigma_1 over sigma_3 is below 1: no Mohr-Coulomb line"


def test_points_without_an_error_of_their_own_are_left_out():
    data = points([0, 1, 2, 3], [1, 2, np.nan, 4], [0.1, np.nan, 0.1, 0.1])
    assert data.x.tolist() == [0.0, 3.0]
    with pytest.raises(ValueError, match="expected errors > 0, got 0"):
        points([0, 1], [1, 2], [0.1, 0.0])
    with pytest.raises(ValueError, match="of one length"):
        points([0, 1], [1, 2, 3])
    assert fit_line(points([1, 1, 1], [1, 2, 3])).reason == "all points to fit have one abscissa"
