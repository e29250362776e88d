"""Finished searches are kept, each in a file named by everything that decides it and sealed by a checksum.

A search that met a run which says nothing about stability (the code crashed at once, time was up) is not kept: the next
call may fare better.
"""

from __future__ import annotations

import hashlib
import json
import math
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING

from harness.runs.sealed import read_sealed, write_sealed
from harness.studies.frontier import late, probe
from harness.studies.frontier.probe import Look

if TYPE_CHECKING:
    from harness.studies.frontier.search import Search, Wanted

SCHEMA = 2
"""Of these files and of what a search does: raise it when either changes."""

PROBE = {name: getattr(probe, name) for name in ("FRAMES", "AMPLITUDE", "GROWN", "SEED")}
LATE = {name: getattr(late, name) for name in ("VISIBLE", "LATE_STEPS", "NEAR")}
"""What a look does besides its number of steps, and what decides that where springs are felt late."""


@dataclass(kw_only=True)
class Kept:
    """The searches that are kept in a folder."""

    folder: Path
    _versions: dict[str, str] = field(default_factory=dict)

    def place(self, wanted: Wanted, precision: float) -> Path:
        """Return where a search is kept: the name follows from engine, version, system, guess, and how it is searched.
        """
        name = wanted.engine.name
        if name not in self._versions:
            self._versions[name] = wanted.engine.probe().version
        told = {
            "engine": name, "version": self._versions[name], "system": wanted.rest.digest(), "guess": wanted.guess,
            "steps": wanted.steps if wanted.steps_at is None else LATE, "precision": precision, "probe": PROBE,
            "schema": SCHEMA,
        }
        return self.folder / f"{_sha256(told)[:16]}.json"

    def looks(self, wanted: Wanted, precision: float) -> list[Look]:
        """Return the looks of a finished search; none if it was not made yet, or is damaged."""
        data = read_sealed(self.place(wanted, precision), f"{wanted.label} is")
        return [] if data is None else [Look(**look | {"energy": _number(look["energy"])}) for look in data["looks"]]

    def put(self, wanted: Wanted, search: Search) -> None:
        """Keep a finished search."""
        if any(look.seen == "failed" for look in search.looks):
            return
        looks = [asdict(look) | {"energy": None if math.isinf(look.energy) else look.energy} for look in search.looks]
        write_sealed(self.place(wanted, search.precision), {"frontier": wanted.label, "looks": looks})


def _number(energy: float | None) -> float:
    """JSON knows no infinite numbers."""
    return math.inf if energy is None else float(energy)


def _sha256(data: dict) -> str:
    return hashlib.sha256(json.dumps(data, sort_keys=True).encode()).hexdigest()
