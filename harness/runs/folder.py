"""A run's folder, named by everything that decides the run's result.

Layout below the root of all runs::

    <scene_name>-<engine>-<hash12>/
        identity.json     what was hashed: system, packing, engine, version, schema
        <deck files>      as the engine rendered them
        <native output>   the engine's own log and dumps
        trajectory.h5     the run in neutral form
        outcome.json      written last: without it the run is unfinished
    .locks/               one lock file a run; a process that finds it taken waits
"""

from __future__ import annotations

import fcntl
import hashlib
import json
import logging
import os
import re
import shutil
import time
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Self

from harness import SCHEMA
from harness.engines.child import raise_if_stopping
from harness.errors import InputError
from harness.runs.atomic import json_text, write_json_atomic
from harness.runs.outcome import Damaged, FileRecord, Outcome, read_outcome

if TYPE_CHECKING:
    from harness.scene.system import System

log = logging.getLogger(__name__)

IDENTITY, LOCKS, TRASH = "identity.json", ".locks", ".trash"

UNRECORDED = ("outcome.json", "running.lock")
"""Files of a run whose content says nothing of it, or is what the others are recorded in."""

LOCK_POLL = 0.1
"""Seconds between two looks at a taken lock; a blocking wait could not be interrupted."""


def runs_root(out: Path | None = None) -> Path:
    """Return where runs are kept: below `out` if given, else in the user's cache folder.

    The cache folder is $GRAINPROOF_CACHE, or grainproof in $XDG_CACHE_HOME or ~/.cache.
    """
    if out is not None:
        return Path(out).absolute() / "runs"
    own = os.environ.get("GRAINPROOF_CACHE")
    general = os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache"
    return (Path(own) if own else Path(general) / "grainproof").absolute() / "runs"


def require_folder(place: Path) -> None:
    """Raise InputError when something else stands where a folder goes; what is not there will be made."""
    if os.path.lexists(place) and not place.is_dir():
        got = "a link to nothing" if place.is_symlink() and not place.exists() else "a file"
        raise InputError(file=place, expected="a folder", got=got, fix="remove it or name another --out")


def require_root(root: Path) -> None:
    """Raise InputError when runs, or their locks, cannot be kept at `root`."""
    for place in (root, root / LOCKS, root / TRASH):
        require_folder(place)


@dataclass(frozen=True, kw_only=True)
class RunFolder:
    """One run's folder; it need not exist. `identity` is what its name is the hash of."""

    root: Path
    name: str
    identity: Mapping[str, object]

    @classmethod
    def of(cls, root: Path, system: System, engine: str, version: str, **more: object) -> Self:
        """Return the folder of `system` run by this version of `engine`. more: what else decides, as JSON-able data."""
        identity = {"system": system.identity(), "engine": engine, "version": version, "schema": SCHEMA, **more}
        digest = hashlib.sha256(json.dumps(identity, sort_keys=True).encode()).hexdigest()
        readable = re.sub(r"[^A-Za-z0-9_.]+", "_", system.scene_name)[:40].lstrip(".") or "scene"
        name = f"{readable}-{engine.replace(':', '-')}-{digest[:12]}"
        return cls(root=Path(root).absolute(), name=name, identity=identity)

    @property
    def path(self) -> Path:
        """The folder."""
        return self.root / self.name

    @property
    def outcome(self) -> Path:
        """outcome.json, the mark of a finished run."""
        return self.path / "outcome.json"

    @property
    def trajectory(self) -> Path:
        """trajectory.h5, of completed runs only."""
        return self.path / "trajectory.h5"

    @property
    def lock_file(self) -> Path:
        """What its owner holds locked; it stays when the owner has gone."""
        return self.root / LOCKS / f"{self.name}.lock"

    @staticmethod
    def at(path: Path) -> RunFolder:
        """Return the run folder that is found at `path`, whatever it was made of."""
        return RunFolder(root=path.parent, name=path.name, identity={})

    def busy(self) -> bool:
        """Return whether somebody owns the folder right now; writes nothing."""
        if not self.lock_file.exists():
            return False
        with open(self.lock_file) as handle:
            return not _try_lock(handle)

    @contextmanager
    def try_lock(self) -> Iterator[bool]:
        """Own the folder if nobody else does; yields whether."""
        with self._open_lock() as handle:
            yield _try_lock(handle)

    def _open_lock(self):
        self.lock_file.parent.mkdir(parents=True, exist_ok=True)
        return open(self.lock_file, "a")

    @contextmanager
    def lock(self) -> Iterator[None]:
        """Own the folder against other threads and processes; freed even when the owner is killed.

        Raises harness.engines.child.Stopped when the harness stops while it waits.
        """
        with self._open_lock() as handle:
            if not _try_lock(handle):
                log.warning("%s: busy with the same run elsewhere, waiting for it", self.name)
                while not _try_lock(handle):
                    raise_if_stopping()
                    time.sleep(LOCK_POLL)
            yield

    def prepare(self, deck: Mapping[str, str]) -> None:
        """Make the folder anew with nothing but the deck in it.

        An old folder is renamed before it is deleted: it is gone at once or still whole, and an
        engine that outlived a killed harness goes on writing into the one to be deleted.
        """
        if self.path.exists():
            trash = self.root / TRASH / f"{self.name}-{time.time_ns()}"
            trash.parent.mkdir(exist_ok=True)
            os.replace(self.path, trash)
            shutil.rmtree(trash, ignore_errors=True)
        self.path.mkdir(parents=True)
        write_json_atomic(self.path / IDENTITY, self.identity)
        for name, text in deck.items():
            file = self.path / name
            file.parent.mkdir(parents=True, exist_ok=True)
            file.write_text(text, encoding="utf-8", newline="\n")

    def completed(self, deck: Mapping[str, str]) -> Outcome | None:
        """Return the outcome if the run of this deck is completed and undamaged, else None.

        What is found damaged, unfinished or out of date is reported in one line; it is then to be redone.
        """
        try:
            outcome = self.read()
            if outcome is None and self.path.exists():
                raise Damaged("outcome.json is missing, the run was not finished")
            if outcome is None or outcome.status != "completed":
                return None
            if outcome.deck_digest != deck_digest(deck):
                raise Damaged("the deck has changed since this run")
            self._verify_texts(deck)
        except Damaged as error:
            log.warning("%s: %s; run again", self.name, error)
            return None
        return outcome

    def unfinished(self, deck: Mapping[str, str]) -> bool:
        """Return whether a run of just this deck was begun here and broken off, by a kill or by its time limit."""
        try:
            self._verify_texts(deck)
            outcome = self.read()
        except Damaged:
            return False
        return outcome is None or outcome.status == "timed_out"

    def _verify_texts(self, deck: Mapping[str, str]) -> None:
        """Raise Damaged unless deck and identity.json are what was run: a user may take them for it."""
        for name, text in {**deck, IDENTITY: json_text(self.identity)}.items():
            file = self.path / name
            if not file.is_file():
                raise Damaged(f"{name} is missing")
            if file.read_bytes() != text.encode():
                raise Damaged(f"{name} is not what was run")

    def read(self) -> Outcome | None:
        """Return the outcome, None if the run is unfinished. Raises Damaged."""
        try:
            outcome = read_outcome(self.outcome)
        except (FileNotFoundError, NotADirectoryError):
            return None
        if outcome.trajectory is not None:
            _verify(self.trajectory, outcome.trajectory)
        for name, record in outcome.files.items():
            _verify(self.path / name, record)
        return outcome

    def records(self) -> dict[str, FileRecord]:
        """Return what the files are but the trajectory, by name: deck, the engine's own output, identity.json."""
        files = (p for p in sorted(self.path.rglob("*")) if p.is_file() and p.name not in UNRECORDED)
        return {p.relative_to(self.path).as_posix(): record_file(p) for p in files if p != self.trajectory}


def deck_digest(deck: Mapping[str, str]) -> str:
    """SHA-256 of the deck's file names and texts."""
    return hashlib.sha256(json.dumps(dict(deck), sort_keys=True).encode()).hexdigest()


def record_file(path: Path) -> FileRecord:
    """Return size and SHA-256 of a file."""
    with open(path, "rb") as f:
        return FileRecord(size=os.fstat(f.fileno()).st_size, sha256=hashlib.file_digest(f, "sha256").hexdigest())


def list_runs(root: Path) -> list[tuple[Path, Outcome | None, str]]:
    """Return folder, outcome and a note for every run below `root`, sorted by name.

    The outcome is None where the run is unfinished or damaged; then the note says which.
    """
    return [(p.parent, *_peek(p.parent)) for p in sorted(Path(root).glob("[!.]*/identity.json"))]


def _peek(path: Path) -> tuple[Outcome | None, str]:
    try:
        outcome = RunFolder.at(path).read()
    except Damaged as error:
        return None, str(error)
    return (outcome, "") if outcome else (None, "unfinished")


def _verify(path: Path, record: FileRecord) -> None:
    """Compare with what was recorded when the file had just been written and read back."""
    if not path.exists():
        raise Damaged(f"{path.name} is missing")
    size = path.stat().st_size
    if size != record.size:
        raise Damaged(f"{path.name} has {size} bytes, {record.size} were written")
    if record_file(path) != record:
        raise Damaged(f"{path.name} is not what was written (SHA-256 differs)")


def _try_lock(handle) -> bool:
    try:
        fcntl.flock(handle, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError:
        return False
    return True
