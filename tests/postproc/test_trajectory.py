"""Trajectories that are longer than what is read at once: every frame comes back, whatever it holds."""

import numpy as np
import pytest

from postproc.snapshot import Columns
from postproc.trajectory import BLOCK, ReadError, Trajectory, read_frame, read_trajectory, write_trajectory


@pytest.fixture
def written(states, tmp_path):
    """written(frames, box) is a trajectory with other contacts in every frame, in some none, and its file."""

    def make(count: int, *, box: bool = True):
        touching = states.random_contacts(0, 2, count=60)
        frames = tuple(
            states.replace(
                touching, time=0.5 * k, box=np.array([[-3.0, 3.0 + k], [-3.0, 3.0]]) if box else None,
                contacts=Columns({c: v[: k % 7] + k for c, v in touching.contacts.items()}, "contacts"),
            ) for k in range(count)
        )
        series = Columns({"step": np.arange(5.0), "time": np.arange(5.0) / 3}, "series")
        made = Trajectory(frames=frames, steps=tuple(range(0, 10 * count, 10)), series=series)
        write_trajectory(tmp_path / "t.h5", made)
        return made, tmp_path / "t.h5"

    return make


def assert_same(a, b):
    assert (a.time, a.dimension, a.thickness, a.periodic) == (b.time, b.dimension, b.thickness, b.periodic)
    np.testing.assert_array_equal(a.box, b.box)
    for group in ("particles", "contacts", "walls"):
        left, right = getattr(a, group), getattr(b, group)
        assert (left is None) == (right is None)
        assert {c: v.tobytes() for c, v in (left or {}).items()} == {c: v.tobytes() for c, v in (right or {}).items()}


@pytest.mark.parametrize("count", [1, BLOCK - 1, BLOCK, BLOCK + 1, 2 * BLOCK + 3])
def test_every_frame_comes_back_to_the_bit(written, count):
    made, path = written(count)
    found = read_trajectory(path)
    assert found.steps == made.steps
    assert len(found) == count
    for a, b in zip(made, found, strict=True):
        assert_same(a, b)
    assert_same(read_frame(path, count - 1), made.frames[-1])


def test_without_a_box_there_is_none(written):
    assert all(f.box is None for f in read_trajectory(written(3, box=False)[1]))


def test_a_frame_is_its_own(written):
    """Frames are read together; who keeps one does not keep all."""
    frame = read_trajectory(written(5)[1]).frames[2]
    assert all(v.base is None for v in frame.particles.values())


@pytest.mark.parametrize("damage", ["particles/offsets", "contacts/offsets", "frames/time", "frames/step"])
def test_what_is_missing_is_said(written, damage):
    import h5py

    _, path = written(4)
    with h5py.File(path, "a") as f:
        del f[damage]
    with pytest.raises(ReadError, match="cannot be read as a trajectory"):
        read_trajectory(path)


def test_offsets_cut_short_are_found(written):
    import h5py

    _, path = written(4)
    with h5py.File(path, "a") as f:
        offsets = f["contacts/offsets"][:-2]
        del f["contacts/offsets"]
        f["contacts/offsets"] = offsets
    with pytest.raises(ReadError, match="cannot be read as a trajectory"):
        read_trajectory(path)
