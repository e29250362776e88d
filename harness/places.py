"""Where the results of a command go: looked at before anything runs, and never onto what the command reads."""

from __future__ import annotations

import os
import tempfile
from pathlib import Path

from harness.errors import InputError


def check_places(options) -> None:
    """Refuse, before anything runs or is written, places where results cannot go."""
    if options.out is not None:
        require_place("--out", options.out)
        _check_packings(options.out)
    if options.json not in (None, "-"):
        target = Path(options.json)
        if options.out is not None and target.absolute() in (options.out.absolute(), *options.out.absolute().parents):
            raise InputError(
                file="--json", expected="a file", got=f"{options.json}, which is or holds the folder of --out",
                fix="name a file in it",
            )
        if target.is_dir() or not target.parent.is_dir() or not os.access(target.parent, os.W_OK | os.X_OK):
            raise InputError(file="--json", expected="a file in a folder that exists", got=options.json or "nothing")
        _keep_input(options, target)


def require_place(option: str, folder: Path) -> None:
    """Raise InputError when `folder` is none, or can neither be written nor made."""
    nearest = next(p for p in (folder, *folder.absolute().parents) if os.path.lexists(p))
    if nearest.is_dir() and _takes_files(nearest):
        return
    got, fix = f"{folder}", "make it writable or name another folder"
    if not nearest.is_dir():
        got, fix = f"{nearest}, which is no folder", "name another place"
    raise InputError(file=option, expected="a folder that can be written", got=got, fix=fix)


def check_file(option: str, target: Path) -> None:
    """Refuse, before anything runs, a file that cannot be written where an option says."""
    if target.is_dir() or not target.parent.is_dir() or not _takes_files(target.parent):
        raise InputError(
            file=option, expected="a file in a folder that exists and takes files", got=str(target) or "nothing"
        )


def _takes_files(folder: Path) -> bool:
    """Try it with a file without a name: permissions do not tell of /proc, or of a disk that is mounted read-only."""
    try:
        with tempfile.TemporaryFile(dir=folder):
            return True
    except OSError:
        return False


def _check_packings(out: Path) -> None:
    from harness.runs.folder import require_folder

    require_folder(out / "packings")


def _keep_input(options, target: Path) -> None:
    """Refuse to write results onto what they are made from, under whatever name or link."""
    if not target.exists():
        return
    for read in _read(options):
        if os.path.exists(read) and os.path.samefile(read, target):
            raise InputError(
                file="--json", expected="a file that this command does not read", got=options.json,
                fix="name another file",
            )


def _read(options) -> list[Path]:
    """Return the files that a command reads, whether they are there or not."""
    from harness.scene.load import files_of

    reports = [p for p in (getattr(options, name, None) for name in ("folder", "against")) if p is not None]
    return [f for s in _scenes(options) for f in files_of(s)] + [f for p in reports for f in (p, p / "report.json")]


def _scenes(options) -> list[Path]:
    """Return the scene files that a command reads."""
    if "files" in options:
        from harness.studies.decks import shipped_scenes

        return options.files or shipped_scenes()
    return [options.file] if "file" in options else []
