"""A report that was written, read again: checks, runs and tables as they were, whoever wrote the file."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import msgspec

from harness.errors import InputError
from harness.report.compare import DATA
from harness.runs.outcome import Outcome
from harness.studies.verdict import Check

WANTED = "a report of `grainproof compare`, or the folder that --out named"
AGAIN = "the same `grainproof compare` again writes it anew, from runs that are kept"


@dataclass(frozen=True, kw_only=True)
class FinishedRun:
    """One engine on one packing (counted from 0) and what became of it."""

    engine: str
    packing: int
    outcome: Outcome


@dataclass(frozen=True, kw_only=True)
class Finished:
    """What report.json says. tables: rows by table name."""

    file: Path
    scene_file: str
    scene: Mapping[str, Any]
    exit_status: int
    summary: str
    checks: tuple[Check, ...]
    runs: tuple[FinishedRun, ...]
    tables: Mapping[str, list[dict[str, Any]]]

    @property
    def all_runs(self) -> tuple[FinishedRun, ...]:
        """Every run, as of a comparison that was just made."""
        return self.runs

    @property
    def title(self) -> str:
        """The scene's title."""
        return str(self.scene.get("title") or self.scene_file)


class _Place(msgspec.Struct):
    """Where a run stands; the rest of its row is in its outcome."""

    engine: str
    packing: int


class _Stored(msgspec.Struct):
    """report.json."""

    scene_file: str
    scene: dict[str, Any]
    exit_status: int
    summary: str
    checks: tuple[Check, ...]
    runs: tuple[Outcome, ...]
    tables: dict[str, list[dict[str, Any]]]


def read_finished(place: Path, *, option: str = "") -> Finished:
    """Read the report in a folder, or the file itself. option: the word that named it. Raises InputError."""
    file = place / DATA if place.is_dir() else place
    said = f"{option} {place}".strip()
    try:
        stored = msgspec.convert(json.loads(file.read_bytes()), _Stored)
        places = msgspec.convert(stored.tables["runs"], tuple[_Place, ...])
        pairs = list(zip(places, stored.runs, strict=True))
    except FileNotFoundError:
        got = f"no {DATA} there" if place.is_dir() else "nothing there"
        raise InputError(file=said, expected=WANTED, got=got) from None
    except OSError as error:
        raise InputError(file=said, expected=WANTED, got=error.strerror or "an error of the system") from None
    except (ValueError, KeyError, RecursionError, msgspec.MsgspecError) as error:
        got = f"{file.name}, which is none or damaged ({_fault(error)})"
        raise InputError(file=said, expected=WANTED, got=got, fix=AGAIN) from None
    runs = tuple(FinishedRun(engine=p.engine, packing=p.packing - 1, outcome=o) for p, o in pairs)
    if not runs:
        raise InputError(file=said, expected=WANTED, got="a report without any run", fix=AGAIN)
    facts = {k: getattr(stored, k) for k in ("scene_file", "scene", "exit_status", "summary", "checks", "tables")}
    return Finished(file=file, runs=runs, **facts)


def _fault(error: Exception) -> str:
    """Say what is wrong with the file in few words."""
    if isinstance(error, KeyError):
        return f"no table of {error.args[0]}"
    if isinstance(error, RecursionError):
        return "nested too deeply"
    return str(error)
