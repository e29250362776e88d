"""Where a LIGGGHTS lives: the binary on the path, or another one; what is known of it without a run."""

from __future__ import annotations

import hashlib
import re
import shutil
import subprocess
from dataclasses import dataclass
from functools import cache
from pathlib import Path

from harness.engines.child import one_thread_env
from harness.engines.word import program_at
from harness.errors import InputError

BINARY, LIBRARY = "liggghts", "libliggghts"
NEEDS = "a binary of LIGGGHTS"
BANNER = re.compile(r"Version (\S*LIGGGHTS\S*) ([^\s,]+)")


@dataclass(frozen=True, kw_only=True)
class Home:
    """A binary. place: its absolute path, "" for the one on the path.

    build: of its content and that of the library it loads. library: that library's path, "" if it has none.
    shown: what tables call it where its version alone would not tell it from another.
    """

    place: str = ""
    version: str = ""
    build: str = ""
    shown: str = ""
    library: str = ""

    def binary(self) -> str:
        """Return what starts it."""
        return self.place or BINARY


HERE = Home()


def home_at(place: str) -> Home:
    """Return the LIGGGHTS at `place`; raises InputError when there is none."""
    path = str(program_at(BINARY, place, NEEDS))
    version, library = _banner_version(path), _library(path)
    if not version:
        got = f"{path}, which does not print a version of LIGGGHTS when it is given -h"
        raise InputError(file=f"{BINARY}@{place}", expected=NEEDS, got=got)
    build = _content([path, *([library] if library else [])])
    return Home(place=path, version=version, build=build, library=library)


@cache
def version_of(path: str) -> str:
    """Return the version of the Debian package that owns the binary, else its banner's."""
    return _package_version(path) or _banner_version(path) or "unknown"


def launcher() -> str | None:
    """Return the path of Open MPI's mpirun, None if it is not installed."""
    return shutil.which("mpirun")


def _library(path: str) -> str:
    """Return the path of the library that holds the code of the binary, "" when the binary does."""
    found = re.search(rf"{LIBRARY}\S* => (/\S+)", _output(["ldd", path]))
    return found[1] if found else ""


def _content(files: list[str]) -> str:
    h = hashlib.sha256()
    for file in files:
        with open(file, "rb") as f:
            h.update(hashlib.file_digest(f, "sha256").digest())
    return h.hexdigest()[:10]


def _package_version(path: str) -> str:
    """Return the version of the Debian package that owns the binary, "" elsewhere."""
    owner = _output(["dpkg-query", "--search", str(Path(path).resolve())]).split(":")[0]
    return _output(["dpkg-query", "--show", "--showformat=${Version}", owner]).strip() if owner else ""


def _banner_version(path: str) -> str:
    """Return the number that the first line of its help names, behind the edition where that is not the public one."""
    found = BANNER.search(_output([path, "-log", "none", "-h"], status=1))
    return f"{found[1].removeprefix('LIGGGHTS-PUBLIC')}-{found[2]}".lstrip("-") if found else ""


def _output(command: list[str], status: int = 0) -> str:
    """Return what a command prints, "" if it cannot be run, ends in another way or hangs."""
    try:
        done = subprocess.run(
            command, stdin=subprocess.DEVNULL, capture_output=True, timeout=20, check=False, env=one_thread_env()
        )
    except (OSError, subprocess.TimeoutExpired):
        return ""
    return done.stdout.decode("utf-8", errors="replace") if done.returncode == status else ""
