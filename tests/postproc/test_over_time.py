"""Means over the frames of a run: the same numbers as the analysis class gives, written like one state's."""

import csv
import json
from dataclasses import replace

import numpy as np
import pytest

from postproc.analysis import averaging_class
from postproc.average import main
from postproc.averaging.words import WrongSetting
from postproc.over_time import average_over_time
from postproc.trajectory import Trajectory, write_trajectory

FRAMES = 40


def moved(state, k: int, time: float):
    """The state at another time, with all forces a little different."""
    factor = 1.0 + 0.1 * np.random.default_rng(k).normal()
    contacts = {c: state.contacts[c] * (factor if c in ("fx", "fy") else 1.0) for c in state.contacts}
    return replace(state, time=time, contacts=type(state.contacts)(contacts, "contacts"))


@pytest.fixture
def run(states, tmp_path):
    """A trajectory.h5 of FRAMES frames, 0.5 s apart."""
    state = states.random_contacts(2, 2, count=30)
    frames = tuple(moved(state, k, 0.5 * k) for k in range(FRAMES))
    path = tmp_path / "trajectory.h5"
    write_trajectory(path, Trajectory(frames=frames, steps=tuple(range(FRAMES)), series=None))
    return path


def test_means_and_errors_are_those_of_the_analysis(run):
    found = average_over_time(run, slice(10, None), cells="strips:x:3", fields="stress,volume_fraction")
    expected = averaging_class()(run, cells="strips:x:3").run(start=10).time_average("stress")
    np.testing.assert_array_equal(found.in_cells["stress"].values, expected.mean)
    np.testing.assert_array_equal(found.in_cells["stress"].errors, expected.error)
    assert (found.in_cells["stress"].errors > 0).any()
    assert found.period.frames == FRAMES - 10
    assert (found.period.first, found.period.last) == (5.0, 0.5 * (FRAMES - 1))


def test_a_constant_is_no_evidence_of_its_error(run):
    found = average_over_time(run, slice(None), fields="volume_fraction")
    assert "no fluctuation" in found.in_cells["volume_fraction"].doubt


def test_the_command_writes_an_error_beside_each_value(run, tmp_path, capsys):
    words = ["--frames", "10:", "--cells", "strips:x:3", "--fields", "stress"]
    assert main([str(run), *words, "--out", str(tmp_path)]) == 0
    assert "mean of 30 frames, t = 5 to 19.5 s" in capsys.readouterr().out
    with open(tmp_path / "cells.csv") as f:
        rows = list(csv.DictReader(f))
    assert len(rows) == 3
    assert all(float(row["stress_xx error (N/m)"]) > 0 for row in rows)
    data = json.loads((tmp_path / "average.json").read_text())
    assert data["period"] == {"first": 5.0, "last": 19.5, "frames": 30}
    assert data["weights"] == "area"
    assert np.shape(data["in_cells"]["stress"]["errors"]) == (3, 2, 2)


@pytest.mark.parametrize(("words", "said"), [
    (["--frames", "5"], "expected START:STOP"),
    (["--frames", "a:"], "expected START:STOP"),
    (["--frames", "39:"], "expected 3 or more, got 1 of 40"),
    (["--frames", "3:", "--frame", "2"], "without --frame"),
])
def test_ranges_that_make_no_mean_are_refused_in_a_line(run, capsys, words, said):
    try:
        status = main([str(run), *words])
    except SystemExit as stop:
        status = stop.code
    (line,) = capsys.readouterr().err.splitlines()
    assert status == 2
    assert said in line


def test_a_single_state_has_no_frames(tmp_path, capsys):
    (tmp_path / "state.json").write_text('{"particles": {"id": [1], "x": [0.0], "y": [0.0], "radius": [1.0]}}')
    assert main([str(tmp_path / "state.json"), "--frames", "0:"]) == 2
    assert "a single state" in capsys.readouterr().err


def test_frames_at_uneven_times_are_refused(states, tmp_path):
    state = states.random_contacts(2, 2, count=10)
    frames = tuple(moved(state, k, float(k * k)) for k in range(5))
    write_trajectory(tmp_path / "t.h5", Trajectory(frames=frames, steps=tuple(range(5)), series=None))
    with pytest.raises(WrongSetting, match="even steps of time"):
        average_over_time(tmp_path / "t.h5", slice(None), fields="stress")
