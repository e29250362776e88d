"""The words of the averaging command: its options, and the places where results may go."""

from __future__ import annotations

import argparse
import os
from pathlib import Path
from typing import NoReturn

from postproc.averaging.frame import FRAMES
from postproc.averaging.partition import WEIGHTS
from postproc.averaging.words import WrongSetting
from postproc.macro.coordination import MINIMUM_CONTACTS
from postproc.output import FILES

INPUT_WRONG = 2

EPILOG = """cells: box, inner, particles,
rings:60 (between the ring walls), rings:60:R1:R2, rings:R1,R2,R3;
strips:x:20 (over the box), strips:x:20:LOW:HIGH, strips:x:X1,X2,X3;
grid:32x32; halfplane:NX,NY:DISTANCE;
points:32x32, points:FILE.csv (coarse graining, with --kernel and --width)."""


class _OneLineParser(argparse.ArgumentParser):
    """Reports a wrong command in one line."""

    def error(self, message: str) -> NoReturn:
        self.exit(INPUT_WRONG, f"{self.prog}: {message}; see {self.prog} --help\n")


def parser(prog: str) -> argparse.ArgumentParser:
    """Return the parser of the command's words."""
    made = _OneLineParser(prog=prog, description="Micro-macro averages of one granular state.", epilog=EPILOG)
    add = made.add_argument
    add("state", type=_file, metavar="STATE", help="neutral state (.h5, .json, NAME of CSV files) or trajectory.h5")
    add("--frame", type=int, metavar="K", help="frame of a trajectory, from 0; default the last")
    add("--frames", type=_range, metavar="START:STOP",
        help="mean over these frames of a trajectory, from 0, with errors; 20: from 20 to the end")
    add("--cells", default="box", metavar="KIND[:WORDS]", help="what to average over, see below; default box")
    add("--fields", default="all", metavar="NAME,...", help="quantities; default all")
    add("--weights", choices=WEIGHTS, help="particles cut by a border: exact fractions, or whole where their centre is")
    add("--frame-of", choices=FRAMES, help="components of vectors and tensors; default polar in rings, else Cartesian")
    add("--kernel", metavar="NAME", help="of coarse graining at points")
    add("--width", type=_number, metavar="W", help="of that kernel, m")
    add("--margin", type=_number, metavar="M", help="border left out by 'inner', m; default two mean diameters")
    add("--minimum-contacts", type=_whole, default=MINIMUM_CONTACTS, metavar="N",
        help="fewer make a rattler; default %(default)s, frictionless 3 in 2D and 4 in 3D")
    add("--kn", type=_number, metavar="K", help="normal stiffness, N/m, in place of column kn")
    add("--kt", type=_number, metavar="K", help="tangential stiffness, N/m, in place of column kt; 0: no such springs")
    add("--reference", type=_file, metavar="STATE", help="state that strains are measured from; "
        "default the first frame of a trajectory")
    add("--rate", type=_number, metavar="R", help="strain rate for the inertial number, 1/s")
    add("--gravity", type=_number, nargs="+", metavar="G", help="components of gravity, m/s^2")
    add("--centre", type=_number, nargs="+", metavar="C", help="what rings and polar components are about, m; default "
        "the centre of the ring walls, without any the origin")
    add("--out", type=_folder, metavar="DIR", help=f"write {', '.join(FILES[:-1])} and {FILES[-1]} there")
    add("--json", metavar="FILE", help="write JSON; - for standard output, in place of the table")
    return made


def _range(text: str) -> slice:
    """Read START:STOP, either of which may be missing."""
    start, colon, stop = text.partition(":")
    try:
        if not colon:
            raise ValueError
        return slice(*(int(word) if word.strip() else None for word in (start, stop)))
    except ValueError:
        raise argparse.ArgumentTypeError(f"expected START:STOP, such as 20: or 20:60, got {text!r}") from None


def _folder(text: str) -> Path:
    if not text.strip():
        raise argparse.ArgumentTypeError("expected a folder, got nothing; use . for this one")
    return Path(text)


def _file(text: str) -> Path:
    if not text.strip():
        raise argparse.ArgumentTypeError("expected the file of a state, got nothing")
    return Path(text)


def _number(text: str) -> float:
    try:
        return float(text)
    except ValueError:
        raise argparse.ArgumentTypeError(f"expected a number, got {text!r}") from None


def _whole(text: str) -> int:
    try:
        return int(text)
    except ValueError:
        raise argparse.ArgumentTypeError(f"expected a whole number, got {text!r}") from None


def check_places(words: argparse.Namespace) -> None:
    """Refuse places where results cannot go, before anything is read. Raises WrongSetting."""
    if words.out is not None:
        nearest = next(p for p in (words.out, *words.out.absolute().parents) if p.exists())
        _check_folder("--out", words.out, nearest)
        for name in FILES:
            _keep_inputs("--out", words.out / name, words)
    if words.json not in (None, "-"):
        _check_folder("--json", words.json, Path(words.json).parent)
        if Path(words.json).is_dir():
            raise WrongSetting(f"--json: expected a file, got the folder {words.json or '.'}; name a file in it")
        _keep_inputs("--json", Path(words.json), words)


def _check_folder(option: str, asked: Path | str, folder: Path) -> None:
    if not folder.is_dir():
        raise WrongSetting(f"{option}: expected a place in a folder, got {asked}: {folder} is no folder; name another")
    if not os.access(folder, os.W_OK | os.X_OK):
        raise WrongSetting(f"{option}: expected a place that can be written, got {asked}; name another")


def _keep_inputs(option: str, target: Path, words: argparse.Namespace) -> None:
    """Refuse to write over a state, or points, that are read."""
    from postproc.readers.state_formats import files_of

    states = [state for state in (words.state, words.reference) if state is not None]
    points = [Path(rest) for rest in words.cells.split(":", 1)[1:] if rest]
    for file in (*points, *(file for state in states for file in files_of(state))):
        if file.resolve() == target.resolve() or (file.exists() and target.exists() and file.samefile(target)):
            raise WrongSetting(f"{option}: expected a place of its own, got {target}, which is read; name another")
