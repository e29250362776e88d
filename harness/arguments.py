"""Words of the command line: what each kind of argument may be, and the parser that refuses others in one line."""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from pathlib import Path
from typing import NoReturn

LONGEST_LIMIT = 1e8
"""Seconds, three years: beyond, a time limit is a slip, and timers overflow."""


LARGEST_COUNT = 1_000_000
"""Of anything that is counted on a command line: more is a slip."""


class OneLineParser(argparse.ArgumentParser):
    """A parser that reports a wrong command in one line and exits with status 2."""

    def error(self, message: str) -> NoReturn:
        """Say what is wrong and how to learn more."""
        self.exit(2, f"{self.prog}: {message}; see {self.prog} --help\n")


def as_names(word: str) -> list[str]:
    """Take names apart that stand between commas; raises ArgumentTypeError for none, and for one that comes twice."""
    names = [w for w in word.split(",") if w]
    if not names:
        raise argparse.ArgumentTypeError(f"expected names separated by commas, got {word!r}")
    twice = next((w for w in names if names.count(w) > 1), None)
    if twice is not None:
        raise argparse.ArgumentTypeError(f"expected each name once, got {twice!r} twice in {word!r}")
    return names


def as_typed(line: str, words: Sequence[str]) -> str:
    """Return a complaint that begins with an option's name with that name as it was typed, in singular or in plural.

    >>> as_typed("--effect: expected a name", ["effects", "FILE", "--effects=x"])
    '--effects: expected a name'
    """
    option, colon, rest = line.partition(":")
    other = option.removesuffix("s") if option.endswith("s") else f"{option}s"
    typed = {word.partition("=")[0] for word in words}
    swapped = option.startswith("--") and option not in typed and other in typed
    return f"{other}{colon}{rest}" if swapped else line


def as_numbers(word: str) -> list[float]:
    """Return numbers separated by commas; raises ArgumentTypeError."""
    try:
        numbers = [float(w) for w in word.split(",") if w]
    except ValueError:
        numbers = []
    if not numbers:
        raise argparse.ArgumentTypeError(f"expected numbers separated by commas, got {word!r}")
    return numbers


def as_folder(word: str) -> Path:
    """Take a folder, which need not exist; nothing is none."""
    if not word.strip():
        raise argparse.ArgumentTypeError("expected a folder, got nothing; use . for this one")
    return Path(word)


def as_count(word: str) -> int:
    """Take a whole number from 1 to LARGEST_COUNT."""
    if not (word.isascii() and word.isdigit() and 0 < len(word) < 10 and 0 < int(word) <= LARGEST_COUNT):
        raise argparse.ArgumentTypeError(f"expected a whole number from 1 to {LARGEST_COUNT}, got {word!r}")
    return int(word)


def as_seconds(word: str) -> float:
    """Take seconds > 0."""
    try:
        value = float(word)
    except ValueError:
        value = float("nan")
    if not 0.0 < value <= LONGEST_LIMIT:
        raise argparse.ArgumentTypeError(f"expected seconds > 0 and <= {LONGEST_LIMIT:g}, got {word!r}")
    return value
