"""Write files so that a reader, or a power cut, meets the old file or the new one and nothing between."""

from __future__ import annotations

import json
import math
import os
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np


def write_text_atomic(path: Path, text: str) -> None:
    """Write UTF-8 text, see `write_bytes_atomic`."""
    write_bytes_atomic(path, text.encode())


def write_bytes_atomic(path: Path, data: bytes) -> None:
    """Write a file: temporary file beside `path`, flush to disk, rename, flush the folder."""
    path = Path(path)
    part = path.with_name(f".{path.name}.{os.getpid()}.{threading.get_ident()}.part")
    with writing(path):
        try:
            with open(part, "wb") as f:
                f.write(data)
                f.flush()
                os.fsync(f.fileno())
            os.replace(part, path)
        finally:
            part.unlink(missing_ok=True)
        flush_folder(path.parent)


@contextmanager
def writing(path: Path) -> Iterator[None]:
    """Name `path` in errors of the system met inside: a full disk does not say of itself where it is."""
    try:
        yield
    except OSError as error:
        raise OSError(error.errno, error.strerror or str(error), str(path)) from error


def write_json_atomic(path: Path, value: Any) -> None:
    """Write `value` as JSON, see `json_text`."""
    write_text_atomic(path, json_text(value))


def json_text(value: Any) -> str:
    """Return `value` as JSON: NaN (not computed) becomes null, NumPy arrays and scalars their values.

    Raises ValueError on an infinite number, which JSON cannot hold and nobody should report,
    TypeError on what is no data.
    """
    return json.dumps(_plain(value), indent=2, allow_nan=False) + "\n"


def flush_folder(folder: Path) -> None:
    """Bring the folder's entries to disk: without it a rename may be lost in a power cut."""
    handle = os.open(folder, os.O_RDONLY)
    try:
        os.fsync(handle)
    finally:
        os.close(handle)


def _plain(value: Any) -> Any:
    if isinstance(value, np.ndarray | np.generic):
        value = value.tolist()
    if isinstance(value, dict):
        return {k: _plain(v) for k, v in value.items()}
    if isinstance(value, list | tuple):
        return [_plain(v) for v in value]
    if isinstance(value, float) and math.isnan(value):
        return None
    return str(value) if isinstance(value, Path) else value
