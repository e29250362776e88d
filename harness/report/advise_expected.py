"""How long the verification of an advice is expected to take: rough, said before anything is run."""

from __future__ import annotations

from typing import TYPE_CHECKING

from harness.engines.protocol import Engine, takes
from harness.report.accuracy_expected import expected_climb
from harness.report.expected import Expected, likely_system, longest_first, packing_seconds, run_seconds
from harness.runs.outcome import usable_cores
from harness.scene.explain import time_row
from harness.studies.advise.verify import packing_count, settings_of
from harness.studies.advise.verify_free import free_case

if TYPE_CHECKING:
    from harness.studies.advise.study import Advice


def verification_announcement(advice: Advice, engine: Engine, *, packings: int | None, workers: int | None) -> str:
    """Return a line on how long `verify` takes."""
    if advice.evidence.free:
        expected = expected_climb(free_case(advice), [engine], workers=workers)
    else:
        expected = expected_bulk(advice, engine, packings=packings, workers=workers)
    row = time_row("verification", expected.seconds, expected.says)
    return f"expected: verification, about {row.text} for {row.note}"


def expected_bulk(advice: Advice, engine: Engine, *, packings: int | None, workers: int | None) -> Expected:
    """Return what the advised setting and its reference take, packings included."""
    file, count = advice.evidence.scene_file, packing_count(advice, packings)
    systems = [(s.scene, likely_system(s.scene, file)) for s in settings_of(advice) if not s.reason]
    able = [s for _, s in systems if engine.probe().available and takes(engine, s)]
    costs = [run_seconds(engine, s) for s in able] * count
    at_once = max(1, min(workers or usable_cores(), len(costs)))
    packed = sum(packing_seconds(*of) for of in systems)
    return Expected(
        seconds=packed * count / at_once + longest_first(costs, at_once), runs=len(costs), packings=count,
        at_once=at_once,
    )

