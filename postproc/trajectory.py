"""A run in neutral form: frames (snapshots) and a series (one row a sample), kept in one HDF5 file.

Layout of ``trajectory.h5`` (flat float64 columns, one frame is read without the others)::

    /series/<column>                        (S,)   step, time, and per wall w: w_d, w_v, w_fx, w_fy[, w_fz];
                                                   per ring r: r_angle, r_torque, r_fx, r_fy
    /frames/time, step                      (F,)
    /frames/box                             (F, dim, 2), absent when there is none
    /<group>/offsets                        (F+1,) rows of frame k are offsets[k]:offsets[k+1]
    /<group>/<column>                       (rows,)        group: particles, contacts, walls
    attributes: dimension, thickness, periodic, finished = 1

Series columns of a wall: ``d`` displacement along its normal since the start (m), ``v`` its rate,
``f*`` the force of the particles on the wall (N; N/m in 2D per unit thickness). Of a ring: ``angle`` that it
has turned since the start (rad, counter-clockwise), ``torque`` of the particles on it about its centre (N m).
"""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any, TypeVar

import numpy as np

from postproc.snapshot import Columns, Snapshot

GROUPS = ("particles", "contacts", "walls")

LOCKING = False
"""A file is whole before it has its name, so readers need no lock; and HDF5's own lock is inherited for a moment by a
process that another thread starts: a file just written could then not be read."""


class ReadError(Exception):
    """A file that is damaged, cut short or not what it should be; the message names it and the place."""


@dataclass(frozen=True, kw_only=True)
class Trajectory:
    """Frames in order of time, their step numbers, and the series (None if not recorded)."""

    frames: tuple[Snapshot, ...]
    steps: tuple[int, ...]
    series: Columns | None

    def __iter__(self) -> Iterator[Snapshot]:
        return iter(self.frames)

    def __len__(self) -> int:
        return len(self.frames)


def write_trajectory(path: Path, trajectory: Trajectory) -> None:
    """Write atomically: a temporary file beside `path`, flushed to disk, then renamed."""
    import h5py

    path = Path(path)
    part = path.with_name(path.name + ".part")
    with h5py.File(part, "w", locking=LOCKING) as f:
        _write_frames(f, trajectory)
        if trajectory.series is not None:
            for name in trajectory.series:
                f[f"series/{name}"] = trajectory.series[name]
        f.attrs["finished"] = 1
    with open(part, "rb") as f:
        os.fsync(f.fileno())
    os.replace(part, path)


def read_trajectory(path: Path) -> Trajectory:
    """Read what `write_trajectory` wrote. Raises ReadError on anything else."""
    return _read(path, _read_all)


def read_frame(path: Path, number: int) -> Snapshot:
    """Read one frame of a trajectory, from 0, without the others. Raises ReadError."""
    return _read(path, lambda f: _read_frame(f, number))


def trajectory_times(path: Path) -> np.ndarray:
    """Read the times of the frames of a trajectory, (F,), s. Raises ReadError."""
    return _read(path, lambda f: f["frames/time"][()])


T = TypeVar("T")


def _read(path: Path, what: Callable[[Any], T]) -> T:
    """Apply `what` to the opened file of a finished trajectory."""
    import h5py

    try:
        with h5py.File(path, "r", locking=LOCKING) as f:
            if f.attrs.get("finished") != 1:
                raise ReadError(f"{path}: not a finished trajectory")
            return what(f)
    except (OSError, KeyError, ValueError, IndexError) as error:
        raise ReadError(f"{path}: cannot be read as a trajectory: {error}") from error


def _read_all(f) -> Trajectory:
    series = f.get("series")
    return Trajectory(
        frames=tuple(_read_frame(f, k) for k in range(len(f["frames/time"]))),
        steps=tuple(int(s) for s in f["frames/step"][()]),
        series=None if series is None else Columns({k: v[()] for k, v in series.items()}, "series"),
    )


def _write_frames(f, trajectory: Trajectory) -> None:
    frames = trajectory.frames
    first = frames[0]
    f.attrs["dimension"], f.attrs["thickness"] = first.dimension, first.thickness
    if first.periodic is not None:
        f.attrs["periodic"] = np.array(first.periodic)
    f["frames/time"] = np.array([s.time for s in frames])
    f["frames/step"] = np.array(trajectory.steps)
    if first.box is not None:
        f["frames/box"] = np.array([s.box for s in frames])
    for group in GROUPS:
        tables = [getattr(s, group) for s in frames]
        if tables[0] is not None:
            _write_group(f.create_group(group), tables)


def _write_group(group, tables: list[Columns]) -> None:
    group["offsets"] = np.concatenate([[0], np.cumsum([t.rows for t in tables])])
    for name in tables[0]:
        group[name] = np.concatenate([t[name] for t in tables])


def _read_frame(f, k: int) -> Snapshot:
    return Snapshot(
        time=float(f["frames/time"][k]),
        dimension=int(f.attrs["dimension"]),
        thickness=float(f.attrs["thickness"]),
        periodic=tuple(bool(p) for p in f.attrs["periodic"]) if "periodic" in f.attrs else None,
        box=f["frames/box"][k] if "frames/box" in f else None,
        **{g: _read_group(f[g], k, g) if g in f else None for g in GROUPS},
    )


def _read_group(group, k: int, name: str) -> Columns:
    low, high = group["offsets"][k : k + 2]
    return Columns({c: group[c][low:high] for c in group if c != "offsets"}, name)
