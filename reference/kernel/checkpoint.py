"""Where a long run stands, so that one that was killed goes on from there to the same last bit.

A checkpoint holds what a step changes: places, half-step velocities and forces of all nodes, the walls' motion, and
what every listed pair remembers. The list itself is found anew; results do not depend on it. With it go the length of
`series.csv` and the number of the closed part of the frames, so that what was written later is made again.
"""

from __future__ import annotations

import fcntl
import os
import zipfile
from pathlib import Path

import numpy as np

from reference.kernel.program.simulation import ProgramSimulation

CHECKPOINT = "checkpoint.npz"

EVERY = 60.0
"""CPU seconds between two checkpoints: shorter runs write none. One of 2000 discs takes 4 ms (measured)."""

OWNER = "running.lock"
"""Locked by the process that runs the deck: two must not write the same files."""


def owned(folder: Path) -> bool:
    """Return whether a process runs the deck in `folder` right now."""
    if not (folder / OWNER).exists():
        return False
    with open(folder / OWNER) as file:
        try:
            fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            return True
    return False


def write_checkpoint(
    folder: Path, simulation: ProgramSimulation, watched: dict[str, np.ndarray] | None = None, **outputs: float
) -> None:
    """Write the state of now, what was `watched` and numbers of the outputs: whole or not at all."""
    path, part = folder / CHECKPOINT, folder / f"{CHECKPOINT}.part"
    with open(part, "wb") as file:
        numbers = {f"output_{name}": value for name, value in outputs.items()}
        np.savez(file, **simulation.kept(), **(watched or {}), **numbers)
        file.flush()
        os.fsync(file.fileno())
    os.replace(part, path)


def read_checkpoint(folder: Path) -> tuple[dict[str, np.ndarray], dict[str, float]] | None:
    """Return the state and the outputs' numbers; None without a checkpoint, or with one that cannot be read."""
    try:
        with np.load(folder / CHECKPOINT) as file:
            everything = dict(file)
    except (OSError, ValueError, EOFError, KeyError, zipfile.BadZipFile):
        return None
    outputs = {n.removeprefix("output_"): v.item() for n, v in everything.items() if n.startswith("output_")}
    return {n: v for n, v in everything.items() if not n.startswith("output_")}, outputs
