"""What is kept in a folder of runs, and what of it nobody needs.

A run is needed while it is under way, and when it ended by itself, well or badly, and the report beside it
shows it. Without a report nothing says what is needed, so every run that ended is kept.
"""

from __future__ import annotations

import json
import os
import re
import shutil
import time
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from pathlib import Path

import msgspec

from harness.runs.folder import TRASH, RunFolder, list_runs
from harness.runs.outcome import Outcome

OURS = re.compile(r".+-[0-9a-f]{12}")
"""Names of run folders; whatever else lies beside them is not touched."""


@dataclass(frozen=True, kw_only=True)
class Kept:
    """One run folder.

    state: the status of its outcome, or "under way", "unfinished", "damaged". note: what is damaged.
    size: bytes of all its files. shown: whether the report shows it; None without a report, or if it did not end.
    """

    folder: Path
    state: str
    note: str
    size: int
    shown: bool | None

    @property
    def needless(self) -> str:
        """Say why it can go, "" if it is to stay."""
        if self.state in ("unfinished", "damaged"):
            return self.state
        return "not in the report" if self.shown is False else ""


def survey(root: Path, report: Path) -> list[Kept]:
    """Return the runs below `root`, by name. report: the JSON of the comparison whose runs they are, if there is one.

    Every trajectory is read once, to see that it is undamaged.
    """
    reported = _reported(report)
    known = {path: (outcome, note) for path, outcome, note in list_runs(root)}
    return [_kept(path, *known.get(path, (None, "unfinished")), reported) for path in _folders(root)]


def _folders(root: Path) -> Iterator[Path]:
    """Yield run folders, links left out: what they lead to is not ours."""
    for path in sorted(root.iterdir()):
        if OURS.fullmatch(path.name) and path.is_dir() and not path.is_symlink():
            yield path


def _kept(path: Path, outcome: Outcome | None, note: str, reported: list[Outcome] | None) -> Kept:
    state, shown = ("unfinished" if note == "unfinished" else "damaged"), None
    if RunFolder.at(path).busy():
        state, note = "under way", ""
    elif outcome is not None:
        state, note = outcome.status, outcome.reason
        shown = None if reported is None else outcome in reported
    return Kept(folder=path, state=state, note="" if note == state else note, size=_size(path), shown=shown)


def _reported(report: Path) -> list[Outcome] | None:
    """Return the outcomes that a report shows; None if there is none, or it is none of ours."""
    try:
        return msgspec.convert(json.loads(report.read_text(encoding="utf-8"))["runs"], list[Outcome])
    except (OSError, ValueError, KeyError, TypeError, msgspec.MsgspecError):
        return None


def _size(path: Path) -> int:
    """Return the bytes of all files; one that vanishes meanwhile counts nothing."""
    total = 0
    for folder, _, files in os.walk(path):
        for name in files:
            try:
                total += os.lstat(os.path.join(folder, name)).st_size
            except FileNotFoundError:
                continue
    return total


def remove(runs: Iterable[Kept]) -> list[Kept]:
    """Delete the runs that are needless and that nobody has taken up since; return which they were."""
    return [r for r in runs if r.needless and _removed(r.folder)]


def _removed(path: Path) -> bool:
    """Delete one run folder under its lock: at once, by renaming it first; False if somebody works in it."""
    with RunFolder.at(path).try_lock() as ours:
        if ours:
            trash = path.parent / TRASH / f"{path.name}-{time.time_ns()}"
            trash.parent.mkdir(exist_ok=True)
            os.replace(path, trash)
            shutil.rmtree(trash)
    return ours
