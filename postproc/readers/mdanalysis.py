"""Second reader of LAMMPS and LIGGGHTS atom dumps, through MDAnalysis: it must agree with our own.

MDAnalysis keeps positions, velocities and forces as float32 and shifts positions by the origin of
the simulation box (2.11), which spoils overlaps: at an overlap of 1e-4 diameters in a box of 100
diameters by per cents. Asked for as `additional_columns` the same numbers arrive in float64 as
they stand in the file. Contacts ("local" dumps) it does not read.
"""

from __future__ import annotations

import warnings
from collections.abc import Sequence
from pathlib import Path

from postproc.readers.check import wrong
from postproc.snapshot import Columns

COLUMNS = ("id", "x", "y", "z", "vx", "vy", "vz", "radius")


def read_with_mdanalysis(path: Path, columns: Sequence[str] = COLUMNS) -> list[tuple[int, Columns]]:
    """Read all frames of an atom dump as (step, columns), float64, rows sorted by id.

    columns: names as in the file's header, which must have ``id``; a 2D dump needs no z. Raises
    ReadError when MDAnalysis cannot read the file, the number of particles changes, or a column is
    not there.
    """
    path = Path(path)
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # of absent columns, which are an error here
            frames = _read(path, columns)
    except (OSError, ValueError, IndexError, TypeError, EOFError, StopIteration) as error:
        raise wrong(path, "file", "an atom dump that MDAnalysis reads", repr(error)) from error
    begun = path.read_bytes().count(b"ITEM: TIMESTEP")
    if begun != len(frames):  # MDAnalysis drops a last frame that is cut short without a word
        raise wrong(path, "file", f"{begun} whole frames, as many as it begins", len(frames))
    return frames


def _read(path: Path, columns: Sequence[str]) -> list[tuple[int, Columns]]:
    with _reader_class()(str(path), additional_columns=list(columns), dt=1.0) as reader:
        return [(step.data["step"], _columns(path, step, columns)) for step in reader]


def _reader_class() -> type:
    """MDAnalysis' own reader, kept from making its float32 positions.

    It insists on three coordinates, which 2D dumps do not have; what it takes for positions is not
    used here, so it may take any column.
    """
    from MDAnalysis.coordinates.LAMMPS import DumpReader

    class Float64Columns(DumpReader):
        _coordtype_column_names = {"unscaled": ["id", "id", "id"]}

    return Float64Columns


def _columns(path: Path, step, columns: Sequence[str]) -> Columns:
    for name in columns:
        if name not in step.data:
            raise wrong(path, f"step {step.data['step']}", f"a column {name}", "none")
    return Columns({name: step.data[name] for name in columns}, "atoms")
