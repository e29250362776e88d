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
from itertools import pairwise
from pathlib import Path
from typing import Any, TypeVar

import numpy as np

from postproc.snapshot import Columns, Snapshot

GROUPS = ("particles", "contacts", "walls")

BLOCK = 64
"""Frames that are read at once."""

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
    return _read(path, lambda f: _read_frames(f, number, number + 1)[0])


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
    series, count = f.get("series"), len(f["frames/time"])
    return Trajectory(
        frames=tuple(frame for k in range(0, count, BLOCK) for frame in _read_frames(f, k, min(k + BLOCK, count))),
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


def _read_frames(f, first: int, last: int) -> list[Snapshot]:
    """Read the frames from `first` up to, not with, `last`."""
    frames = {name: values[first:last] for name, values in f["frames"].items()}
    tables = {g: _read_group(f[g], first, last, g) if g in f else [None] * (last - first) for g in GROUPS}
    whole = {
        "dimension": int(f.attrs["dimension"]), "thickness": float(f.attrs["thickness"]),
        "periodic": tuple(bool(p) for p in f.attrs["periodic"]) if "periodic" in f.attrs else None,
    }
    return [
        Snapshot(
            time=float(time), box=frames["box"][k] if "box" in frames else None, **whole,
            **{g: tables[g][k] for g in GROUPS},
        )
        for k, time in enumerate(frames["time"])
    ]


def _read_group(group, first: int, last: int, name: str) -> list[Columns]:
    """Read every column of these frames at once, then cut: reading frame by frame costs more than what is read."""
    offsets = group["offsets"][first : last + 1]
    rows = offsets - offsets[0]
    columns = {c: values[offsets[0] : offsets[-1]] for c, values in group.items() if c != "offsets"}
    return [
        Columns({c: values[low:high] for c, values in columns.items()}, name) for low, high in pairwise(rows)
    ]
