"""How numbers and titles are written into a deck."""

from __future__ import annotations

import re
from collections.abc import Iterable


def number(value: float) -> str:
    """Return 17 significant digits: reading them back gives the same float64.

    >>> number(0.1)
    '0.10000000000000001'
    """
    return f"{value:.17g}"


def numbers(values: Iterable[float]) -> str:
    """Return numbers separated by blanks."""
    return " ".join(number(v) for v in values)


def comment(text: str) -> str:
    """Return the text fit for a comment: one line, and nothing LAMMPS acts on (`&`, `$`, quotes).

    >>> comment('two discs & a "wall"')
    'two discs a wall'
    """
    return " ".join(re.sub(r"[^\w ,.;:()+*/=<>-]", " ", text, flags=re.ASCII).split())
