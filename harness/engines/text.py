"""How numbers and titles are written into the decks of engines with plain text input."""

from __future__ import annotations

import re
from collections.abc import Iterable


def number(value: float) -> str:
    """Return the shortest decimal that reads back as the same float64, at most 17 digits.

    >>> number(0.1)
    '0.1'
    """
    return repr(float(value)).removesuffix(".0")


def numbers(values: Iterable[float]) -> str:
    """Return numbers separated by blanks."""
    return " ".join(number(v) for v in values)


def comment(text: str) -> str:
    """Return the text fit for a comment: one line, without `&`, `$` and quotes, which decks act on.

    >>> comment('two discs & a "wall"')
    'two discs a wall'
    """
    return " ".join(re.sub(r"[^\w ,.;:()+*/=<>-]", " ", text, flags=re.ASCII).split())
