"""Curves of the lattice box, whose answers are exact: eps(t) prescribed, x = x_0 (1 + eps/2), R = 1 + 20 eps."""

from dataclasses import replace

import numpy as np
import pytest

from harness.studies.compare.curves import biaxial_curves
from harness.studies.compare.macro import OF_THE_PEAK, OF_THE_PLATEAU, OF_THE_TEST, macro_values, plateau_mean


@pytest.fixture
def curves(box):
    return biaxial_curves(box.trajectory(), box.system)


def test_curves_are_exact(box, curves):
    eps = box.strain(curves.time)
    assert curves.strain == pytest.approx(eps, abs=1e-15)
    assert curves.z == pytest.approx(6e-3 * (1 - eps), rel=1e-14)
    assert curves.x == pytest.approx(6e-3 * (1 + eps / 2), rel=1e-14)
    assert curves.stress_xx == pytest.approx(np.full(41, 100.0), rel=1e-13)
    assert curves.stress_zz == pytest.approx(100 * (1 + 20 * eps), rel=1e-13)
    assert curves.ratio == pytest.approx(1 + 20 * eps, rel=1e-13)
    assert curves.control_error == pytest.approx(np.zeros(41), abs=1e-13)
    assert np.array_equal(curves.force_bottom, curves.force_top)


def test_angle_and_volume_strain(curves):
    """R = 3 is sin(phi) = 1/2, 30 degrees; compression is positive, dilation negative."""
    assert curves.friction_angle[-1] == pytest.approx(30.0)
    assert curves.volume_strain[-1] == pytest.approx(1 - 1.05 * 0.9)
    wide = replace(curves, x=curves.x[0] + 3 * (curves.x - curves.x[0]))
    assert wide.volume_strain[-1] == pytest.approx(1 - 1.15 * 0.9)
    assert wide.volume_strain[-1] < 0


def test_a_stress_that_pulls_has_no_angle(box, mutate):
    curves = biaxial_curves(mutate.series(box.trajectory(), top_fy=lambda f: -f), box.system)
    assert np.isnan(curves.friction_angle).all()
    empty = biaxial_curves(mutate.series(box.trajectory(), right_fx=lambda f: 0 * f), box.system)
    assert np.isnan(empty.ratio).all()


def test_the_peak_is_where_the_ratio_is_largest(box):
    """R = 1 + 40 eps (0.1 - eps)/0.1 has its maximum at eps = 0.05, half time, sample 20: R = 2."""
    curves = biaxial_curves(box.trajectory(lambda eps: 1 + 400 * eps * (0.1 - eps)), box.system)
    assert curves.peak.sample == 20
    assert curves.strain[20] == pytest.approx(0.05)
    macro = macro_values(curves, box.scene)
    assert macro["strain at the peak"] == pytest.approx(0.05)
    assert macro["peak stress ratio"] == pytest.approx(2.0)
    assert macro["peak friction angle"] == pytest.approx(np.degrees(np.arcsin(1 / 3)))


def test_a_burst_is_not_the_peak(box, mutate):
    """Many samples: a single one 50 % too high, long after the peak, moves neither the peak nor its height much."""
    many = box.changed(("samples = 40", "samples = 1000"))
    true = many.trajectory(lambda eps: 1 + 400 * eps * (0.1 - eps))
    burst = mutate.series(true, top_fy=lambda f: np.where(np.arange(len(f)) == 800, 1.5 * f, f))
    curves = biaxial_curves(burst, many.system)
    assert int(np.argmax(curves.stress_zz)) == 800
    assert curves.peak.strain == pytest.approx(0.05, abs=5e-4)
    assert macro_values(curves, many.scene)["peak stress ratio"] == pytest.approx(2.0, rel=1e-3)


def test_smoothing_is_the_mean_over_strain_and_nothing_where_samples_are_sparse(curves):
    """Samples within 0.0025 of strain; in the middle of the travel they are 0.004 apart."""
    smooth = curves.smoothed(curves.strain)
    assert smooth[20] == curves.strain[20]
    assert smooth[0] == pytest.approx(curves.strain[curves.strain <= 0.0025].mean())
    bad = np.where(np.arange(41) == 20, np.nan, 1.0)
    assert np.flatnonzero(np.isnan(curves.smoothed(bad))).tolist() == [20]


def test_the_window_holds_its_end_but_not_the_start(curves):
    at_end = curves.strain[7]
    inside = curves.upto(at_end)
    assert inside.sum() == 7
    assert inside[7]
    assert not inside[0]
    assert curves.upto(at_end * (1 - 1e-9)).sum() == 6
    assert not curves.upto(curves.strain[1] / 2).any()


def test_plateau_is_the_mean_over_strain_not_over_time(box, curves):
    """sigma_zz = 100 (1 + 20 eps) has the mean 100 (1 + 20 * 0.075) over [0.05, 0.1]; over time it is larger."""
    mean = macro_values(curves, box.scene)["plateau sigma_zz"]
    assert mean == pytest.approx(100 * (1 + 20 * 0.075), rel=1e-12)
    assert curves.stress_zz[20:].mean() > 1.02 * mean


@pytest.mark.parametrize("plateau", [(0.2, 0.3), (0.0499, 0.0501)])
def test_a_plateau_without_two_samples_is_not_computed(curves, plateau):
    assert np.isnan(plateau_mean(curves.stress_zz, curves, plateau))


def test_without_a_plateau_there_are_no_plateau_numbers(box, curves):
    plain = box.changed(("plateau = [0.05, 0.1]\n", ""))
    assert set(macro_values(curves, plain.scene)) == set(OF_THE_TEST)
    assert set(macro_values(curves, box.scene)) == set(OF_THE_TEST) | set(OF_THE_PLATEAU)


def test_a_test_that_never_falls_has_no_peak_and_no_numbers_of_one(box, curves):
    assert curves.peak is None
    with_peak = biaxial_curves(box.trajectory(lambda eps: 1 + 400 * eps * (0.1 - eps)), box.system)
    assert set(macro_values(with_peak, box.scene)) - set(macro_values(curves, box.scene)) == set(OF_THE_PEAK)
