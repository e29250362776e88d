"""Oracles are kept beside the runs, named by everything that decides them, so that none is computed twice."""

from __future__ import annotations

import hashlib
import json
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from harness.engines.registry import KERNEL_PREFIX, find_engine
from harness.runs.sealed import read_sealed, write_sealed
from harness.studies.accuracy.exits import Exits
from harness.studies.accuracy.oracle import Oracle, oracle

if TYPE_CHECKING:
    from harness.scene.system import System

SCHEMA = 2
"""Of these files and of what `oracle` computes: raise it when either changes."""


def kept_oracle(
    system: System, convention: str, *, kept: Path, file: Path, contact_time: float, finest: float
) -> Oracle:
    """Return `oracle`, from `kept` if it was computed before by the same kernel."""
    told = {
        "system": system.digest(), "convention": convention, "finest": finest, "contact_time": contact_time,
        "kernel": find_engine(f"{KERNEL_PREFIX}talk").probe().version, "schema": SCHEMA,
    }
    place = kept / f"{hashlib.sha256(json.dumps(told, sort_keys=True).encode()).hexdigest()[:16]}.json"
    found = _read(place)
    if found is None:
        found = oracle(system, convention, file=file, contact_time=contact_time, finest=finest)
        write_sealed(place, asdict(found))
    return found


def _read(place: Path) -> Oracle | None:
    """Return what is kept; None if it is missing or not what was written, then it is computed anew."""
    data = read_sealed(place, "the oracle is")
    if data is None:
        return None
    exits = Exits(**{name: np.array(values) for name, values in data.pop("exits").items()})
    return Oracle(exits=exits, **data)
