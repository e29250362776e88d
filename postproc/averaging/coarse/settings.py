"""Which points are meant by the words after `points:`."""

from __future__ import annotations

import csv
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from postproc.averaging.words import MOST, WrongSetting, counts, refuse
from postproc.geometry import positions, region
from postproc.snapshot import MissingColumn, Snapshot


def points_of(words: Sequence[str], snapshot: Snapshot) -> dict[str, object]:
    """Return points and shape for points:FILE.csv or points:NXxNY[xNZ]. Raises WrongSetting."""
    text = ":".join(words)
    if not text:
        raise refuse("points", "a file FILE.csv or points an axis, as in points:32x32", "nothing")
    if text.lower().endswith(".csv"):
        return {"points": read_points(Path(text), snapshot.axes)}
    shape = counts("points", text, snapshot.dimension)
    return {"points": grid_points(shape, sample_bounds(snapshot)), "shape": shape}


def grid_points(shape: Sequence[int], bounds: np.ndarray) -> np.ndarray:
    """Return the middles of equal rectangles that fill `bounds` (dim, 2), last axis running fastest: (K, dim)."""
    lines = [low + (np.arange(n) + 0.5) * (high - low) / n for n, (low, high) in zip(shape, bounds, strict=True)]
    return np.stack(np.meshgrid(*lines, indexing="ij"), axis=-1).reshape(-1, len(lines))


def sample_bounds(snapshot: Snapshot) -> np.ndarray:
    """Bounds of the box (or around the ring walls), else of the particles with their radii, (dim, 2), m."""
    try:
        return region(snapshot)
    except MissingColumn:
        x, a = positions(snapshot), snapshot.particles["radius"][:, None]
        if not len(x):
            raise refuse("points", "a box or particles to lay a grid over", "neither") from None
        return np.stack([(x - a).min(axis=0), (x + a).max(axis=0)], axis=1)


def read_points(file: Path, axes: Sequence[str]) -> np.ndarray:
    """Read columns x, y[, z] of a CSV file, others left aside: (K, dim), m. Raises WrongSetting with file and line."""
    try:
        with file.open(newline="", encoding="utf-8-sig") as lines:
            rows = csv.reader(lines)
            head = [name.strip() for name in next(rows, [])]
            columns = [_column(file, head, axis) for axis in axes]
            found = [_numbers(file, rows.line_num, row, columns, axes) for row in rows if row]
    except OSError as error:
        raise _wrong(file, "file", "points as CSV", error.strerror) from None
    except (UnicodeDecodeError, csv.Error) as error:
        raise _wrong(file, "file", "points as CSV", error) from None
    if not 0 < len(found) <= MOST:
        raise _wrong(file, "rows", f"1 to {MOST} points", len(found))
    return np.array(found)


def _column(file: Path, head: list[str], axis: str) -> int:
    if head.count(axis) != 1:
        raise _wrong(file, "line 1", f"one column {axis}", ", ".join(head) or "nothing")
    return head.index(axis)


def _numbers(file: Path, line: int, row: list[str], columns: list[int], axes: Sequence[str]) -> list[float]:
    place = []
    for axis, column in zip(axes, columns, strict=True):
        word = row[column] if column < len(row) else ""
        try:
            value = float(word)
        except ValueError:
            value = np.nan
        if not np.isfinite(value):
            raise _wrong(file, f"line {line}, column {axis}", "a finite number, m", repr(word))
        place.append(value)
    return place


def _wrong(file: Path, place: str, expected: str, got: object) -> WrongSetting:
    return WrongSetting(f"cells points: {file}: {place}: expected {expected}, got {got}")
