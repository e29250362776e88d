"""Native output of the NumPy kernel: ``frames.h5`` and ``series.csv`` in one folder."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np

from postproc.readers.check import check_snapshot, wrong
from postproc.readers.state_formats import read_csv_table
from postproc.readers.walls import box_from_walls
from postproc.snapshot import Columns, Snapshot
from postproc.trajectory import GROUPS, ReadError, Trajectory

FRAMES, SERIES = "frames.h5", "series.csv"


def read_kernel(folder: Path, *, periodic: Sequence[float] | None = None) -> Trajectory:
    """Read a finished run of the kernel.

    periodic: box length an axis, 0 for open axes (the box starts at the origin), None without
    periodic axes; the kernel's files say which axes are periodic but not how long they are.
    Raises ReadError (file, place, expected, got) on a run that did not finish or is damaged.
    """
    path = Path(folder) / FRAMES
    steps, frames = _read_frames(path, periodic)
    for k, frame in enumerate(frames):
        check_snapshot(path, frame, f"frame {k}: ")
    series = _read_series(path.with_name(SERIES), steps[-1])
    return Trajectory(frames=frames, steps=steps, series=series)


def _read_frames(path: Path, periodic: Sequence[float] | None) -> tuple[tuple[int, ...], tuple[Snapshot, ...]]:
    import h5py

    try:
        with h5py.File(path, "r") as f:
            if f.attrs.get("finished") != 1:
                raise wrong(path, "attribute finished", "1", f.attrs.get("finished"))
            if not len(f["frame"]):
                raise wrong(path, "frame", "at least one frame", "none")
            groups = [f["frame"][name] for name in sorted(f["frame"], key=int)]
            steps = tuple(int(g.attrs["step"]) for g in groups)
            return steps, tuple(_read_frame(g, f.attrs, periodic) for g in groups)
    except (OSError, RuntimeError, KeyError, TypeError, ValueError) as error:
        raise wrong(path, "file", "a whole HDF5 file of the kernel", error) from error


def _read_frame(group, attributes, periodic: Sequence[float] | None) -> Snapshot:
    dimension = int(attributes["dimension"])
    tables = {g: Columns({n: v[()] for n, v in group[g].items()}, g) for g in GROUPS if g in group}
    axes = attributes.get("periodic")
    return Snapshot(
        time=float(group.attrs["time"]),
        dimension=dimension,
        periodic=None if axes is None else tuple(bool(a) for a in axes),
        box=_box(tables.get("walls"), dimension, periodic),
        **tables,
    )


def _box(walls: Columns | None, dimension: int, periodic: Sequence[float] | None) -> np.ndarray | None:
    """Return the box; the two ends of a periodic axis bound it like a pair of walls, and rings bound nothing."""
    names = [letter + a for letter in "pn" for a in "xyz"[:dimension]]
    rows = list(walls.vector(*names)) if walls is not None and "nx" in walls else []
    for axis, length in enumerate(periodic or ()):
        if length > 0:
            unit = np.eye(dimension)[axis]
            rows += [np.concatenate([0.0 * unit, unit]), np.concatenate([length * unit, -unit])]
    faces = dict(zip(names, np.reshape(rows, (-1, len(names))).T, strict=True))
    return box_from_walls(Columns(faces, "walls"), dimension)


def _read_series(path: Path, last_step: int) -> Columns:
    table = {name: np.array(values) for name, values in read_csv_table(path).items()}
    for name, values in table.items():
        if not np.isfinite(values).all():
            row = int(np.argmin(np.isfinite(values)))
            raise wrong(path, f"row {row + 1}, column {name}", "a finite number", values[row])
    last = table.get("step", np.empty(0))[-1:]
    if last.tolist() != [last_step]:
        raise wrong(path, "last row", f"step {last_step}, as in {FRAMES}", f"step {last}")
    return Columns(table, "series")


__all__ = ["ReadError", "read_kernel"]
