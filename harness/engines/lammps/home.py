"""Where a LAMMPS lives: in this environment, or under another Python; what starts its children there."""

from __future__ import annotations

import json
import subprocess
import sys
from dataclasses import dataclass
from functools import cache
from pathlib import Path

from harness.engines import apart
from harness.engines.child import one_thread_env
from harness.engines.lammps.look import OLDEST_PYTHON
from harness.engines.lammps.wheel import mpi_launcher
from harness.engines.word import program_at
from harness.errors import InputError

CHILDREN = "harness.engines.lammps"
NEEDS = f"a Python (from {OLDEST_PYTHON[0]}.{OLDEST_PYTHON[1]} on) that has lammps and numpy"


@dataclass(frozen=True, kw_only=True)
class Home:
    """A Python with LAMMPS. place: as absolute path, "" for this one. build: of the library's content.

    date: of its version, yyyymmdd; 0 for this one, whose decks were proven.
    shown: what tables call it where its version alone would not tell it from another.
    """

    place: str = ""
    version: str = ""
    date: int = 0
    build: str = ""
    shown: str = ""
    library: str = ""
    launcher: str = ""

    def command(self, child: str) -> list[str]:
        """Return the command that runs one of the modules here as a child."""
        if self.place:
            return [self.place, str(Path(apart.__file__).resolve()), f"{CHILDREN}.{child}"]
        return [sys.executable, "-m", f"{CHILDREN}.{child}"]

    def mpiexec(self) -> str:
        """Return the path of its mpiexec, "" if there is none."""
        return self.launcher if self.place else str(mpi_launcher() or "")


HERE = Home()


def home_at(place: str) -> Home:
    """Return the LAMMPS of the Python at `place`; raises InputError when that is none, or has none."""
    python = program_at("lammps", place, NEEDS)
    found = _look(str(python))
    if "lacks" in found:
        got = f"one that lacks {found['lacks']}"
        fix = f"{python} -m pip install {found['install']}" if "install" in found else ""
        raise InputError(file=f"lammps@{place}", expected=NEEDS, got=got, fix=fix)
    return Home(place=str(python), **found)


@cache
def _look(python: str) -> dict:
    """Ask that Python; what is none, or hangs, lacks everything."""
    command = Home(place=python).command("look")
    try:
        done = subprocess.run(
            command, stdin=subprocess.DEVNULL, capture_output=True, timeout=60, check=False, env=one_thread_env()
        )
        return json.loads(done.stdout.decode(errors="replace").strip().splitlines()[-1])
    except subprocess.TimeoutExpired:
        return {"lacks": "an answer within 60 s"}
    except (OSError, ValueError, IndexError):
        return {"lacks": "everything: it does not answer as a Python with LAMMPS does"}
