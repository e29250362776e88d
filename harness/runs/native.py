"""What becomes of an engine's own dumps once the trajectory stands: they repeat it, in other words.

Small files stay as they are. Large ones of text are compressed, because OVITO, MDAnalysis and pandas open
.gz as it is: nothing is lost and numbers of 17 digits shrink to half. Binary ones (HDF5) stay, too: they would shrink
by a fifth, and no reader opens them compressed. "plain" leaves everything, "drop" deletes large files but for logs:
the deck brings them back.
"""

from __future__ import annotations

import gzip
import os
import shutil
from collections.abc import Collection
from pathlib import Path
from typing import Literal

NativePolicy = Literal["gzip", "plain", "drop"]

LARGE = 1 << 20
"""Bytes from which a file counts as large."""

BINARY = (".h5",)
"""Endings of files that are not compressed: measured, 18 % less of a box's frames."""

LEVEL = 1
"""Of gzip: measured on columns of 17 digits, level 1 leaves 50 % at 100 MB/s, level 6 47 % at 19 MB/s."""


def settle_native(folder: Path, *, keep: Collection[str], policy: NativePolicy) -> str:
    """Apply `policy` to the large files of `folder`, except those named in `keep`; say what was done."""
    large = [p for p in sorted(folder.rglob("*")) if _is_large(p) and p.relative_to(folder).as_posix() not in keep]
    large = [p for p in large if policy == "drop" or p.suffix not in BINARY]
    if policy == "plain" or not large:
        return "kept as written"
    return ", ".join(_settle(p, policy) for p in large)


def _is_large(path: Path) -> bool:
    return path.is_file() and not path.is_symlink() and path.suffix != ".gz" and path.stat().st_size >= LARGE


def _settle(path: Path, policy: NativePolicy) -> str:
    before = path.stat().st_size / 1e6
    if policy == "drop" and path.suffix != ".log":
        path.unlink()
        return f"{path.name} deleted ({before:.3g} MB)"
    after = _compress(path) / 1e6
    return f"{path.name} compressed ({before:.3g} to {after:.3g} MB)"


def _compress(path: Path) -> int:
    packed, part = path.with_name(path.name + ".gz"), path.with_name(path.name + ".gz.part")
    with open(path, "rb") as source, open(part, "wb") as raw, \
            gzip.GzipFile(path.name, "wb", LEVEL, raw, mtime=0) as target:
        shutil.copyfileobj(source, target, 1 << 20)
    os.replace(part, packed)
    path.unlink()
    return packed.stat().st_size
