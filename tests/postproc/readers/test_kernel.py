"""The kernel's native output, written here by hand."""

import h5py
import numpy as np
import pytest

from postproc.readers.kernel import read_kernel
from postproc.trajectory import ReadError, read_trajectory, write_trajectory


def _write(folder, states, *, dim=2, finished=1, periodic=None, walls=True, contacts=True, frames=12):
    with h5py.File(folder / "frames.h5", "w") as f:
        f.attrs["dimension"] = dim
        if periodic:
            f.attrs["periodic"] = periodic
        for k in range(frames):
            state = states.random_contacts(k, dim)
            group = f.create_group(f"frame/{k}")
            group.attrs["time"], group.attrs["step"] = 0.5 * k, 10 * k
            groups = ("particles", *["contacts"] * contacts, *["walls"] * walls)
            for name in groups:
                for column, values in getattr(state, name).items():
                    group[f"{name}/{column}"] = values
        if finished:
            f.attrs["finished"] = 1
    rows = "".join(f"{5 * k},{k / 4:.17g},{1 / (k + 1):.17g}\n" for k in range(2 * frames - 1))
    (folder / "series.csv").write_text("step,time,top_d\n" + rows)
    return folder


def test_frames_and_series(tmp_path, states):
    trajectory = read_kernel(_write(tmp_path, states))
    assert trajectory.steps == tuple(range(0, 120, 10))  # in order of number, not of name
    for k, frame in enumerate(trajectory):
        expected = states.random_contacts(k, 2)
        assert frame.time == 0.5 * k
        np.testing.assert_array_equal(frame.box, expected.box)
        for group in ("particles", "contacts", "walls"):
            for name, values in getattr(expected, group).items():
                np.testing.assert_array_equal(getattr(frame, group)[name], values)
    np.testing.assert_array_equal(trajectory.series["top_d"], 1 / np.arange(1, 24))


def test_what_is_off_is_not_there_and_survives_the_common_file(tmp_path, states):
    trajectory = read_kernel(_write(tmp_path, states, walls=False, contacts=False))
    assert trajectory.frames[0].contacts is trajectory.frames[0].walls is trajectory.frames[0].box is None
    write_trajectory(tmp_path / "trajectory.h5", trajectory)
    again = read_trajectory(tmp_path / "trajectory.h5")
    np.testing.assert_array_equal(again.frames[3].particles["x"], trajectory.frames[3].particles["x"])


def test_periodic_axes_bound_the_box_like_walls(tmp_path, states):
    folder = _write(tmp_path, states, walls=False, periodic=[True, True])
    frame = read_kernel(folder, periodic=(3.0, 4.0)).frames[0]
    assert frame.box.tolist() == [[0.0, 3.0], [0.0, 4.0]]
    assert frame.periodic == (True, True)
    assert read_kernel(folder).frames[0].box is None
    assert read_kernel(folder, periodic=(3.0, 0.0)).frames[0].box is None


def _fails(folder, message):
    with pytest.raises(ReadError, match=message) as caught:
        read_kernel(folder)
    assert "\n" not in str(caught.value)


def test_unfinished(tmp_path, states):
    _fails(_write(tmp_path, states, finished=0), "frames.h5: attribute finished: expected 1, got None")


def test_truncated_frames(tmp_path, states):
    path = _write(tmp_path, states) / "frames.h5"
    path.write_bytes(path.read_bytes()[:-4000])
    _fails(tmp_path, "frames.h5: file: expected a whole HDF5 file of the kernel, got")


def test_missing(tmp_path):
    _fails(tmp_path, "frames.h5: file: expected a whole HDF5 file of the kernel, got")


def test_nan_in_a_frame(tmp_path, states):
    with h5py.File(_write(tmp_path, states) / "frames.h5", "r+") as f:
        f["frame/11/particles/vx"][2] = np.nan
    _fails(tmp_path, "frame 11: particles.vx: row 3: expected a finite number, got nan")


@pytest.mark.parametrize(("change", "message"), [
    (lambda text: text[: text.rindex("\n110,") + 1], "last row: expected step 110, as in frames.h5, got step"),
    (lambda text: text[: text.rindex(",")] + "\n", "row 23: expected 3 fields, got 2"),
    (lambda text: text.replace("0.5,", "nan,", 1), "row 3, column time: expected a finite number, got nan"),
])
def test_damaged_series(tmp_path, states, change, message):
    path = _write(tmp_path, states) / "series.csv"
    path.write_text(change(path.read_text()))
    _fails(tmp_path, message)
