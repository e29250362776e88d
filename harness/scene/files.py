"""Files that a scene is made of: text read safely, CSV tables checked cell by cell.

A scene may name files below its own folder and nowhere else, so that a scene from a stranger cannot
make the harness read what it should not, and a folder with its scene is complete.
"""

from __future__ import annotations

import csv
import io
import os
import stat
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

from harness.errors import InputError
from harness.scene.describe import nearest
from harness.scene.fault import Fault, number_fault, printable, shorten, show

LARGEST_TABLE = 200_000_000
"""Bytes of a CSV file."""


@dataclass(frozen=True, kw_only=True)
class Row:
    """One line of a table: its number in the file, and its cells as text by column."""

    line: int
    cells: dict[str, str]


def read_text(path: Path, *, what: str, largest: int) -> str:
    """Return the text of a regular UTF-8 file.

    Raises InputError when it is missing, a folder, a pipe, unreadable, too large or not UTF-8.
    """
    try:
        status = path.stat()
        fault = _status_fault(status, what, largest)
        raw = b"" if fault else path.read_bytes()
    except (OSError, ValueError) as error:
        reason = (getattr(error, "strerror", None) or str(error)).lower()
        raise Fault(place="", expected=what, got=reason, fix="check the name").error(path) from None
    fault = fault or _encoding_fault(raw)
    if fault:
        raise fault.error(path)
    return raw.decode("utf-8")


def name_fault(folder: Path, name: str, place: str) -> Fault | None:
    """Return why a file named in a scene is refused: only files below the scene's folder are read."""
    expected = "a file name below the scene's folder"
    if not name.strip() or not name.isprintable() or "\\" in name:
        return Fault(place=place, expected=expected, got=show(name), fix="use / and printable characters")
    if Path(name).is_absolute() or ".." in Path(name).parts:
        return Fault(place=place, expected=expected, got=show(name), fix="copy the file beside the scene")
    try:
        inside = (folder / name).resolve().is_relative_to(folder.resolve())
    except (OSError, RuntimeError):
        return Fault(place=place, expected=expected, got=f"{show(name)}, a circle of links")
    if inside:
        return None
    return Fault(
        place=place, expected=expected, got=f"{show(name)}, a link that leads out of it",
        fix="copy the file beside the scene",
    )


def read_table(path: Path, *, required: Sequence[str], optional: Sequence[str] = ()) -> list[Row]:
    """Return the rows of a CSV file with a header line; lines that begin with # are comments.

    Raises InputError, with the line, for unknown, missing or double columns and rows of wrong length.
    """
    text = read_text(path, what="a CSV file", largest=LARGEST_TABLE)
    try:
        lines = list(_data_lines(text))
    except csv.Error as error:
        raise Fault(place="", expected="a CSV file", got=f"an error: {error}").error(path) from None
    if len(lines) < 2:
        got = "no row of data" if lines else "an empty file"
        raise Fault(place="", expected=f"a header {','.join(required)} and rows", got=got).error(path)
    line, header = lines[0]
    fault = _header_fault(header, required, optional, line) or _length_fault(lines)
    if fault:
        raise fault.error(path)
    return [Row(line=line, cells=dict(zip(header, cells, strict=True))) for line, cells in lines[1:]]


def number(row: Row, column: str, path: Path) -> float:
    """Return a cell as a finite number. Raises InputError with the line."""
    text, place = row.cells[column], f"line {row.line}, column {column}"
    try:
        value = float(text)
    except ValueError:
        raise cell_error(row, column, path, "a number") from None
    fault = number_fault(value, place)
    if fault:
        raise fault.error(path)
    return value


def cell_error(row: Row, column: str, path: Path, expected: str) -> InputError:
    """Return the error that a cell is not what was expected."""
    place = f"line {row.line}, column {column}"
    return Fault(place=place, expected=expected, got=show(row.cells[column])).error(path)


def _status_fault(status: os.stat_result, what: str, largest: int) -> Fault | None:
    if stat.S_ISDIR(status.st_mode):
        return Fault(place="", expected=what, got="a folder", fix="name a file in it")
    if not stat.S_ISREG(status.st_mode):
        return Fault(place="", expected=what, got="something that is no regular file")
    if status.st_size > largest:
        return Fault(place="", expected=f"{what} of at most {largest} bytes", got=f"{status.st_size} bytes")
    return None


def _encoding_fault(raw: bytes) -> Fault | None:
    if raw.startswith(b"\xef\xbb\xbf"):
        return Fault(place="line 1", expected="UTF-8 text", got="a byte order mark", fix="save without it")
    try:
        raw.decode("utf-8")
    except UnicodeDecodeError as error:
        line = raw[: error.start].count(b"\n") + 1
        got = f"the byte 0x{raw[error.start]:02x}"
        return Fault(place=f"line {line}", expected="UTF-8 text", got=got, fix="save the file as UTF-8")
    return None


def _data_lines(text: str) -> Iterator[tuple[int, list[str]]]:
    reader = csv.reader(io.StringIO(text, newline=""), strict=True)
    for cells in reader:
        cells = [c.strip() for c in cells]
        if any(cells) and not cells[0].startswith("#"):
            yield reader.line_num, cells


def _header_fault(header: list[str], required: Sequence[str], optional: Sequence[str], line: int) -> Fault | None:
    known, place = [*required, *optional], f"line {line}"
    expected = f"the columns {','.join(required)}"
    missing = [c for c in required if c not in header]
    unknown = [c for c in header if c not in known]
    if unknown:
        fix = nearest(unknown[0], known) or (f"known besides: {','.join(optional)}" if optional else "")
        return Fault(place=place, expected=expected, got=f"the unknown column {show(unknown[0])}", fix=fix)
    if missing:
        return Fault(place=place, expected=expected, got=shorten(printable(",".join(header))),
                     fix=f"add the column {missing[0]}")
    double = next((c for c in header if header.count(c) > 1), None)
    return Fault(place=place, expected=expected, got=f"the column {double} twice") if double else None


def _length_fault(lines: list[tuple[int, list[str]]]) -> Fault | None:
    width = len(lines[0][1])
    for line, cells in lines[1:]:
        if len(cells) != width:
            return Fault(place=f"line {line}", expected=f"{width} cells", got=f"{len(cells)}")
    return None
