"""Error bars of correlated series: AR(1) processes, whose autocorrelation time is known."""

import numpy as np
import pytest

from postproc.uncertainty import CONSTANT, FEW, FINE, REASONS, SHORT, estimate, integrated_time


def ar1(phi, frames, count, seed=0):
    """x_t = phi x_(t-1) + noise, stationary: variance 1/(1 - phi^2), tau = (1 + phi)/(1 - phi)/2."""
    rng = np.random.default_rng(seed)
    noise = rng.normal(size=(frames, count))
    x = np.empty_like(noise)
    x[0] = noise[0] / np.sqrt(1 - phi**2)
    for t in range(1, frames):
        x[t] = phi * x[t - 1] + noise[t]
    return x


def time_of(phi):
    return 0.5 * (1 + phi) / (1 - phi)


@pytest.mark.parametrize("phi", [0.0, 0.5, 0.8, 0.95])
def test_autocorrelation_time_and_error(phi):
    """Over 100 series of 8000 frames: tau and error within 3 % of the truth."""
    frames, count = 8000, 100
    found = estimate(ar1(phi, frames, count))
    tau = time_of(phi)
    assert found.tau.mean() == pytest.approx(tau, rel=0.03)
    np.testing.assert_allclose(found.samples * 2 * found.tau, frames)
    error = np.sqrt(2 * tau / (1 - phi**2) / frames)
    assert np.sqrt((found.error**2).mean()) == pytest.approx(error, rel=0.03)
    assert (found.doubt == FINE).all()


@pytest.mark.parametrize(("phi", "frames"), [(0.0, 60), (0.0, 400), (0.5, 400), (0.9, 3000)])
def test_errors_cover_the_truth(phi, frames):
    """The true mean 0 lies within one error for 68 % of the series, within two for 95 % (binomial scatter 2.5 %)."""
    found = estimate(ar1(phi, frames, 1000, seed=1))
    pull = np.abs(found.mean / found.error)
    assert (pull < 1).mean() == pytest.approx(0.683, abs=0.06)
    assert (pull < 2).mean() == pytest.approx(0.954, abs=0.03)


def test_series_that_swing_have_an_upper_bound():
    found = estimate(ar1(-0.5, 5000, 50))
    assert (found.tau == 0.5).all()
    assert (found.error > np.sqrt(2 * time_of(-0.5) / 0.75 / 5000)).all()


def test_a_series_too_short_for_its_memory_says_so():
    found = estimate(ar1(0.95, 200, 50))
    assert (found.doubt == SHORT).mean() > 0.9
    assert "lower bound" in REASONS[SHORT]


def test_constant_and_missing_series_have_reasons():
    rng = np.random.default_rng(0)
    series = np.full((100, 4), np.nan)
    series[:, 0], series[3, 1], series[:, 3] = 7.0, 1.0, rng.normal(size=100)
    found = estimate(series)
    assert found.doubt.tolist() == [CONSTANT, FEW, FEW, FINE]
    assert found.frames.tolist() == [100, 1, 0, 100]
    np.testing.assert_array_equal(found.mean[:3], [7.0, 1.0, np.nan])
    np.testing.assert_array_equal(found.error[:3], [0.0, np.nan, np.nan])
    assert np.isnan(found.tau[:3]).all()
    assert all(REASONS[word] for word in (CONSTANT, SHORT, FEW))
    assert estimate(np.empty((0, 2))).doubt.tolist() == [FEW, FEW]
    assert estimate([3.0]).doubt == FEW


def test_gaps_thin_a_series_out_and_leave_its_time():
    x = ar1(0.8, 20_000, 20)
    gaps = x.copy()
    gaps[np.random.default_rng(1).random(x.shape) < 0.3] = np.nan
    found = estimate(gaps)
    assert found.tau.mean() == pytest.approx(time_of(0.8), rel=0.05)
    assert found.frames.sum() == np.isfinite(gaps).sum()


def test_shapes_are_kept_and_units_go_through():
    x = ar1(0.5, 500, 12).reshape(500, 3, 2, 2)
    plain, scaled = estimate(x), estimate(-1e6 * x + 1e3)
    assert plain.mean.shape == plain.error.shape == plain.doubt.shape == (3, 2, 2)
    np.testing.assert_allclose(scaled.error, 1e6 * plain.error, rtol=1e-9)
    np.testing.assert_allclose(scaled.tau, plain.tau, rtol=1e-9)


def test_a_known_covariance_is_cut_at_its_window():
    """rho = 2^-t: tau(W) = 3/2 - 2^-W, cut at the first W >= 5 tau(W), which is 8."""
    rho = 0.5 ** np.arange(100.0)
    assert integrated_time(rho[:, None]) == pytest.approx([1.5 - 2.0**-8], rel=1e-14)


def test_pooled_times_are_at_least_the_mean_of_the_profile():
    rng = np.random.default_rng(3)
    slow = np.cumsum(rng.normal(size=(400, 1)), axis=0)
    series = np.hstack([slow, rng.normal(size=(400, 3))])
    alone, together = estimate(series), estimate(series, pooled=True)
    assert together.tau == pytest.approx(np.maximum(alone.tau, alone.tau.mean()))
    assert (together.error >= alone.error).all()
    assert np.array_equal(together.mean, alone.mean)


def test_pooled_errors_alarm_as_often_as_they_say():
    """Two AR(1) profiles of equal mean, 60 frames a tau: t tests at 1 % are right, with own taus they are not."""
    from scipy.signal import lfilter
    from scipy.stats import t

    rng, frames, tau, cells, alarms = np.random.default_rng(4), 125, 2.0, 20, {True: [], False: []}
    phi = (2 * tau - 1) / (2 * tau + 1)
    for _ in range(150):
        a, b = lfilter([1.0], [1.0, -phi], rng.normal(size=(2, frames + 100, cells)), axis=1)[:, 100:]
        for pooled in alarms:
            e, f = estimate(a, pooled=pooled), estimate(b, pooled=pooled)
            size = np.abs(e.mean - f.mean) / np.hypot(e.error, f.error)
            alarms[pooled] += list(2 * t.sf(size, np.minimum(e.samples, f.samples) - 1) < 0.01)
    assert np.mean(alarms[True]) < 0.015
    assert np.mean(alarms[False]) > 1.5 * np.mean(alarms[True])


@pytest.mark.parametrize("frames", [200, 600])
def test_an_error_of_its_own_alarms_as_often_as_it_says(frames):
    """10000 series of one number, a hundred times tau long or more: with the degrees of freedom of the error t tests
    at 1 % see what is not there in 1 % of them; with those of the samples far more often where series are short."""
    from scipy.stats import t

    found = estimate(ar1(0.6, frames, 10_000, seed=3))
    trusted = found.doubt == FINE
    size = np.abs(found.mean / found.error)
    alarms, believed = (
        np.mean((2.0 * t.sf(size, np.maximum(free, 0.5)) < 0.01) & trusted)
        for free in (found.freedom, found.samples - 1.0)
    )
    assert alarms == pytest.approx(0.01, abs=0.003)
    assert believed > (1.8 if frames == 200 else 1.1) * 0.01


def test_the_degrees_of_freedom_are_those_of_the_window():
    found = estimate(ar1(0.6, 400, 5))
    assert found.freedom == pytest.approx(400 / (10 * found.tau + 1))
    pooled = estimate(ar1(0.6, 400, 5), pooled=True)
    assert pooled.freedom == pytest.approx(pooled.samples - 1)
