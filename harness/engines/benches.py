"""What takes part in `grainproof bench`, and how engines are timed: objects that follow `Timed`."""

from __future__ import annotations

from harness.engines.kernel.bench import PROGRAM, TEXTBOOK, TimedKernel
from harness.engines.lammps.bench import GRANULAR, HOOKE
from harness.engines.liggghts.bench import TIMED as LIGGGHTS
from harness.engines.timed import Timed
from reference.kernel.conventions import NAMED as CONVENTIONS

KERNEL: Timed = PROGRAM
"""What all others are compared with."""

BENCHES: tuple[Timed, ...] = (PROGRAM, TEXTBOOK, HOOKE, GRANULAR, LIGGGHTS)

AS_RUN: dict[str, Timed] = {"lammps": GRANULAR, "liggghts": LIGGGHTS}
"""How the codes that live here compute what their engines run."""


def timed_as(engine: str) -> Timed | None:
    """Return what computes as the engine of this name does; None for one elsewhere or on several processes."""
    if engine in AS_RUN:
        return AS_RUN[engine]
    family, _, convention = engine.partition(":")
    if family != "kernel" or convention not in CONVENTIONS:
        return None
    return TimedKernel(
        name=engine, evaluation="program", convention=convention, note=f"the program of in-place operations, {engine}"
    )
