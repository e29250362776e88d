"""How long a study of frontiers is expected to take: rough, said before anything is made."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np

from harness.report.expected import REPORT_SECONDS, longest_first
from harness.runs.outcome import usable_cores
from harness.scene.explain import time_row
from harness.scene.system import System
from harness.studies.frontier.packings import RANDOM, Packed, PackingCase, lattice, resting_system
from harness.studies.frontier.plan import (
    Case,
    chosen_engines,
    frontier_cases,
    late_packings,
    looked_steps,
    wanted_of,
)
from harness.studies.frontier.rest import unrest
from harness.studies.frontier.search import LOOKS, Wanted
from harness.studies.frontier.theory import felt_late

PLANNING_SECONDS = 0.2
"""A packing and its exact limits, of a case (measured: 7 s for 34)."""

LATE_SECONDS, LATE_FREEDOM = 5.0, 300
"""The limit of springs that are felt late, of so many degrees of freedom; it goes with the square (measured)."""


def announcement(*, full: bool, engines: Sequence[str] | None, workers: int | None) -> str:
    """Return a line on how long a study takes. Raises InputError."""
    chosen, late, cases = chosen_engines(engines), late_packings(full=full), frontier_cases(full=full)
    planning, seconds = 0.0, []
    for case in cases:
        rest = resting_system(case.packing, likely(case.packing), case.law)
        able = [] if _left_out(case, rest) else wanted_of(case, rest, chosen, late)[0]
        planning += PLANNING_SECONDS + sum(_late_seconds(rest) for e in able if felt_late(e.name, rest))
        seconds += [
            Wanted(label="", engine=e, rest=rest, guess=1.0, steps=looked_steps(e, rest)).seconds for e in able
        ]
    at_once = max(1, min(workers or usable_cores(), len(seconds)))
    whole = planning + longest_first(seconds, at_once) + REPORT_SECONDS
    side = f", {at_once} at a time" if at_once > 1 else ""
    row = time_row("frontier", whole, f"{len(seconds)} frontiers of about {LOOKS} runs each{side}, on idle cores")
    return (
        f"expected: about {row.text} for {row.note}, {planning:.0f} s of it for packings and exact limits; what --out "
        "holds already is not made again"
    )


def _left_out(case: Case, rest: System) -> bool:
    """Whether a lattice is no state at rest under the law; discs at random are brought to rest."""
    return case.packing.name != RANDOM.name and bool(unrest(rest))


def _late_seconds(rest: System) -> float:
    """Of the exact limit of springs that are felt late, from all eigenvalues."""
    moves = rest.particles.x.shape[1] + rest.particles.spin.shape[1]
    return LATE_SECONDS * (len(rest.particles) * moves / LATE_FREEDOM) ** 2


def likely(packing: PackingCase) -> Packed:
    """Return a lattice itself, which takes no time, and for discs at random as many on a lattice between walls.

    Their radii differ, as some codes do not take as many kinds.
    """
    if packing.name != RANDOM.name:
        return packing.make(Path())
    stand_in = lattice(np.zeros((1, 2)), np.ones(2), (10, 10))
    radius = np.linspace(0.9, 1.0, len(stand_in.x)) * stand_in.radius
    return Packed(x=stand_in.x, radius=radius, box=stand_in.box, walls=True)
