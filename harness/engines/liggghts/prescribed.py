"""Prescribed motion: ``python -m harness.engines.liggghts.prescribed FOLDER [LIBRARY]``.

Every row of path.npz is written into the running instance through its C library, which then makes one step
without an integrator: it renews its neighbour lists, moves histories on by dt and evaluates the laws exactly there.
Forces and torques go to reaction.npz. This process must not load LAMMPS: both bring an MPI of their own.
"""

from __future__ import annotations

import ctypes
import os
import sys

import numpy as np

from harness.engines.liggghts.deck import FINISHED, INPUT
from harness.engines.liggghts.lab import ROOM
from harness.engines.protocol import PATH_FILE, REACTION_FILE

LIBRARY = "libliggghts.so.3"


class Instance:
    """LIGGGHTS in this process; an error of its own ends the process, with its message on standard output."""

    def __init__(self, library: str = LIBRARY):
        self.library = ctypes.CDLL(library)
        self.library.lammps_extract_atom.restype = ctypes.c_void_p
        self.library.lammps_extract_global.restype = ctypes.c_void_p
        words = [b"liggghts", b"-log", b"none"]
        self.handle = ctypes.c_void_p()
        self.library.lammps_open_no_mpi(
            len(words), (ctypes.c_char_p * len(words))(*words), ctypes.byref(self.handle)
        )

    def command(self, line: str) -> None:
        """Execute one command."""
        self.library.lammps_command(self.handle, line.encode())

    def read(self, file: str) -> None:
        """Execute the commands of a file."""
        self.library.lammps_file(self.handle, file.encode())

    def close(self) -> None:
        """End the instance."""
        self.library.lammps_close(self.handle)

    @property
    def atoms(self) -> int:
        """Number of atoms."""
        return ctypes.cast(self.library.lammps_extract_global(self.handle, b"nlocal"), ctypes.POINTER(ctypes.c_int))[0]

    def ids(self) -> np.ndarray:
        """Return a view of the ids, (N,)."""
        return self._array(b"id", ctypes.c_int)

    def radii(self) -> np.ndarray:
        """Return a view of the radii, (N,) in m."""
        return self._array(b"radius", ctypes.c_double)

    def vectors(self, name: str) -> np.ndarray:
        """Return a view of x, v, omega, f or torque, (N, 3); valid until the next command."""
        rows = ctypes.cast(
            self.library.lammps_extract_atom(self.handle, name.encode()),
            ctypes.POINTER(ctypes.POINTER(ctypes.c_double)),
        )
        return np.ctypeslib.as_array(rows[0], shape=(self.atoms, 3))

    def _array(self, name: bytes, kind) -> np.ndarray:
        start = ctypes.cast(self.library.lammps_extract_atom(self.handle, name), ctypes.POINTER(kind))
        return np.ctypeslib.as_array(start, shape=(self.atoms,))


class Bodies:
    """The bodies of an instance by id, 1..N, in as many dimensions as the path has."""

    def __init__(self, instance: Instance, dimension: int):
        self.instance = instance
        self.axes = slice(0, dimension)
        self.spin_axes = slice(2, 3) if dimension == 2 else slice(0, 3)

    def place(self, x: np.ndarray, v: np.ndarray, spin: np.ndarray) -> None:
        """Give all bodies a place, a velocity, (N, dim), and a spin, (N, 1|3)."""
        rows = np.argsort(self.instance.ids())
        for name, axes, values in (("x", self.axes, x), ("v", self.axes, v), ("omega", self.spin_axes, spin)):
            self.instance.vectors(name)[rows, axes] = values

    def reaction(self) -> tuple[np.ndarray, np.ndarray]:
        """Return forces (N, dim) and torques (N, 1|3)."""
        rows = np.argsort(self.instance.ids())
        return self.instance.vectors("f")[rows, self.axes], self.instance.vectors("torque")[rows, self.spin_axes]


def drive(instance: Instance, path: dict[str, np.ndarray]) -> tuple[np.ndarray, np.ndarray]:
    """Lead the bodies along the path; return forces (S, N, dim) and torques (S, N, 1|3) of rows 1..S.

    Raises ValueError where the path does not fit the deck.
    """
    _refuse(instance, path["x"])
    bodies = Bodies(instance, path["x"].shape[2])
    states = zip(path["x"], path["v"], path["spin"], strict=True)
    bodies.place(*next(states))
    instance.command("run 0 post no")
    found = []
    for state in states:
        bodies.place(*state)
        instance.command("run 1 pre no post no")
        found.append(bodies.reaction())
    force, torque = (np.array(values) for values in zip(*found, strict=True))
    return force, torque


def _refuse(instance: Instance, x: np.ndarray) -> None:
    if x.shape[1] != instance.atoms:
        raise ValueError(f"{PATH_FILE} has {x.shape[1]} bodies, the deck {instance.atoms}")
    placed = instance.vectors("x")[np.argsort(instance.ids()), : x.shape[2]]
    if not np.abs(x - placed).max() <= ROOM * instance.radii().max():  # also when a number is NaN
        raise ValueError(f"{PATH_FILE} leads a body more than {ROOM:g} radii away from its place in {INPUT}")


def main(folder: str, library: str = LIBRARY) -> int:
    """Drive the deck in `folder`; return the exit status. Raises OSError, ValueError."""
    os.chdir(folder)
    with np.load(PATH_FILE) as saved:
        path = {name: saved[name] for name in ("x", "v", "spin")}
    instance = Instance(library)
    instance.read(INPUT)
    force, torque = drive(instance, path)
    atoms = instance.atoms
    instance.close()
    np.savez(REACTION_FILE, force=force, torque=torque)
    if not (np.isfinite(force).all() and np.isfinite(torque).all()):
        raise ValueError("not all forces and torques are finite")
    print(f"{FINISHED} step {len(force)} of {len(path['x']) - 1} with {atoms} of {force.shape[1]} atoms", flush=True)
    return 0


if __name__ == "__main__":
    try:
        status = main(*sys.argv[1:])
    except (OSError, ValueError) as error:
        print(f"ERROR: {error}", flush=True)
        status = 1
    sys.exit(status)
