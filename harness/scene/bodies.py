"""Particles that stand in CSV files beside the scene."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from harness.scene.fault import Fault
from harness.scene.files import Row, cell_error, name_fault, number, read_table
from harness.scene.model import Body
from harness.scene.system import INERTIA_FACTOR
from harness.scene.tables import WORD


def read_bodies(path: Path, dimension: int) -> tuple[tuple[Body, ...], list[int]]:
    """Return the particles of a `bodies_file` and the line of each.

    Columns x,y[,z],radius,mass in SI units; optionally vx,vy[,vz], the spin wz in 2D or wx,wy,wz in
    3D, inertia (a name or the factor q of I = q m a^2; "sphere" without the column) and material (a word of
    `contact.between`; an empty cell is none).

    Raises InputError with the line of what is wrong.
    """
    axes = "xyz"[:dimension]
    velocity, spin = [f"v{a}" for a in axes], [f"w{a}" for a in ("z" if dimension == 2 else "xyz")]
    rows = read_table(path, required=[*axes, "radius", "mass"], optional=[*velocity, *spin, "inertia", "material"])
    for group in (velocity, spin):
        _whole_or_absent(group, rows[0], path)
    return tuple(_body(row, axes, velocity, spin, path) for row in rows), [row.line for row in rows]


def read_packing_file(folder: Path, name: str) -> tuple[np.ndarray, np.ndarray]:
    """Return centres x (N, 2) and radius (N,) in m of a packing file `id,x,y,radius`, in order of id.

    Raises InputError with the line of what is wrong; ids are 1..N, each once.
    """
    fault = name_fault(Path(folder), name, "particles.packing")
    path = Path(folder) / name
    if fault:
        raise fault.error(path.name)
    rows = read_table(path, required=["id", "x", "y", "radius"])
    order = _order_of_ids(rows, path)
    x = np.array([[number(row, c, path) for c in ("x", "y")] for row in rows])
    radius = np.array([_positive(row, "radius", path) for row in rows])
    return x[order], radius[order]


def _order_of_ids(rows: list[Row], path: Path) -> np.ndarray:
    lines: dict[int, int] = {}
    for row in rows:
        value = number(row, "id", path)
        if value != int(value) or not 1 <= value <= len(rows):
            raise cell_error(row, "id", path, f"an integer from 1 to {len(rows)}, the number of rows")
        if value in lines:
            raise cell_error(row, "id", path, f"an id of its own (line {lines[value]} has it)")
        lines[int(value)] = row.line
    return np.argsort([number(row, "id", path) for row in rows])


def _body(row: Row, axes: str, velocity: list[str], spin: list[str], path: Path) -> Body:
    def vector(columns) -> tuple[float, ...] | None:
        return tuple(number(row, c, path) for c in columns) if columns[0] in row.cells else None

    return Body(
        position=vector(axes), radius=_positive(row, "radius", path), mass=_positive(row, "mass", path),
        velocity=vector(velocity), spin=vector(spin), inertia=_inertia(row, path),
        material=_material(row, path),
    )


def _positive(row: Row, column: str, path: Path) -> float:
    value = number(row, column, path)
    if value <= 0:
        raise cell_error(row, column, path, "a number > 0")
    return value


def _inertia(row: Row, path: Path) -> str | float:
    text = row.cells.get("inertia", "sphere")
    if text in INERTIA_FACTOR:
        return text
    try:
        factor = float(text)
    except ValueError:
        factor = 0.0
    if not 1e-30 <= factor <= 1:
        raise cell_error(row, "inertia", path, '"sphere", "disc", "ring" or a number > 0 and <= 1')
    return factor


def _material(row: Row, path: Path) -> str | None:
    word = row.cells.get("material", "")
    if word and not WORD.fullmatch(word):
        raise cell_error(row, "material", path, "a material: a word as in the scene's contact.between")
    return word or None


def _whole_or_absent(columns: list[str], row: Row, path: Path) -> None:
    given = [c for c in columns if c in row.cells]
    if 0 < len(given) < len(columns):
        missing = next(c for c in columns if c not in given)
        raise Fault(
            place="header", expected=f"all of {','.join(columns)} or none", got=",".join(given),
            fix=f"add the column {missing}",
        ).error(path)
