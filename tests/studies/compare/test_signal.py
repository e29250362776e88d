"""Signals: what differences are measured by, and where a window ends."""

import numpy as np
import pytest

from harness.studies.compare.signal import Signal, signal_deviation


def signal(value, *, relative="rms", step=None):
    n = len(value)
    return Signal(
        step=np.arange(n) if step is None else step, place=0.1 * np.arange(n), value=np.array(value), quantity="torque",
        axis="time (s)", word="s", scale=1.0, relative=relative,
    )


def test_a_signal_that_passes_zero_is_measured_by_its_rms():
    a, b = signal([3.0, 0.0, -4.0]), signal([3.0, 0.5, -4.0])
    rms = np.sqrt((9 + 0.25 + 16) / 3)
    assert signal_deviation(a, b) == pytest.approx([0.0, 0.5 / rms, 0.0])
    assert signal_deviation(signal([3.0, 0.0], relative="sample"), signal([3.0, 0.5], relative="sample"))[1] == 1.0


def test_no_number_never_passes_and_other_steps_are_refused():
    assert np.isnan(signal_deviation(signal([1.0, np.nan]), signal([1.0, 1.0]))[1])
    with pytest.raises(ValueError, match="steps"):
        signal_deviation(signal([1.0, 2.0]), signal([1.0, 2.0], step=np.array([0, 2])))


def test_windows_end_where_they_say_and_begin_after_step_0():
    s = signal([0.0] * 6)
    assert s.upto(0.3).tolist() == [False, True, True, True, False, False]
    assert s.at(0.25) == "0.25 s"
