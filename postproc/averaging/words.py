"""How cells are asked for in words, `kind:word:word`, and what is wrong with words that are refused."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

MOST = 1_000_000
"""Cells beyond this number are a slip of the keyboard."""
ROUND_OFF = 1e-9
"""Part of the sample's size within which a border given in decimals is the sample's own."""


class WrongSetting(ValueError):
    """A setting of the averaging that makes no sense; the message names it, what was expected, what came."""


def refuse(kind: str, expected: str, got: object) -> WrongSetting:
    """Return the error for cells of a kind."""
    return WrongSetting(f"cells {kind}: expected {expected}, got {got}")


def number(kind: str, word: str, what: str) -> float:
    """Read a finite number. Raises WrongSetting."""
    try:
        value = float(word)
    except ValueError:
        value = np.nan
    if not np.isfinite(value):
        raise refuse(kind, f"a number for {what}", repr(word))
    return value


def count(kind: str, word: str, what: str) -> int:
    """Read a whole number from 1 to MOST. Raises WrongSetting."""
    if not (word.isascii() and word.isdigit() and 0 < int(word[:20]) <= MOST):
        raise refuse(kind, f"a whole number from 1 to {MOST} for {what}", repr(word))
    return int(word)


def counts(kind: str, word: str, dimension: int) -> tuple[int, ...]:
    """Read a number of cells an axis, "32x32". Raises WrongSetting."""
    parts = word.split("x")
    if len(parts) != dimension:
        raise refuse(kind, f"{dimension} whole numbers like {'x'.join(['32'] * dimension)}", repr(word))
    found = tuple(count(kind, part, "the cells of an axis") for part in parts)
    if np.prod([float(n) for n in found]) > MOST:
        raise refuse(kind, f"at most {MOST} cells", word)
    return found


def edges(kind: str, words: Sequence[str], whole: Sequence[float] | str) -> np.ndarray:
    """Read borders of cells in a row, (K+1,): "60" of the whole sample, "60:LOW:HIGH" or "e0,e1,e2,...".

    whole: bounds of the sample, or why they are not known. Raises WrongSetting, also for borders that do not
    increase: such cells would overlap.
    """
    if len(words) == 1 and "," in words[0]:
        return _listed(kind, words[0])
    if len(words) == 3:
        low, high = (number(kind, word, "a bound") for word in words[1:])
        return _even(kind, words[0], low, high)
    if len(words) != 1:
        raise refuse(kind, "a number of cells, NUMBER:LOW:HIGH, or borders as a,b,c", repr(":".join(words)))
    if isinstance(whole, str):
        raise refuse(kind, "bounds, as NUMBER:LOW:HIGH", f"{words[0]} alone, and {whole}")
    return _even(kind, words[0], *whole)


def _even(kind: str, word: str, low: float, high: float) -> np.ndarray:
    if not low < high:
        raise refuse(kind, "a lower bound below the upper one", f"{low:g} and {high:g}")
    n = count(kind, word, "the number of cells")
    return _increasing(kind, np.linspace(low, high, n + 1))


def _listed(kind: str, word: str) -> np.ndarray:
    return _increasing(kind, np.array([number(kind, part, "a border") for part in word.split(",")]))


def _increasing(kind: str, borders: np.ndarray) -> np.ndarray:
    falls = np.flatnonzero(np.diff(borders) <= 0)
    if falls.size:
        a, b = borders[falls[0] : falls[0] + 2]
        raise refuse(kind, "borders that increase (cells must not overlap)", f"{b:g} after {a:g}")
    return borders


def at_walls(kind: str, borders: np.ndarray, whole: Sequence[float], what: str) -> tuple[bool, bool]:
    """Return which outermost borders are the sample's own, up to round-off.

    Raises WrongSetting for cells that reach outside the sample.
    """
    low, high = whole
    slack = ROUND_OFF * (high - low)
    if borders[0] < low - slack or borders[-1] > high + slack:
        got = f"{borders[0]:.9g} to {borders[-1]:.9g}"
        raise refuse(kind, f"cells inside the sample, {what} from {low:.9g} to {high:.9g} m", got)
    return bool(borders[0] <= low + slack), bool(borders[-1] >= high - slack)
