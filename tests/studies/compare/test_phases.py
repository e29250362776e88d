"""How calm a test was: exact swings, parts of a test, and what is not known is left out."""

from dataclasses import replace

import numpy as np
import pytest

from harness.studies.compare.curves import biaxial_curves
from harness.studies.compare.phases import phases_of, swing
from harness.studies.compare.states import state_curves


def of(box, trajectory, plateau=None):
    states = state_curves(trajectory, box.system)
    return {p.name: p for p in phases_of(biaxial_curves(trajectory, box.system), states, plateau)}


def test_a_swing_is_relative_to_the_mean_over_strain():
    """One period of 100 (1 + sin/2): standard deviation 1/(2 sqrt 2), 50 % either way; samples need not be even."""
    strain = np.linspace(0, 1, 4001) ** 2
    found = swing(strain, 100 * (1 + 0.5 * np.sin(2 * np.pi * strain)))
    assert found.mean == pytest.approx(100.0)
    assert found.deviation == pytest.approx(0.5 / 2**0.5, rel=1e-4)
    assert (found.lowest, found.highest) == (pytest.approx(-0.5), pytest.approx(0.5))


def test_no_stress_has_no_relative_swing():
    assert np.isnan(swing(np.array([0.0, 1.0]), np.zeros(2)).deviation)


def test_parts_are_before_and_after_the_peak(box):
    """R = 1 + 400 eps (0.1 - eps): from 2 at 5 % down to 1 at the end, mean 1 + 2/3."""
    found = of(box, box.trajectory(lambda eps: 1 + 400 * eps * (0.1 - eps)), (0.05, 0.1))
    assert list(found) == ["up to the peak", "after the peak", "plateau"]
    before, after = found["up to the peak"], found["after the peak"]
    assert (before.low, before.high, before.swing) == (0.0, pytest.approx(0.05), None)
    assert (after.low, after.high) == (before.high, pytest.approx(0.1))
    assert after.swing.mean == pytest.approx(500 / 3, rel=1e-3)
    assert after.swing.lowest == pytest.approx(100 / after.swing.mean - 1)
    assert after.swing.highest == pytest.approx(200 / after.swing.mean - 1)
    assert before.energy == after.energy == (0.0, 0.0)
    assert found["plateau"].swing.mean == pytest.approx(after.swing.mean)


def test_a_test_without_a_peak_is_one_part(box):
    assert list(of(box, box.trajectory())) == ["whole test"]


def test_bursts_after_the_peak_are_not_said_to_be_before(box, mutate):
    true = box.trajectory(lambda eps: 1 + 400 * eps * (0.1 - eps))
    fast = mutate.column(true, "particles", "vx", lambda v: v + 1.0)
    late = replace(true, frames=(*true.frames[:15], *fast.frames[15:]))
    side = mutate.series(late, right_fx=lambda f: np.where(np.arange(len(f)) > 30, 1.25 * f, f))
    found = of(box, side)
    assert found["up to the peak"].energy[1] == 0.0
    assert found["after the peak"].energy[1] > 1.0
    assert found["up to the peak"].control == pytest.approx(0.0, abs=1e-12)
    assert found["after the peak"].control == pytest.approx(0.25)


def test_frames_without_contacts_tell_no_energy(box):
    true = box.trajectory()
    bare = replace(true, frames=tuple(replace(f, contacts=None) for f in true))
    assert of(box, bare)["whole test"].energy is None


def test_a_plateau_beyond_the_test_is_left_out(box):
    assert list(of(box, box.trajectory(), (0.2, 0.3))) == ["whole test"]
