"""The one way wrong input is reported: one line that says where, what was expected, what came."""

from __future__ import annotations

import os


class InputError(Exception):
    """Wrong input of the user; the command line prints it as one line and exits with status 2.

    Parameters
    ----------
    file: the file at fault, as the user named it.
    place: where in it, e.g. ``contact.sliding.shear_stiffness`` or ``line 12``; may be empty.
    expected: what would have been right.
    got: what was found.
    fix: what to do about it; may be empty.

    >>> print(InputError(file="a.toml", place="particles.count", expected="an int > 0", got="-3"))
    a.toml: particles.count: expected an int > 0, got -3
    """

    def __init__(self, *, file: object, place: str = "", expected: str, got: object, fix: str = ""):
        where = f"{file}: {place}" if place else f"{file}"
        line = f"{where}: expected {expected}, got {got}" + (f"; {fix}" if fix else "")
        super().__init__(" ".join(line.split()))


def system_line(error: OSError) -> str:
    """Say an error of the system in words, the place first and without its number.

    >>> system_line(OSError(28, "No space left on device", "out/report.json"))
    'out/report.json: No space left on device'
    """
    words = error.strerror or str(error) or type(error).__name__
    return words if error.filename is None else f"{os.fsdecode(error.filename)}: {words}"
