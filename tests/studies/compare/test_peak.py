"""The peak of the first loading branch: exact places, and none that noise, bursts or round-off could move."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from harness.engines.registry import ENGINES
from harness.runs.execute import run_one
from harness.scene.load import load_scene
from harness.studies.compare.curves import SMOOTHED, BiaxialCurves, biaxial_curves
from harness.studies.compare.peak import DROP, SCATTERS, first_peak
from harness.studies.prepare import prepare
from postproc.trajectory import read_trajectory

QUICK = Path(__file__).resolve().parents[3] / "inputs" / "scenes" / "biaxial_quick.toml"
STRAIN = 0.05 * (1 - np.cos(np.pi * np.linspace(0, 1, 1001)))


def loading(strain):
    """sigma_zz like that of the shipped box: to 264 N/m at 0.9 %, down to 230 at 2.2 %."""
    return np.interp(strain, [0, 0.002, 0.004, 0.009, 0.014, 0.022], [100, 200, 240, 264, 258, 230])


def bursts(strain, phase):
    """Swings that grow from 2.2 % on, larger than the peak at their best, in any phase."""
    late = np.clip(strain - 0.022, 0, None)
    return 900 * late * np.sin(2 * np.pi * late / 0.012 + phase)


def curves_of(stress, strain=STRAIN) -> BiaxialCurves:
    one = np.ones_like(strain)
    return BiaxialCurves(
        step=np.arange(len(strain)), time=np.arange(len(strain)) * 1e-3, strain=strain, x=one, z=1 - strain,
        force_top=stress, force_bottom=stress, force_left=100 * (1 - strain), force_right=100 * (1 - strain),
        pressure=100.0,
    )


@pytest.mark.parametrize("seed", range(12))
def test_neither_noise_nor_later_bursts_move_the_peak(seed):
    """Noise of 1 % before, bursts of another phase after: within the smoothing, and the top holds the true strain."""
    rng = np.random.default_rng(seed)
    stress = loading(STRAIN) + bursts(STRAIN, rng.uniform(0, 2 * np.pi)) + rng.normal(0, 2.6, len(STRAIN))
    curves = curves_of(stress)
    assert curves.smoothed(stress).max() > 1.03 * 264  # what the largest value of the whole test would be
    assert curves.peak.strain == pytest.approx(0.009, abs=SMOOTHED / 2)
    assert curves.peak.low < 0.009 < curves.peak.high < 0.018
    assert curves.smoothed(stress)[curves.peak.sample] == pytest.approx(262, rel=0.01)


def test_round_off_moves_nothing():
    stress = loading(STRAIN) + bursts(STRAIN, 1.0)
    kicked = stress * (1 + 1e-15 * np.random.default_rng(1).normal(size=len(stress)))
    assert curves_of(kicked).peak == curves_of(stress).peak


@pytest.mark.parametrize("seed", range(6))
def test_a_curve_that_creeps_up_to_a_noisy_plateau_has_no_peak(seed):
    """As without friction: 4 % of noise with a memory of some samples."""
    noise = np.convolve(np.random.default_rng(seed).normal(size=1021), np.ones(5) / 5**0.5, mode="same")[10:-10]
    stress = 100 + 25 * (1 - np.exp(-STRAIN / 0.015)) + 0.04 * 125 * noise
    assert curves_of(stress).peak is None


def tent(fall):
    """Up to 2 at 0.5, then down by the fraction `fall`; strain in 101 equal parts."""
    strain = np.linspace(0, 1, 101)
    return strain, np.interp(strain, [0, 0.5, 1], [1, 2, 2 * (1 - fall)])


def test_a_fall_counts_from_the_declared_fraction_on():
    for fall, found in ((0.99 * DROP, False), (1.01 * DROP, True)):
        strain, stress = tent(fall)
        peak = first_peak(strain, stress, stress, settled=0.0)
        assert (peak is not None) == found
    assert (peak.sample, peak.strain) == (50, 0.5)


def test_the_top_is_within_three_per_cent():
    """Rising by a little less than 0.02 a sample to 2 and falling as fast: 0.06 below, three samples on either side."""
    strain = np.linspace(0, 1, 101)
    stress = 2 - 0.0199 * np.abs(np.arange(101) - 50.0)
    peak = first_peak(strain, stress, stress, settled=0.0)
    assert (peak.low, peak.high) == (pytest.approx(0.47), pytest.approx(0.53))
    assert peak.where == "50 % strain (top from 47 to 53 %)"


def test_a_fall_within_the_scatter_does_not_count():
    strain, smooth = tent(0.2)
    for amplitude, found in ((0.9 * 0.4 / SCATTERS, True), (1.1 * 0.4 / SCATTERS, False)):
        stress = smooth + amplitude * (-1.0) ** np.arange(101)
        assert (first_peak(strain, stress, smooth, settled=0.0) is not None) == found


def test_the_first_of_two_branches_counts_though_the_second_is_higher():
    strain = np.linspace(0, 1, 101)
    stress = np.interp(strain, [0, 0.2, 0.3, 0.8, 1], [1, 2, 1.8, 3, 1])
    assert first_peak(strain, stress, stress, settled=0.0).strain == pytest.approx(0.2)


def test_no_number_is_no_peak():
    stress = np.where(STRAIN > 0.005, np.nan, loading(STRAIN))
    assert curves_of(stress).peak is None


@pytest.mark.long
def test_a_kick_of_1e_15_moves_the_end_of_a_run_and_not_its_peak(tmp_path):
    """The quick box on the kernel, once with a disc 1e-15 of its place aside: the ends differ, the peaks do not."""
    (start,) = prepare(load_scene(QUICK), QUICK, packings=1, cache=tmp_path / "packings")
    x = start.system.particles.x.copy()
    x[0, 0] *= 1 + 1e-15
    kicked = start.system.with_(particles=replace(start.system.particles, x=x))
    assert (kicked.particles.x != start.system.particles.x).sum() == 1
    found = []
    for system in (start.system, kicked):
        outcome, folder = run_one(ENGINES["kernel:lammps"], system, tmp_path / "runs", time_limit=600.0)
        assert outcome.status == "completed", outcome.reason
        found.append(biaxial_curves(read_trajectory(folder / "trajectory.h5"), system))
    a, b = found
    assert np.abs(a.force_top / b.force_top - 1)[-50:].max() > 0.01
    assert a.peak.sample == b.peak.sample
    assert (a.peak.low, a.peak.high) == (pytest.approx(b.peak.low), pytest.approx(b.peak.high))
    heights = [c.smoothed(c.stress_zz)[c.peak.sample] for c in found]
    assert heights[0] == pytest.approx(heights[1], rel=1e-6)
