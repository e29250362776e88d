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
    date = "2024-11"                  # when it was published or derived; optional for published ones
    tolerance = 0.01                  # relative; analytical ones must have it, with
    reason = "why that much"          # published ones are judged by the scatter over packings
"""

from __future__ import annotations

import math
import tomllib
from collections.abc import Iterable
from dataclasses import dataclass
from functools import cache
from importlib import resources

KINDS = ("analytical", "published", "regression")


@dataclass(frozen=True, kw_only=True)
class Published:
    """One reference value; raises ValueError for a kind that there is not, or a value that is none or zero.

    Deviations are relative to the value, hence not zero.
    """

    name: str
    quantity: str
    value: float
    unit: str
    kind: str
    origin: str
    seen: bool
    conditions: str
    known_difference: str = ""
    date: str = ""
    tolerance: float | None = None
    reason: str = ""

    def __post_init__(self) -> None:
        """Refuse what would make a verdict meaningless."""
        if self.kind == "analytical" and not (self.tolerance and self.tolerance > 0.0 and self.reason and self.date):
            raise ValueError(f"{self.name}: an analytical value needs a tolerance > 0, its reason and a date")
        if self.kind not in KINDS:
            raise ValueError(f"{self.name}: kind must be one of {', '.join(KINDS)}, got {self.kind!r}")
        if not math.isfinite(self.value) or self.value == 0.0:
            raise ValueError(f"{self.name}: value must be finite and not zero, got {self.value!r}")

    @property
    def decides(self) -> bool:
        """May this value decide a verdict? Only if the number was seen in its source."""
        return self.seen


@cache
def published_values() -> dict[str, Published]:
    """Return all values by name; ValueError or TypeError for a table that is wrong, or a name used twice."""
    files = (f for f in resources.files(__package__).iterdir() if f.name.endswith(".toml"))
    return collect(f.read_text(encoding="utf-8") for f in sorted(files, key=lambda f: f.name))


def collect(texts: Iterable[str]) -> dict[str, Published]:
    """Return the values of several TOML texts by name; raises as `published_values` does."""
    found: dict[str, Published] = {}
    for name, table in (item for text in texts for item in tomllib.loads(text).items()):
        if name in found:
            raise ValueError(f"{name}: there are two values of this name")
        found[name] = Published(name=name, **table)
    return found
