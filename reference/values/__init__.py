"""Tabulated reference values: `*.toml` beside this file, each with origin, kind and reason.

A table is one value::

    [name]
    quantity = "plateau sigma_zz"     # as the studies call it
    value = 183.0
    unit = "N/m"
    kind = "published"                # analytical / published / regression
    origin = "where it stands"
    seen = true                       # false: recalled, sets scenes up and never decides a verdict
    conditions = "under which it holds"
    known_difference = "why ours may differ, if that is understood"   # optional
"""

from __future__ import annotations

import tomllib
from dataclasses import dataclass
from functools import cache
from importlib import resources


@dataclass(frozen=True, kw_only=True)
class Published:
    """One reference value; `decides` is true only if the number was seen in its source."""

    name: str
    quantity: str
    value: float
    unit: str
    kind: str
    origin: str
    seen: bool
    conditions: str
    known_difference: str = ""

    @property
    def decides(self) -> bool:
        """May this value decide a verdict?"""
        return self.seen


@cache
def published_values() -> dict[str, Published]:
    """Return all values by name."""
    files = (f for f in resources.files(__package__).iterdir() if f.name.endswith(".toml"))
    tables = (tomllib.loads(f.read_text(encoding="utf-8")) for f in sorted(files, key=lambda f: f.name))
    return {name: Published(name=name, **table) for file in tables for name, table in file.items()}
