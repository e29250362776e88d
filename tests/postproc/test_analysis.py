"""Averages over frames: MDAnalysis' loop, arrays over time, errors, and what frames lack."""

import numpy as np
import pytest

from postproc.analysis import Frames, Series, averaging_class
from postproc.average import average
from postproc.averaging.registry import WrongSetting
from postproc.snapshot import MissingColumn
from postproc.trajectory import ReadError, Trajectory, read_frame, read_trajectory, trajectory_times, write_trajectory
from postproc.uncertainty import estimate


@pytest.fixture
def run(states):
    frames = tuple(states.replace(states.random_contacts(k, 2, count=60), time=0.5 * k) for k in range(8))
    box = np.array([[-3.0, 3.0], [-3.0, 3.0]])
    return Trajectory(frames=tuple(states.replace(f, box=box) for f in frames), steps=tuple(range(8)), series=None)


@pytest.fixture
def averaging():
    return averaging_class()


def test_it_is_an_analysis_of_mdanalysis(averaging):
    from MDAnalysis.analysis.base import AnalysisBase

    assert issubclass(averaging, AnalysisBase)
    assert averaging_class() is averaging


def test_results_are_arrays_over_frames(run, averaging):
    done = averaging(run, cells="rings:3:0.1:2", fields=("stress", "velocity")).run(start=1, step=3)
    assert done.frames.tolist() == [1, 4, 7]
    assert done.times.tolist() == [0.5, 2.0, 3.5]
    assert sorted(done.results) == ["stress", "velocity"]
    assert done.results.stress.shape == (3, 3, 2, 2)
    for row, k in enumerate((1, 4, 7)):
        expected = average(run.frames[k], cells="rings:3:0.1:2")
        np.testing.assert_array_equal(done.results.stress[row], expected["stress"])
    assert done.units == {"stress": "N/m", "velocity": "m/s"}
    assert done.components["stress"] == ("rr", "rphi", "phir", "phiphi")
    assert done.coordinates["r_inner"].shape == (3, 3)
    assert done.labels == ("1", "2", "3")


def test_time_averages_have_errors(run, averaging):
    done = averaging(run, cells="grid:2x2", fields="volume_fraction").run()
    found, expected = done.time_average("volume_fraction"), estimate(done.results.volume_fraction)
    for name in ("mean", "error", "tau", "doubt"):
        np.testing.assert_array_equal(getattr(found, name), getattr(expected, name))
    assert found.mean.shape == (4,)


def test_a_file_is_read_frame_by_frame(run, averaging, tmp_path):
    path = tmp_path / "trajectory.h5"
    write_trajectory(path, run)
    whole, some = (averaging(source, fields="stress").run(frames=[2, 5]) for source in (run, path))
    np.testing.assert_array_equal(whole.results.stress, some.results.stress)
    assert trajectory_times(path).tolist() == [0.5 * k for k in range(8)]
    frame, all_of_them = read_frame(path, 3), read_trajectory(path)
    np.testing.assert_array_equal(frame.particles["x"], all_of_them.frames[3].particles["x"])
    with pytest.raises(ReadError, match="cannot be read as a trajectory"):
        read_frame(path, 8)
    with pytest.raises(ReadError, match="cannot be read as a trajectory"):
        averaging(tmp_path / "none.h5")


def test_strains_are_measured_from_the_first_frame_of_the_run(run, averaging, states):
    last = states.replace(run.frames[-1], box=run.frames[-1].box * 0.9)
    shorter = Trajectory(frames=(*run.frames[:-1], last), steps=run.steps, series=None)
    done = averaging(shorter, fields="axial_strain").run(start=6)
    np.testing.assert_allclose(done.results.axial_strain[:, 0], [[0, 0], [0.1, 0.1]], atol=1e-15)
    assert "axial_strain" in averaging(shorter, fields="axial_strain", reference=None).run().unavailable


def test_what_a_frame_lacks_is_unavailable_with_the_reason(run, averaging, states):
    lacking = states.replace(run.frames[2], contacts=None)
    broken = Trajectory(frames=(*run.frames[:2], lacking, *run.frames[3:]), steps=run.steps, series=None)
    done = averaging(broken, fields="stress,volume_fraction").run()
    assert done.unavailable == {"stress": "contacts were not recorded (in 1 of 8 frames)"}
    assert list(done.results) == ["volume_fraction"]
    with pytest.raises(MissingColumn, match="stress: contacts were not recorded"):
        done.time_average("stress")
    with pytest.raises(WrongSetting, match="names such as stress"):
        averaging(run, fields="stres").run()


def test_uneven_frames_and_changing_cells_are_refused(run, states):
    averages = [average(f, cells="box", fields="stress") for f in run.frames]
    with pytest.raises(ValueError, match=r"expected even steps of time .* got 0.5 to 1 s"):
        Series((averages[0], averages[1], averages[3])).time_average("stress")
    assert Series(tuple(averages[:1])).time_average("stress").doubt.tolist() == [[["few"] * 2] * 2]
    more = average(run.frames[0], cells="rings:2:0:1", fields="stress")
    with pytest.raises(ValueError, match="expected as many in every frame, got 1 to 2"):
        Series((averages[0], more))


def test_frames_are_sliced_like_python_does(run):
    frames = Frames.of(run)
    assert frames.check_slice_indices(None, None, None) == (0, 8, 1)
    assert frames.check_slice_indices(-3, None, 2) == (5, 8, 2)
    assert [ts.frame for ts in frames[1:7][::2]] == [1, 3, 5]
    assert frames[-1].time == 3.5
    assert len(frames[np.array([0, 3])]) == 2
