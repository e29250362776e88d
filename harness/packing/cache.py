"""Start states on disk: a CSV table and a JSON file of facts beside it, under one checksum.

A state is named by the hash of everything that decides it (its key). What is not what was written, or only half of it,
is as good as missing: it is made again.
"""

from __future__ import annotations

import hashlib
import json
import logging
from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np

log = logging.getLogger(__name__)


def cached_path(cache: Path, kind: str, key: Mapping) -> Path:
    """Return the place of the table of this key."""
    return cache / f"{kind}-{hashlib.sha256(json.dumps(key, sort_keys=True).encode()).hexdigest()[:16]}.csv"


def read_cached(path: Path) -> tuple[dict[str, np.ndarray], dict] | None:
    """Return the columns and the facts, None where there are none; says so when they are damaged."""
    found = _read(path)
    if found is None and (path.exists() or path.with_suffix(".json").exists()):
        log.warning("%s: it or its .json is not what was written; the packing is made again", path.name)
    return found


def write_cached(path: Path, names: Sequence[str], columns: Sequence[np.ndarray], facts: dict) -> None:
    """Write `columns` (each (N,), 17 digits, ids from 1 before them) and `facts`; each whole or not at all."""
    from harness.runs.atomic import write_json_atomic, write_text_atomic

    rows = np.column_stack(columns)
    lines = (",".join([str(k + 1), *(f"{v:.17g}" for v in row)]) for k, row in enumerate(rows))
    text = "\n".join([",".join(["id", *names]), *lines]) + "\n"
    path.parent.mkdir(parents=True, exist_ok=True)
    write_text_atomic(path, text)
    write_json_atomic(path.with_suffix(".json"), facts | {"sha256": _checksum(text.encode(), facts)})


def _checksum(table: bytes, facts: dict) -> str:
    """SHA-256 of both files, without the checksum itself."""
    return hashlib.sha256(table + json.dumps(facts, sort_keys=True).encode()).hexdigest()


def _read(path: Path) -> tuple[dict[str, np.ndarray], dict] | None:
    try:
        text = path.read_bytes()
        facts = json.loads(path.with_suffix(".json").read_bytes())
        checksum = facts.pop("sha256")
    except (OSError, ValueError, KeyError, AttributeError, TypeError):
        return None
    if checksum != _checksum(text, facts):
        return None
    head, *lines = text.decode().splitlines()
    table = np.loadtxt(lines, delimiter=",", ndmin=2)
    return dict(zip(head.split(","), table.T, strict=True)), facts
