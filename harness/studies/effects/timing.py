"""Timing of all engines, one after the other, with a display of how far it is."""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

from harness.engines.protocol import Engine
from harness.engines.rounds import can_pin
from harness.engines.session import Session
from harness.runs.progress import Silent
from harness.scene.system import System
from harness.studies.effects.cost import TIME_LIMIT, StepCost, step_costs
from harness.studies.effects.variants import BASE

if TYPE_CHECKING:
    from harness.runs.progress import Progress


def time_engines(
    engines: Sequence[Engine], systems: Mapping[str, System], kept: Path, *, progress: Progress | None
) -> dict[tuple[str, str], StepCost]:
    """Return the costs by engine and variant; systems: one each, BASE among them."""
    shown, labels = progress or Silent(), [f"times: {e.name}" for e in engines]
    core = max(os.sched_getaffinity(0)) if can_pin() else None
    found: dict[tuple[str, str], StepCost] = {}
    shown.begin(labels, [1.0] * len(labels))
    try:
        for number, engine in enumerate(engines):
            shown.running(number, 0.0)
            costs = step_costs(
                engine.name, engine.probe().version, systems, kept=kept, told=partial(shown.running, number),
                opener=lambda timed, place: Session(timed, place, core=core, time_limit=TIME_LIMIT),
            )
            found |= {(engine.name, name): cost for name, cost in costs.items()}
            shown.done(number, f"{labels[number]}: {_says(costs)}")
    finally:
        shown.end()
    return found


def _says(costs: Mapping[str, StepCost]) -> str:
    base = costs[BASE]
    timed = sum(c.step is not None for c in costs.values())
    return base.reason or f"{1e6 * base.step:.3g} us a step as declared, {timed} of {len(costs)} variants"
