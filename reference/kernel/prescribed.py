"""`python -m reference.kernel.prescribed FOLDER`: drive the bodies of the deck in FOLDER along a given path.

path.npz holds x, v (S + 1, N, dim) and spin (S + 1, N, 1|3); row 0 is the set-up, at which nothing touches. In
every later row the laws see exactly these numbers, their memories moving on by dt; no integrator, gravity or
drag. reaction.npz receives force (S, N, dim) in N and torque (S, N, 1|3) in N m of rows 1..S.
"""

from __future__ import annotations

import dataclasses
import json
import sys
import time
from pathlib import Path

import numpy as np

from reference.kernel.deck import read_deck
from reference.kernel.model import Fixed, Model
from reference.kernel.simulation import Simulation

PATH, REACTION = "path.npz", "reaction.npz"


def driven(model: Model, x: np.ndarray, v: np.ndarray, spin: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return force (S, N, dim) and torque (S, N, 1|3) of rows 1..S of the path; shapes as in the module docstring.

    Contacts without tangential laws exert no torque: it is zero then. Raises ValueError for a path of other
    shape than the model, moving walls, or bodies that touch in row 0.
    """
    _refuse(model, x, v, spin)
    start = dataclasses.replace(model, x=x[0].T.copy(), v=v[0].T.copy(), spin=spin[0].T.copy(), gravity=None, drag=None)
    simulation = Simulation(start)
    if any(len(interaction.last.f_n) for interaction in simulation.interactions):
        raise ValueError(f"{PATH}: bodies touch in row 0, where nothing may touch")
    state, n = simulation.state, model.particle_count
    force, torque = np.zeros_like(x[1:]), np.zeros_like(spin[1:])
    for row in range(1, len(x)):
        state.x[:, :n], state.v[:, :n], state.spin[:, :n] = x[row].T, v[row].T, spin[row].T
        state.step = row
        simulation.renew_candidates()
        simulation.evaluate(advance=True)
        force[row - 1] = state.force[:, :n].T
        if state.torque is not None:
            torque[row - 1] = state.torque[:, :n].T
    return force, torque


def _refuse(model: Model, x: np.ndarray, v: np.ndarray, spin: np.ndarray) -> None:
    for name, given, rows in (("x", x, model.x), ("v", v, model.v), ("spin", spin, model.spin)):
        if given.shape != (len(x), *rows.T.shape):
            raise ValueError(f"{PATH}: {name}: expected shape {(len(x), *rows.T.shape)}, got {given.shape}")
    if model.rings:
        raise ValueError("prescribed motion: expected no rings, got one")
    if not all(isinstance(w.motion, Fixed) for w in model.walls):
        raise ValueError("prescribed motion: expected fixed walls, got one that moves")


def main(folder: Path) -> int:
    """Read the deck and the path, write the reaction; the last line of standard output is a finished marker."""
    start = time.process_time()
    model, _ = read_deck(folder)
    with np.load(folder / PATH) as path:
        force, torque = driven(model, path["x"], path["v"], path["spin"])
    np.savez(folder / REACTION, force=force, torque=torque)
    seconds = time.process_time() - start
    print(json.dumps({"finished": True, "steps": len(force), "timings": {"run": seconds}}))
    return 0


if __name__ == "__main__":
    sys.exit(main(Path(sys.argv[1])))
