"""One thing wrong with a scene, and how places and values are written in its message."""

from __future__ import annotations

import math
import re
from collections.abc import Sequence
from dataclasses import dataclass

from harness.errors import InputError

LONGEST = 60
"""Characters of a value that a message shows."""

LARGEST, SMALLEST, LARGEST_INTEGER = 1e30, 1e-30, 2**53
"""SI numbers beyond these are slips, and would overflow in products of powers."""


@dataclass(frozen=True, kw_only=True)
class Fault:
    """What is wrong at `place` (dotted path, arrays counted from 0, or ``line 12``) of a file."""

    place: str
    expected: str
    got: str
    fix: str = ""

    def error(self, file: object) -> InputError:
        """Return the error that reports this fault of `file`."""
        return InputError(
            file=printable(str(file)), place=self.place, expected=self.expected, got=self.got, fix=self.fix
        )


def number_fault(value: object, place: str) -> Fault | None:
    """Return what is wrong with the size of a number, None if nothing is or it is no number."""
    if isinstance(value, bool) or not isinstance(value, int | float):
        return None
    if isinstance(value, int):
        if abs(value) <= LARGEST_INTEGER:
            return None
        return Fault(place=place, expected="an integer of at most 2^53", got=show(value))
    if not math.isfinite(value):
        return Fault(place=place, expected="a finite number", got=show(value))
    if value == 0 or SMALLEST <= abs(value) <= LARGEST:
        return None
    bound = f"at most {LARGEST:g}" if abs(value) > LARGEST else f"at least {SMALLEST:g}"
    return Fault(
        place=place, expected=f"a magnitude of {bound} in SI units", got=show(value),
        fix="out of range: check the number and its unit",
    )


def path_text(keys: Sequence[str | int]) -> str:
    """Write keys as a path in the scene.

    >>> path_text(["planes", 2, "motion", "kind"])
    'planes[2].motion.kind'
    """
    parts = [f"[{k}]" if isinstance(k, int) else f".{_key(k)}" for k in keys]
    return "".join(parts).removeprefix(".")


def show(value: object, depth: int = 0) -> str:
    """Write a TOML value in one short printable line.

    >>> show({"a": 1}), show([1.5, "x\\n"]), show(None), show(True)
    ('a table', '[1.5, "x\\\\n"]', 'nothing', 'true')
    """
    if value is None:
        return "nothing"
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, int) and abs(value) >= 10**18:
        return f"an integer of {value.bit_length()} bits"
    if isinstance(value, str):
        return f'"{shorten(printable(value))}"'
    if isinstance(value, dict):
        return "a table"
    if isinstance(value, list | tuple):
        return _show_array(value, depth)
    return shorten(printable(str(value)))


def shorten(text: str) -> str:
    """Cut a long text and say so with three points."""
    return text if len(text) <= LONGEST else text[: LONGEST - 3] + "..."


def printable(text: str) -> str:
    """Escape what a terminal could obey: control characters, line ends, undecodable bytes."""
    return "".join(c if c.isprintable() else c.encode("unicode_escape").decode("ascii") for c in text)


def _show_array(values: Sequence, depth: int) -> str:
    if depth:
        return "an array"
    inner = ", ".join(show(v, depth + 1) for v in values[:LONGEST])
    return shorten(f"[{inner}]")


def _key(key: str) -> str:
    return key if re.fullmatch(r"[A-Za-z0-9_-]{1,60}", key) else show(key)
