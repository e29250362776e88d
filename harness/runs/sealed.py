"""What is kept beside the runs, oracles and times: a JSON file under a checksum of its own.

What is not what was written, cut short or edited, is as good as missing: it is made again, and a line says so.
"""

from __future__ import annotations

import hashlib
import json
import logging
from pathlib import Path

from harness.runs.atomic import json_text, write_text_atomic

log = logging.getLogger(__name__)

CHECKSUM = "sha256"
"""The last entry: of all the others."""


def write_sealed(place: Path, data: dict) -> None:
    """Write atomically, making the folder."""
    plain = json.loads(json_text(data))
    place.parent.mkdir(parents=True, exist_ok=True)
    write_text_atomic(place, json_text(plain | {CHECKSUM: _checksum(plain)}))


def read_sealed(place: Path, what: str) -> dict | None:
    """Return what `write_sealed` wrote, None if it is missing or something else; then says that it is made again.

    what: in words, e.g. "the times are".
    """
    try:
        data = json.loads(place.read_text())
    except FileNotFoundError:
        return None
    except (ValueError, RecursionError):
        data = None
    seal = data.pop(CHECKSUM, None) if isinstance(data, dict) else None
    if seal is not None and seal == _checksum(data):
        return data
    log.warning("%s/%s: it is not what was written; %s made again", place.parent.name, place.name, what)
    return None


def _checksum(data: dict) -> str:
    return hashlib.sha256(json.dumps(data, sort_keys=True).encode()).hexdigest()
