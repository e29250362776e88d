"""The post-processor's front door: one state in, all its averages out; also as a command.

From Python::

    averages = average(read_state("state.h5"), cells="inner", margin=4e-3)
    averages["stress"]            # (1, 2, 2), or MissingColumn with the reason

From a shell::

    python -m postproc STATE [--cells box|inner|particles] [--frame K] [--out DIR] [--json FILE|-] ...

`main` takes the same words as a list, so that another command can hand its arguments on.
"""

from __future__ import annotations

import argparse
import os
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import NoReturn

from postproc.averaging.registry import CELLS, WrongSetting, make_cells
from postproc.fields import IN_CELLS, OF_STATE, Subject
from postproc.macro.coordination import MINIMUM_CONTACTS
from postproc.results import Averages
from postproc.snapshot import Snapshot
from postproc.trajectory import ReadError

DONE, INPUT_WRONG = 0, 2


def average(
    snapshot: Snapshot,
    *,
    cells: str = "box",
    margin: float | None = None,
    minimum_contacts: int = MINIMUM_CONTACTS,
    kn: float | None = None,
    kt: float | None = None,
    reference: Snapshot | None = None,
    rate: float | None = None,
    gravity: Sequence[float] | None = None,
) -> Averages:
    """Average a state over cells; what the state cannot give is unavailable, with the reason.

    Parameters
    ----------
    cells: "box" (whole box), "inner" (without a border layer) or "particles" (each one a cell).
    margin: width of the border layer of "inner", m; default two mean diameters.
    minimum_contacts: a particle with fewer is a rattler; 3 (2D) or 4 (3D) without friction.
    kn, kt: stiffnesses of linear springs, N/m, if the contacts have no columns of that name.
    reference: state that the strain of the box is measured from.
    rate: strain rate for the inertial number, 1/s.
    gravity: (dim,), m/s^2, counted in the balance of forces.

    Raises WrongSetting (a ValueError) for unknown cells, a margin for cells that have none, or a
    gravity of another dimension.
    """
    if gravity is not None and len(gravity) != snapshot.dimension:
        raise WrongSetting(f"gravity: expected {snapshot.dimension} components, got {len(gravity)}")
    subject = Subject(
        cells=make_cells(cells, snapshot, margin=margin),
        minimum_contacts=minimum_contacts,
        kn=kn,
        kt=kt,
        reference=reference,
        rate=rate,
        gravity=None if gravity is None else tuple(gravity),
    )
    return Averages(
        time=snapshot.time,
        dimension=snapshot.dimension,
        per_thickness=snapshot.per_thickness,
        particles=snapshot.particles.rows,
        cells=cells,
        labels=subject.cells.labels,
        in_cells={field.name: field.evaluate(subject) for field in IN_CELLS},
        of_state={field.name: field.evaluate(subject) for field in OF_STATE},
    )


def main(arguments: Sequence[str] | None = None, *, prog: str = "python -m postproc") -> int:
    """Run the command; return 0, or 2 when the input is wrong (one line on standard error)."""
    words = _parser(prog).parse_args(arguments)
    try:
        _check_places(words)
        _deliver(_average_file(words), words)
    except (ReadError, WrongSetting) as error:
        return _complain(f"{prog}: {error}")
    except OSError as error:
        return _complain(f"{prog}: {error.filename or 'output'}: cannot be written: {error.strerror or error}")
    return DONE


def _complain(line: str) -> int:
    print(" ".join(line.split()), file=sys.stderr)
    return INPUT_WRONG


def _check_places(words: argparse.Namespace) -> None:
    """Refuse places where results cannot go, before anything is read. Raises WrongSetting."""
    if words.out is not None:
        _check_folder("--out", words.out, next(p for p in (words.out, *words.out.absolute().parents) if p.exists()))
    if words.json not in (None, "-"):
        _check_folder("--json", words.json, Path(words.json).parent)
        if Path(words.json).is_dir():
            raise WrongSetting(f"--json: expected a file, got the folder {words.json or '.'}; name a file in it")


def _check_folder(option: str, asked: Path | str, folder: Path) -> None:
    if not folder.is_dir():
        raise WrongSetting(f"{option}: expected a place in a folder, got {asked}: {folder} is no folder; name another")
    if not os.access(folder, os.W_OK | os.X_OK):
        raise WrongSetting(f"{option}: expected a place that can be written, got {asked}; name another")


def _average_file(words: argparse.Namespace) -> Averages:
    from postproc.readers.state import holds_trajectory, read_state

    snapshot = read_state(words.state, frame=words.frame)
    reference = None
    if words.reference is not None:
        reference = read_state(words.reference)
    elif holds_trajectory(words.state):
        reference = read_state(words.state, frame=0)
    return average(
        snapshot, cells=words.cells, margin=words.margin, minimum_contacts=words.minimum_contacts,
        kn=words.kn, kt=words.kt, reference=reference, rate=words.rate, gravity=words.gravity,
    )


def _deliver(averages: Averages, words: argparse.Namespace) -> None:
    from postproc.output import json_text, table_text, write_files

    if words.out is not None:
        write_files(words.out, averages)
    if words.json is not None and words.json != "-":
        Path(words.json).write_text(json_text(averages), encoding="utf-8")
    print(json_text(averages) if words.json == "-" else table_text(averages), end="")


class _OneLineParser(argparse.ArgumentParser):
    """Reports a wrong command in one line."""

    def error(self, message: str) -> NoReturn:
        self.exit(INPUT_WRONG, f"{self.prog}: {message}; see {self.prog} --help\n")


def _parser(prog: str) -> argparse.ArgumentParser:
    parser = _OneLineParser(prog=prog, description="Micro-macro averages of one granular state.")
    add = parser.add_argument
    add("state", type=Path, metavar="STATE", help="neutral state (.h5, .json, NAME of CSV files) or trajectory.h5")
    add("--frame", type=int, metavar="K", help="frame of a trajectory, from 0; default the last")
    add("--cells", choices=tuple(CELLS), default="box", help="what to average over; default box")
    add("--margin", type=_positive, metavar="M", help="border left out by 'inner', m; default two mean diameters")
    add("--minimum-contacts", type=int, default=MINIMUM_CONTACTS, metavar="N",
        help="fewer make a rattler; default %(default)s, frictionless 3 in 2D and 4 in 3D")
    add("--kn", type=_positive, metavar="K", help="normal stiffness, N/m, in place of column kn")
    add("--kt", type=_positive, metavar="K", help="tangential stiffness, N/m, in place of column kt")
    add("--reference", type=Path, metavar="STATE", help="state that strains are measured from; "
        "default the first frame of a trajectory")
    add("--rate", type=float, metavar="R", help="strain rate for the inertial number, 1/s")
    add("--gravity", type=float, nargs="+", metavar="G", help="components of gravity, m/s^2")
    add("--out", type=_folder, metavar="DIR", help="write average.json, cells.csv and state.csv there")
    add("--json", metavar="FILE", help="write JSON; - for standard output, in place of the table")
    return parser


def _folder(text: str) -> Path:
    if not text.strip():
        raise argparse.ArgumentTypeError("expected a folder, got nothing; use . for this one")
    return Path(text)


def _positive(text: str) -> float:
    value = float(text)
    if not 0 < value < float("inf"):
        raise argparse.ArgumentTypeError(f"expected a number > 0, got {text}")
    return value
