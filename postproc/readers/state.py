"""The neutral state file: one state of any code, in HDF5, JSON or CSV; the column names of `Snapshot`.

HDF5 (``.h5``, ``.hdf5``)
    groups particles, contacts, walls with one dataset a column; attributes on the root.
JSON (``.json``)
    ``{"attributes": {...}, "particles": {"id": [...], ...}, "contacts": {...}, "walls": {...}}``
CSV
    ``NAME.particles.csv``, and if there are any ``NAME.contacts.csv``, ``NAME.walls.csv``,
    ``NAME.attributes.json``; a header line, then numbers. Named by ``NAME`` or by the particles file.

Groups contacts and walls are optional: left out means not recorded, empty means there are none.
Attributes, all optional: ``dimension`` (default: 3 with a column z, else 2), ``thickness`` (1 m),
``time`` (NaN: not known), ``periodic`` (one boolean an axis), ``box`` (one [lower, upper] an axis;
default: what axis-aligned walls enclose). Other columns are not read; other groups and attributes are refused,
since a misspelt ``box`` or ``thickness`` would be passed over without a word.
Normals of walls are brought to length 1; one of length 0 is refused.
``null`` in JSON and an empty field in CSV are NaN, allowed in ux, uy, uz of contacts, and in the normal, radius and
torque of walls (a ring has no normal, a flat wall no radius).

A run's ``trajectory.h5`` is accepted wherever a state is, with a frame number.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np

from postproc.readers.check import check_places, check_snapshot, wrong
from postproc.readers.state_formats import ATTRIBUTES, RawState, format_of
from postproc.readers.walls import box_from_walls
from postproc.snapshot import Columns, Snapshot
from postproc.trajectory import GROUPS, ReadError, Trajectory, read_trajectory

ROUNDING = 1e-15
"""A normal whose length differs from 1 by less is left as it stands, bit for bit."""


def read_state(path: Path, *, frame: int | None = None) -> Snapshot:
    """Read one state. Raises ReadError: file, place, what was expected, what came.

    frame: which frame of a trajectory, from 0; default the last.
    Not for files that hold a single state.
    """
    path = Path(path)
    if holds_trajectory(path):
        trajectory = read_trajectory(path)
        k = _frame_number(path, trajectory, frame)
        return check_snapshot(path, trajectory.frames[k], f"frame {k}: ")
    if frame is not None:
        raise wrong(path, "frame", "a trajectory, which has frames", "a single state")
    return check_places(path, check_snapshot(path, _snapshot(path, format_of(path).read(path))))


def write_state(path: Path, snapshot: Snapshot) -> None:
    """Write one state in the format that the name of `path` says; reading it back gives equal bits.

    Each file is written beside its place and renamed. ValueError when the name says no format.
    """
    path = Path(path)
    attributes = {"dimension": snapshot.dimension, "thickness": snapshot.thickness}
    if np.isfinite(snapshot.time):
        attributes["time"] = snapshot.time
    if snapshot.periodic is not None:
        attributes["periodic"] = [bool(p) for p in snapshot.periodic]
    if snapshot.box is not None:
        attributes["box"] = np.asarray(snapshot.box, dtype=np.float64).tolist()
    tables = {g: getattr(snapshot, g) for g in GROUPS}
    groups = {g: dict(table) for g, table in tables.items() if table is not None}
    format_of(path).write(path, RawState(groups=groups, attributes=attributes))


def holds_trajectory(path: Path) -> bool:
    """Tell a ``trajectory.h5`` from other files; a file that cannot be opened is none."""
    import h5py

    try:
        with h5py.File(path, "r") as f:
            return "frames" in f
    except OSError:
        return False


def _frame_number(path: Path, trajectory: Trajectory, frame: int | None) -> int:
    count = len(trajectory)
    if frame is None and count:
        return count - 1
    if frame is None or not 0 <= frame < count:
        raise wrong(path, "frame", f"a number from 0 to {count - 1} in a trajectory of {count}", frame)
    return frame


def _snapshot(path: Path, raw: RawState) -> Snapshot:
    for name in raw.attributes:
        if name not in ATTRIBUTES:
            raise wrong(path, "attributes", f"only {', '.join(ATTRIBUTES)}", f"the unknown {name!r}")
    if "particles" not in raw.groups:
        raise wrong(path, "particles", "a group of columns", "none")
    dimension = _dimension(path, raw)
    tables = {g: _table(path, g, raw.groups[g], dimension) for g in GROUPS if g in raw.groups}
    if "walls" in tables:
        tables["walls"] = _with_unit_normals(tables["walls"], dimension)
    box = _array(path, raw, "box", (dimension, 2), "iuf", "one [lower, upper] an axis, numbers")
    periodic = _array(path, raw, "periodic", (dimension,), "b", "one boolean an axis")
    return Snapshot(
        dimension=dimension,
        time=_number(path, raw, "time", np.nan),
        thickness=_thickness(path, raw),
        periodic=None if periodic is None else tuple(bool(p) for p in periodic),
        box=box_from_walls(tables.get("walls"), dimension) if box is None else box.astype(np.float64),
        **tables,
    )


def _with_unit_normals(walls: Columns, dimension: int) -> Columns:
    """Normals in decimals are of length 1 nearly, in whole numbers of any; one of length 0 is left to be refused."""
    names = ["n" + axis for axis in "xyz"[:dimension]]
    if not all(name in walls for name in names):
        return walls
    length = np.linalg.norm(walls.vector(*names), axis=1)
    scale = np.where((length > 0) & (np.abs(length - 1.0) > ROUNDING), length, 1.0)
    return Columns({**walls, **{name: walls[name] / scale for name in names}}, "walls")


def _dimension(path: Path, raw: RawState) -> int:
    found = 3 if "z" in raw.groups["particles"] else 2
    dimension = _number(path, raw, "dimension", found)
    if dimension not in (2, 3):
        raise wrong(path, "attributes.dimension", "2 or 3", raw.attributes["dimension"])
    if dimension < found and np.ptp(_column(path, "particles.z", raw.groups["particles"]["z"])) != 0:
        raise wrong(path, "particles.z", "one value, as the dimension is 2", "several")
    return int(dimension)


def _thickness(path: Path, raw: RawState) -> float:
    thickness = _number(path, raw, "thickness", 1.0)
    if not 0 < thickness < np.inf:
        raise wrong(path, "attributes.thickness", "a number > 0", raw.attributes["thickness"])
    return thickness


def _number(path: Path, raw: RawState, name: str, default: float) -> float:
    value = _array(path, raw, name, (), "iuf", "a number")
    return default if value is None else float(value)


def _array(
    path: Path, raw: RawState, name: str, shape: tuple[int, ...], kinds: str, expected: str
) -> np.ndarray | None:
    """Return an attribute as an array of this shape and kind of number, None when it is absent."""
    if raw.attributes.get(name) is None:
        return None
    try:
        value = np.asarray(raw.attributes[name])
    except ValueError:  # lists of unequal length
        value = np.asarray(None)
    if value.shape != shape or value.dtype.kind not in kinds:
        raise wrong(path, f"attributes.{name}", expected, raw.attributes[name])
    return value


def column_names(group: str, dimension: int) -> tuple[tuple[str, ...], tuple[str, ...]]:
    """Return (required, optional) column names of a group in this dimension."""
    axes = "xyz"[:dimension]
    turns = "z" if dimension == 2 else "xyz"

    def vector(letter: str, components: str = axes) -> tuple[str, ...]:
        return tuple(letter + a for a in components)

    return {
        "particles": (
            ("id", *axes, "radius"),
            ("mass", *vector("v"), *vector("w", turns), "inertia", *(("rotation",) if dimension == 2 else ())),
        ),
        "contacts": (
            ("i", "j", *vector("p"), *vector("f")),
            (*vector("m", turns), *vector("u"), "overlap", "kn", "kt"),
        ),
        "walls": (
            ("id", *vector("p"), *vector("f")),
            (*vector("n"), "radius", "torque"),
        ),
    }[group]


def _table(path: Path, group: str, raw: dict, dimension: int) -> Columns:
    required, optional = column_names(group, dimension)
    for name in required:
        if name not in raw:
            raise wrong(path, group, f"a column {name}", f"only {', '.join(raw) or 'none'}")
    table = {n: _column(path, f"{group}.{n}", raw[n]) for n in (*required, *optional) if n in raw}
    rows = len(table[required[0]])
    for name, values in table.items():
        if len(values) != rows:
            raise wrong(path, f"{group}.{name}", f"{rows} values like {required[0]}", len(values))
    return Columns(table, group)


def _column(path: Path, place: str, values: object) -> np.ndarray:
    if isinstance(values, list):
        values = [np.nan if v is None else v for v in values]
    try:
        array = np.asarray(values)
    except ValueError:  # lists of unequal length
        array = np.asarray(None)
    if array.ndim != 1 or array.dtype.kind not in "iuf":
        raise wrong(path, place, "a list of numbers", f"{array.dtype} of shape {array.shape}")
    return array.astype(np.float64)


__all__ = ["ReadError", "column_names", "holds_trajectory", "read_state", "write_state"]
