"""Text dumps of the LAMMPS family (`ITEM: ...` blocks) and `#`-headed tables, in float64.

Both LAMMPS and LIGGGHTS write them: particles as ``ITEM: ATOMS id x ...``, contacts ("local" data)
as ``ITEM: ENTRIES c_p[1] ...``, and time series (`fix ave/time`, `fix print`) as whitespace tables
below `#` lines. Nothing is believed: a row with a number too few, a NaN, a word that is no number,
a file cut short, all raise ReadError with file and line.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import msgspec
import numpy as np

from postproc.snapshot import Columns
from postproc.trajectory import ReadError

NEWLINE, SPACE, COMMA, MINUS, ZERO = b"\n ,-0"

COMMAS, NUMBERS = bytes.maketrans(b" \n", b",,"), msgspec.json.Decoder(list[float])
"""What makes a list of JSON of rows of numbers with one blank between two, and what reads it."""


def read_dump(path: Path, *, kind: str, names: Mapping[str, str] | None = None) -> list[tuple[int, Columns]]:
    """Read all frames of a text dump as (step, columns), in the file's order.

    kind: "ATOMS" or "ENTRIES", the word of the data block. names: column in the file -> name wanted;
    columns it does not list are dropped, a listed one that is missing is an error. Without it all
    columns keep their names.

    Raises ReadError (file, line) when the file is missing, empty, cut short, not finite, not a
    number, or its steps do not increase.
    """
    data = _read_bytes(path)
    frames: list[tuple[int, Columns]] = []
    position, line = 0, 1
    while position < len(data):
        head = _read_head(path, data, position, line, kind)
        if frames and head.step <= frames[-1][0]:
            raise ReadError(f"{path}: line {line}: step {head.step} follows step {frames[-1][0]}")
        end = _end_of_rows(path, data, head)
        table = _numbers(path, data[head.start : end], head.line, len(head.columns))
        frames.append((head.step, _named(path, table, head.columns, names, kind)))
        position, line = end, head.line + head.rows
    if not frames:
        raise ReadError(f"{path}: holds no frame")
    return frames


def read_table(path: Path, *, names: Sequence[str] | None = None) -> Columns:
    """Read a whitespace table whose last leading `#` line names the columns.

    names: the columns of a table whose first line is a heading without `#`, which is not believed
    (LIGGGHTS cuts its words to eight letters).
    Raises ReadError (file, line) when it has no heading, no row, or a damaged row.
    """
    data = _read_bytes(path)
    start, line, header = 0, 1, None
    while data.startswith(b"#", start) or (names is not None and start == 0):
        end = data.find(b"\n", start)
        if end < 0:
            raise ReadError(f"{path}: line {line}: cut short in its header")
        header = data[start:end].decode("ascii", errors="replace").lstrip("#").split()
        start, line = end + 1, line + 1
    if not header:
        raise ReadError(f"{path}: line 1: expected a '#' line that names the columns")
    if start == len(data):
        raise ReadError(f"{path}: holds no row")
    if not data.endswith(b"\n"):
        raise ReadError(f"{path}: line {line + data.count(10, start)}: cut short")
    columns = header if names is None else list(names)
    table = _numbers(path, data[start:], line, len(columns))
    return Columns(dict(zip(columns, table.T, strict=True)), "table")


@dataclass(frozen=True, kw_only=True)
class _Head:
    """One frame's header: where its rows start (byte, line number), how many, their columns."""

    step: int
    rows: int
    columns: list[str]
    start: int
    line: int


def _read_bytes(path: Path) -> bytes:
    try:
        data = Path(path).read_bytes()
    except OSError as error:
        raise ReadError(f"{path}: {error.strerror or error}") from error
    if not data:
        raise ReadError(f"{path}: is empty")
    return data


def _read_head(path: Path, data: bytes, position: int, line: int, kind: str) -> _Head:
    """Read `ITEM:` blocks up to and including the one named `kind`."""
    found: dict[str, int] = {}
    counter = {"TIMESTEP": "step", "NUMBER OF ATOMS": "rows", "NUMBER OF ENTRIES": "rows"}
    while True:
        item, position, line = _next_line(path, data, position, line)
        if not item.startswith("ITEM: "):
            raise ReadError(f"{path}: line {line - 1}: expected 'ITEM: ...', got {item[:40]!r}")
        word = item[6:].strip()
        if word.split(" ")[0] == kind:
            break
        if word in counter:
            value, position, line = _next_line(path, data, position, line)
            found[counter[word]] = _count(path, value, line - 1)
        else:
            position, line = _skip_values(path, data, position, line)
    if set(found) != {"step", "rows"}:
        raise ReadError(f"{path}: line {line - 1}: {kind} without a time step and a number of rows")
    return _Head(**found, columns=word.split()[1:], start=position, line=line)


def _skip_values(path: Path, data: bytes, position: int, line: int) -> tuple[int, int]:
    """Step over the values of an item that is not needed (UNITS, TIME, BOX BOUNDS)."""
    while not data.startswith(b"ITEM:", position):
        _, position, line = _next_line(path, data, position, line)
    return position, line


def _next_line(path: Path, data: bytes, position: int, line: int) -> tuple[str, int, int]:
    end = data.find(b"\n", position)
    if end < 0:
        raise ReadError(f"{path}: line {line}: cut short in a header")
    return data[position:end].decode("ascii", errors="replace"), end + 1, line + 1


def _count(path: Path, text: str, line: int) -> int:
    if not text.strip().isdigit():
        raise ReadError(f"{path}: line {line}: expected a whole number, got {text[:40]!r}")
    return int(text)


def _end_of_rows(path: Path, data: bytes, head: _Head) -> int:
    """Return the byte behind the frame's last row: the next header, or the end of the file."""
    end = data.find(b"ITEM: TIMESTEP", head.start)
    end = len(data) if end < 0 else end
    present = data.count(NEWLINE, head.start, end)
    if present != head.rows or data[head.start : end][-1:] not in (b"\n", b""):
        raise ReadError(
            f"{path}: line {head.line + present}: step {head.step} is cut short:"
            f" {head.rows} rows announced, {present} whole rows there"
        )
    return end


def _numbers(path: Path, block: bytes, line: int, columns: int) -> np.ndarray:
    """Turn whole text lines into an array (rows, columns); `line` is the first line's number."""
    if not block:
        return np.empty((0, columns))
    width = _words_per_line(block)
    if np.any(width != columns):
        k = int(np.argmax(width != columns))
        raise ReadError(f"{path}: line {line + k}: expected {columns} numbers, got {width[k]} words")
    table = _parsed(block)
    if table.size != len(width) * columns or not np.isfinite(table).all():
        _blame(path, block, line)
    return table.reshape(-1, columns)


def _parsed(block: bytes) -> np.ndarray:
    """Return the numbers of a text, too few of them or none where a word is no number.

    Numbers of 17 digits are read as JSON, to the same bits as by the C library in a third of the time (method: D.
    Lemire, Softw. Pract. Exp. 51, 1700 (2021), doi 10.1002/spe.2984); what JSON does not allow is left to NumPy.
    """
    rows = block.replace(b" \n", b"\n") if block[block.find(b"\n") - 1] == SPACE else block
    text = b"[" + rows.rstrip().translate(COMMAS) + b"]"
    try:
        return _signed(np.fromiter(NUMBERS.decode(text), np.float64), text)
    except msgspec.MsgspecError:
        pass
    try:
        return np.fromstring(block.decode("ascii", errors="replace"), dtype=np.float64, sep=" ")
    except ValueError:
        return np.empty(0)


def _signed(values: np.ndarray, text: bytes) -> np.ndarray:
    """Give every -0 its sign, which a whole number of JSON does not have. text: with a sign before and behind each."""
    t = np.frombuffer(text, np.uint8)
    bounds = np.flatnonzero((t == COMMA) | (t == t[0]) | (t == t[-1]))
    two = np.flatnonzero(np.diff(bounds) == 3)
    first = bounds[two] + 1
    values[two[(t[first] == MINUS) & (t[first + 1] == ZERO)]] = -0.0
    return values


def _words_per_line(block: bytes) -> np.ndarray:
    """Count the words of every line at once; a word begins where ink follows blank."""
    text = np.frombuffer(block, np.uint8)
    ink = text > SPACE
    ink[1:] &= ~ink[:-1]
    ends = np.flatnonzero(text == NEWLINE)
    return np.add.reduceat(ink, np.concatenate([[0], ends[:-1] + 1]), dtype=np.int64)


def _blame(path: Path, block: bytes, line: int) -> None:
    """Find the word that is no finite number and say where it stands."""
    for k, row in enumerate(block.decode("ascii", errors="replace").splitlines()):
        for word in row.split():
            if not _is_finite(word):
                raise ReadError(f"{path}: line {line + k}: expected a finite number, got {word[:40]!r}")
    raise ReadError(f"{path}: line {line}: cannot be read as numbers")


def _is_finite(word: str) -> bool:
    try:
        return bool(np.isfinite(float(word)))
    except ValueError:
        return False


def _named(
    path: Path, table: np.ndarray, columns: list[str], names: Mapping[str, str] | None, kind: str
) -> Columns:
    names = {c: c for c in columns} if names is None else names
    missing = [c for c in names if c not in columns]
    if missing:
        raise ReadError(f"{path}: has no column {missing[0]!r}; it has {' '.join(columns)}")
    return Columns({names[c]: table[:, columns.index(c)] for c in names}, kind.lower())
