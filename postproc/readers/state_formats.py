"""The three spellings of a neutral state: HDF5 groups, JSON objects, CSV files with one name.

Each format reads a file into columns and attributes as they stand there and writes them back; what
they mean and whether they make sense is `postproc.readers.state`'s business.
"""

from __future__ import annotations

import csv
import json
import os
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from postproc.readers.check import wrong
from postproc.trajectory import GROUPS

CSV_PARTICLES = ".particles.csv"

ATTRIBUTES = ("dimension", "thickness", "time", "periodic", "box")
"""What a state may say about itself."""


@dataclass(frozen=True, kw_only=True)
class RawState:
    """Columns by group and name, and attributes, as found in a file."""

    groups: Mapping[str, dict]
    attributes: Mapping[str, object]


@dataclass(frozen=True, kw_only=True)
class Format:
    """How one format is read (raises ReadError) and written."""

    read: Callable[[Path], RawState]
    write: Callable[[Path, RawState], None]


def format_of(path: Path) -> Format:
    """Return the format by the file's name; anything that is not HDF5 or JSON is the NAME of CSV files."""
    return {".h5": HDF5, ".hdf5": HDF5, ".json": JSON}.get(path.suffix.lower(), CSV)


def files_of(path: Path) -> tuple[Path, ...]:
    """Return the files that a state of this name is read from, whether they exist or not."""
    if format_of(path) is not CSV or not path.name:
        return (path,)
    return (*(csv_file(path, group) for group in GROUPS), _attributes_file(path))


def _read_hdf5(path: Path) -> RawState:
    import h5py

    try:
        with h5py.File(path, "r") as f:
            _refuse_unknown(path, f, GROUPS, "make it an attribute of the file")
            groups = {g: {name: f[g][name][()] for name in f[g]} for g in GROUPS if g in f}
            return RawState(groups=groups, attributes=dict(f.attrs))
    except FileNotFoundError:
        raise wrong(path, "file", "an HDF5 file", "none of this name") from None
    except (OSError, RuntimeError, KeyError, TypeError, ValueError) as error:
        raise wrong(path, "file", "a whole HDF5 file with groups of datasets", error) from error


def _write_hdf5(path: Path, raw: RawState) -> None:
    import h5py

    def write(part: Path) -> None:
        with h5py.File(part, "w") as f:
            f.attrs.update(raw.attributes)
            for group, columns in raw.groups.items():
                f.create_group(group)
                for name, values in columns.items():
                    f[f"{group}/{name}"] = values

    _replace(path, write)


def _read_json(path: Path) -> RawState:
    data = _load_json(path)
    _refuse_unknown(path, data, (*GROUPS, "attributes"), "move it into attributes")
    tables = {g: data[g] for g in GROUPS if g in data}
    for name, table in {**tables, "attributes": data.get("attributes", {})}.items():
        if not isinstance(table, dict):
            raise wrong(path, name, "an object", type(table).__name__)
    return RawState(groups=tables, attributes=data.get("attributes", {}))


def _refuse_unknown(path: Path, found: Iterable[str], known: Sequence[str], fix: str) -> None:
    """Raise ReadError for what would be passed over; `fix` is said of an attribute that stands where groups do."""
    for name in found:
        if name not in known:
            got = f"the unknown {name!r}" + (f"; {fix}" if name in ATTRIBUTES else "")
            raise wrong(path, "top level", f"only {', '.join(known)}", got)


def _load_json(path: Path) -> dict:
    try:
        data = json.loads(path.read_text(encoding="utf-8-sig"))
    except json.JSONDecodeError as error:
        raise wrong(path, f"line {error.lineno} column {error.colno}", "JSON", error.msg) from error
    except (OSError, UnicodeDecodeError) as error:
        raise wrong(path, "file", "a readable JSON file", error) from error
    if not isinstance(data, dict):
        raise wrong(path, "file", "a JSON object", type(data).__name__)
    return data


def _write_json(path: Path, raw: RawState) -> None:
    tables = {g: {n: _with_null(v) for n, v in columns.items()} for g, columns in raw.groups.items()}
    text = json.dumps({"attributes": raw.attributes, **tables}, indent=1)
    _replace(path, lambda part: part.write_text(text + "\n", encoding="utf-8"))


def _with_null(values: np.ndarray) -> list[float | None]:
    return [v if v == v else None for v in values.tolist()]


def _read_csv(path: Path) -> RawState:
    if not path.name or not csv_file(path, "particles").exists():
        expected = f"an HDF5 or JSON state, or the NAME of a NAME{CSV_PARTICLES}"
        raise wrong(path, "file", expected, "a folder" if path.is_dir() else "none of them")
    files = {g: csv_file(path, g) for g in GROUPS}
    attributes = _attributes_file(path)
    return RawState(
        groups={g: read_csv_table(file) for g, file in files.items() if file.exists()},
        attributes=_load_json(attributes) if attributes.exists() else {},
    )


def read_csv_table(path: Path) -> dict[str, list[float]]:
    """Read a header line and rows of numbers; an empty field is NaN. ReadError names row and column."""
    try:
        with open(path, newline="", encoding="utf-8-sig") as f:  # Excel begins files with a BOM
            lines = [line for line in csv.reader(f) if line]
    except (OSError, UnicodeDecodeError, csv.Error) as error:
        raise wrong(path, "file", "a readable CSV file", error) from error
    if not lines:
        raise wrong(path, "line 1", "a line of column names", "an empty file")
    names = [name.strip() for name in lines[0]]
    if len(set(names)) < len(names):
        raise wrong(path, "line 1", "every column name once", ", ".join(names))
    rows = [_numbers(path, number, line, names) for number, line in enumerate(lines[1:], start=1)]
    return {name: [row[k] for row in rows] for k, name in enumerate(names)}


def _numbers(path: Path, row: int, line: list[str], names: list[str]) -> list[float]:
    if len(line) != len(names):
        raise wrong(path, f"row {row}", f"{len(names)} fields", len(line))
    numbers = []
    for name, text in zip(names, line, strict=True):
        try:
            numbers.append(float(text) if text.strip() else float("nan"))
        except ValueError:
            raise wrong(path, f"row {row}, column {name}", "a number", repr(text[:40])) from None
    return numbers


def _write_csv(path: Path, raw: RawState) -> None:
    for group in GROUPS:
        file = csv_file(path, group)
        if group in raw.groups:
            text = _csv_text(raw.groups[group])
            _replace(file, lambda part, text=text: part.write_text(text, encoding="utf-8"))
        else:
            file.unlink(missing_ok=True)  # left by an earlier state of this name
    attributes = json.dumps(raw.attributes, indent=1)
    _replace(_attributes_file(path), lambda part: part.write_text(attributes + "\n", encoding="utf-8"))


def _csv_text(columns: Mapping) -> str:
    rows = zip(*(values.tolist() for values in columns.values()), strict=True)
    lines = [",".join("" if v != v else f"{v:.17g}" for v in row) for row in rows]
    return "\n".join([",".join(columns), *lines]) + "\n"


def csv_file(path: Path, group: str) -> Path:
    """Return the CSV file of a group, from NAME or NAME.particles.csv."""
    return path.with_name(f"{path.name.removesuffix(CSV_PARTICLES)}.{group}.csv")


def _attributes_file(path: Path) -> Path:
    return path.with_name(f"{path.name.removesuffix(CSV_PARTICLES)}.attributes.json")


def _replace(path: Path, write: Callable[[Path], object]) -> None:
    part = path.with_name(path.name + ".part")
    write(part)
    os.replace(part, path)


HDF5 = Format(read=_read_hdf5, write=_write_hdf5)
JSON = Format(read=_read_json, write=_write_json)
CSV = Format(read=_read_csv, write=_write_csv)
