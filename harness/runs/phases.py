"""CPU time of a run by phase, from what its engine tells by a clock of its own."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from harness.runs.outcome import Outcome


def cpu_parts(outcome: Outcome) -> dict[str, float]:
    """Return CPU seconds of the engine's process by phase: "run", and "setup", "output" where the engine tells them.

    Engines tell phases by a clock of their own: of the processor (they fit into the CPU time), or of the wall, which
    on a busy machine shows more; then CPU time is shared out as they are. Where the phases together exceed the elapsed
    time the output is a part of the run, and is taken off it.
    """
    told = {n: outcome.timings[n] for n in ("setup", "run", "output") if n in outcome.timings}
    whole, cpu, wall = sum(told.values()), outcome.cpu_seconds, outcome.wall_seconds
    if whole <= cpu:
        return told
    if whole > wall:
        told["run"] -= told.get("output", 0.0)
        whole = sum(told.values())
    return {name: cpu * seconds / whole for name, seconds in told.items()}
