"""Measured contacts in a CSV file: a force-displacement cycle, pull-off against load, or hysteresis against force.

The header says which, with units: one of

    displacement (nm), force (nN)[, error (nN)]     one cycle in the order of time; compression positive
    load (nN), pull-off (nN)[, error (nN)]          pull-off positive; N or, over a length, N/m
    force (nN), hysteresis (nm)[, error (nm)]       displacement on the way back minus that on the way in
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from harness.errors import InputError
from harness.scene.fault import Fault, show
from harness.scene.files import LARGEST_TABLE, number, read_table, read_text

PREFIXES = {"": 1.0, "m": 1e-3, "u": 1e-6, "µ": 1e-6, "n": 1e-9, "p": 1e-12}
UNITS = {
    "length": {f"{p}m": f for p, f in PREFIXES.items()}, "force": {f"{p}N": f for p, f in PREFIXES.items()},
    "force over length": {f"{p}N/m": f for p, f in PREFIXES.items()},
}
"""Units by dimension: their size in SI."""

KINDS = {
    "cycle": ("displacement", "force"), "pull-off": ("load", "pull-off"), "hysteresis": ("force", "hysteresis"),
}
"""What a file can hold, by its columns."""

DIMENSIONS = {
    "displacement": ("length",), "hysteresis": ("length",), "force": ("force",), "load": ("force", "force over length"),
    "pull-off": ("force", "force over length"),
}

FEWEST = 4
"""Points on each way of a cycle, or of a line: one more than an unknown at least."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Cycle:
    """One approach and return: displacement (P,), m, and force (P,), N, in the order of time; error (P,), N, or None.

    The displacement counts from anywhere and rises with compression. turn: number of the point where it is largest.
    """

    displacement: np.ndarray
    force: np.ndarray
    error: np.ndarray | None

    @property
    def turn(self) -> int:
        """Number of the deepest point."""
        return int(np.argmax(self.displacement))

    @property
    def loading(self) -> np.ndarray:
        """(P,) whether a point is on the way in, the deepest one included."""
        return np.arange(len(self.force)) <= self.turn


@dataclass(frozen=True, kw_only=True, eq=False)
class Measurements:
    """A file's content in SI: kind as in KINDS, name of the file, x and y (P,), error (P,) of y or None."""

    kind: str
    name: str
    x: np.ndarray
    y: np.ndarray
    error: np.ndarray | None

    def cycle(self) -> Cycle:
        """Return the force-displacement cycle."""
        return Cycle(displacement=self.x, force=self.y, error=self.error)


def read_measurements(path: Path) -> Measurements:
    """Return the measurements in a CSV file.

    Raises InputError, with the line, for columns or units that are none of these, cells that are no numbers, errors
    that are not positive, and too few points.
    """
    header = _header(path)
    columns = {name: (cell, dimension, scale) for cell in header for name, dimension, scale in [_column(cell, path)]}
    kind = _kind(columns, header, path)
    rows = read_table(path, required=header)
    values = {name: scale * np.array([number(row, cell, path) for row in rows])
              for name, (cell, _, scale) in columns.items()}
    x, y = (values[name] for name in KINDS[kind])
    error = values.get("error")
    if error is not None and not (error > 0).all():
        line = rows[int(np.argmax(error <= 0))].line
        raise Fault(place=f"line {line}, column {columns['error'][0]}", expected="an error > 0",
                    got=f"{error.min():g}").error(path)
    found = Measurements(kind=kind, name=path.name, x=x, y=y, error=error)
    _require_points(found, path)
    return found


def _header(path: Path) -> list[str]:
    text = read_text(path, what="a CSV file of measurements", largest=LARGEST_TABLE)
    lines = (line.strip() for line in text.splitlines())
    first = next((line for line in lines if line and not line.startswith("#")), "")
    return [cell.strip() for cell in first.split(",")]


def _column(cell: str, path: Path) -> tuple[str, str, float]:
    """Return name, dimension and the unit's size in SI of a column."""
    found = re.fullmatch(r"([a-z-]+) \(([^)]+)\)", cell)
    name, unit = found.groups() if found else (cell, "")
    dimensions = DIMENSIONS.get(name, tuple(UNITS) if name == "error" else ())
    for dimension in dimensions:
        if unit in UNITS[dimension]:
            return name, dimension, UNITS[dimension][unit]
    raise _header_error(path, show(cell))


def _kind(columns: dict, header: Sequence[str], path: Path) -> str:
    for kind, names in KINDS.items():
        if set(columns) - {"error"} == set(names) and len(columns) == len(header):
            x, y = (columns[name][1] for name in names)
            if kind == "pull-off" and x != y:
                raise Fault(
                    place="header", expected="load and pull-off in units of one kind", got=show(",".join(header)),
                    fix="give both as forces or both as forces over a length",
                ).error(path)
            if "error" in columns and columns["error"][1] != y:
                raise Fault(
                    place="header", expected=f"the error in a unit of {y}", got=show(columns["error"][0]),
                ).error(path)
            return kind
    raise _header_error(path, show(",".join(header)))


def _header_error(path: Path, got: str) -> InputError:
    expected = "; or ".join(f"{x} ({ux}),{y} ({uy})" for (x, y), (ux, uy) in zip(
        KINDS.values(), (("nm", "nN"), ("nN", "nN"), ("nN", "nm")), strict=True))
    return Fault(place="header", expected=expected, got=got,
                 fix="units m, mm, um, nm; N, mN, uN, nN, pN; N/m, mN/m; error (unit) besides").error(path)


def _require_points(found: Measurements, path: Path) -> None:
    if found.kind != "cycle":
        if len(found.x) < FEWEST or np.ptp(found.x) == 0:
            raise Fault(place="", expected=f"at least {FEWEST} points at different {KINDS[found.kind][0]}s",
                        got=f"{len(found.x)}").error(path)
        return
    cycle = found.cycle()
    ways = (int(cycle.loading.sum()), int((~cycle.loading).sum()))
    if min(ways) < FEWEST:
        raise Fault(
            place="", expected=f"a way in and a way back of at least {FEWEST} points each, in the order of time",
            got=f"{ways[0]} points up to the largest displacement and {ways[1]} behind it",
        ).error(path)
