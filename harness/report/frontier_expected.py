"""How long a study of frontiers is expected to take: rough, said before anything is made."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np

from harness.report.expected import REPORT_SECONDS, longest_first
from harness.runs.outcome import usable_cores
from harness.scene.explain import time_row
from harness.studies.frontier.packings import RANDOM, Packed, PackingCase, lattice, resting_system
from harness.studies.frontier.search import LOOKS, Wanted
from harness.studies.frontier.study import chosen_engines, frontier_cases, late_packings, looked_steps, wanted_of

PLANNING_SECONDS = 0.2
"""A packing and its exact limits, of a case (measured: 7 s for 34)."""


def announcement(*, full: bool, engines: Sequence[str] | None, workers: int | None) -> str:
    """Return a line on how long a study takes. Raises InputError."""
    chosen, late, cases = chosen_engines(engines), late_packings(full=full), frontier_cases(full=full)
    seconds = []
    for case in cases:
        rest = resting_system(case.packing, likely(case.packing), case.law)
        able, _ = wanted_of(case, rest, chosen, late)
        seconds += [
            Wanted(label="", engine=e, rest=rest, guess=1.0, steps=looked_steps(e, rest)).seconds for e in able
        ]
    at_once = max(1, min(workers or usable_cores(), len(seconds)))
    whole = PLANNING_SECONDS * len(cases) + longest_first(seconds, at_once) + REPORT_SECONDS
    side = f", {at_once} at a time" if at_once > 1 else ""
    row = time_row("frontier", whole, f"{len(seconds)} frontiers of about {LOOKS} runs each{side}, on idle cores")
    return f"expected: about {row.text} for {row.note}; what --out holds already is not made again"


def likely(packing: PackingCase) -> Packed:
    """Return a lattice itself, which takes no time, and for discs at random as many on a lattice between walls."""
    if packing.name != RANDOM.name:
        return packing.make(Path())
    stand_in = lattice(np.zeros((1, 2)), np.ones(2), (10, 10))
    return Packed(x=stand_in.x, radius=stand_in.radius, box=stand_in.box, walls=True)
