"""How prescribed runs are kept: a folder each, named by content; one path for all of them; reactions that are verified.

Nothing is believed because of its name: a path is what it was made of, a reaction is what was written, or it is made
anew and a line says so.
"""

from __future__ import annotations

import hashlib
import io
import logging
import os
import shutil
import threading
import zipfile
import zlib
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from harness.engines.protocol import PATH_FILE, REACTION_FILE, Prescribed, Reaction
from harness.runs.atomic import write_bytes_atomic
from harness.runs.folder import RunFolder, record_file

if TYPE_CHECKING:
    from harness.runs.outcome import FileRecord, Status

log = logging.getLogger(__name__)

READ_ONLY = 0o444


class PrescribedFolder(RunFolder):
    """The folder of a run whose result is a reaction."""

    @property
    def trajectory(self) -> Path:
        """The reaction, of completed runs only."""
        return self.path / REACTION_FILE


@dataclass(kw_only=True)
class PathFile:
    """A path as a file, once below `root` and linked into every run folder that needs it.

    content: its very bytes. mended: the shared file was found damaged, and with it all that were linked to it.
    """

    file: Path
    content: bytes
    digest: str
    mended: bool = False
    _lock: threading.Lock = field(default_factory=threading.Lock)

    @classmethod
    def of(cls, root: Path, path: Prescribed) -> PathFile:
        """Return the file of a path, named by its digest; nothing is written yet."""
        content, name = io.BytesIO(), digest(path)
        np.savez(content, **vars(path))
        return cls(file=root / "paths" / f"{name[:16]}.npz", content=content.getvalue(), digest=name)

    def put(self, folder: Path) -> None:
        """See that `folder` has the path: linked where the file system can, never one that is not whole."""
        with self._lock:
            self._see_to_shared()
        target = folder / PATH_FILE
        if self.is_in(folder):
            return
        if target.exists() and not self.mended:
            log.warning("%s: %s is not the path that was run; put back", folder.name, target.name)
        target.unlink(missing_ok=True)
        try:
            os.link(self.file, target)
        except OSError:
            shutil.copyfile(self.file, target)

    def is_in(self, folder: Path) -> bool:
        """Say whether `folder` has exactly this path."""
        return self._is_whole(folder / PATH_FILE)

    def _see_to_shared(self) -> None:
        if self._is_whole(self.file):
            return
        if self.file.exists():
            self.mended = True
            log.warning("%s/%s: not the path it is named after; made anew", self.file.parent.name, self.file.name)
        self.file.parent.mkdir(parents=True, exist_ok=True)
        write_bytes_atomic(self.file, self.content)
        self.file.chmod(READ_ONLY)

    def _is_whole(self, file: Path) -> bool:
        return file.is_file() and file.read_bytes() == self.content


def digest(path: Prescribed) -> str:
    """SHA-256 of the path's numbers."""
    h = hashlib.sha256()
    for name in ("x", "v", "spin"):
        h.update(np.ascontiguousarray(getattr(path, name), "<f8").tobytes())
    return h.hexdigest()


def read_reaction(file: Path, path: Prescribed) -> tuple[Status, str, Reaction | None]:
    """Return the reaction to a path; anything but finite numbers of the right shape is no answer."""
    try:
        with np.load(file) as found:
            reaction = Reaction(force=found["force"], torque=found["torque"])
    except (OSError, ValueError, KeyError, EOFError, zipfile.BadZipFile, zlib.error) as error:
        return "crashed", f"{file.name} cannot be read: {error}", None
    if reaction.force.shape != path.x[1:].shape or reaction.torque.shape != path.spin[1:].shape:
        shapes = f"{reaction.force.shape} and {reaction.torque.shape}"
        return "crashed", f"force and torque have the shapes {shapes}", None
    if not (np.isfinite(reaction.force).all() and np.isfinite(reaction.torque).all()):
        return "unstable", "forces or torques are not finite", None
    return "completed", "", reaction


def keep_reaction(file: Path, reaction: Reaction) -> FileRecord:
    """Write a reaction, compressed to a fifth: bodies that are apart answer zero."""
    content = io.BytesIO()
    np.savez_compressed(content, force=reaction.force, torque=reaction.torque)
    write_bytes_atomic(file, content.getvalue())
    return record_file(file)
