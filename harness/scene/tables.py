"""What all tables of a scene file are made of: bounded numbers, plain names, structs that refuse unknown keys."""

from __future__ import annotations

import re
from typing import Annotated

from msgspec import Meta, Struct

Positive = Annotated[float, Meta(gt=0)]
NonNegative = Annotated[float, Meta(ge=0)]
Count = Annotated[int, Meta(ge=1)]
Vector = Annotated[tuple[float, ...], Meta(min_length=2, max_length=3)]
WORD = re.compile(r"\A[a-z][a-z0-9_]{0,23}\Z")
Name = Annotated[
    str,
    Meta(
        pattern=WORD.pattern,
        description="a word of up to 24 lower-case letters, digits and _, beginning with a letter",
    ),
]
"""Names reach decks and file names, so they are plain lower-case words: nothing to inject."""
Title = Annotated[
    str,
    Meta(
        pattern=r"\A[A-Za-z0-9 .,:;()/%+=*'~^_-]{1,100}\Z",
        description="one line of up to 100 letters (A-Z), digits, blanks and .,:;()/%+=*'~^_-",
    ),
]
"""Titles reach deck comments, where a line end, & or $ could begin a command."""


class Table(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """A table of the scene file: unknown keys are refused."""
