"""How long the verification of an advice is expected to take: rough, said before anything is run."""

from __future__ import annotations

from typing import TYPE_CHECKING

from harness.engines.protocol import Engine, takes
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
        expected, more = expected_free(advice, engine), "; the oracle and timing come on top"
    else:
        expected, more = expected_bulk(advice, engine, packings=packings, workers=workers), ""
    row = time_row("verification", expected.seconds, expected.says + more)
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


def expected_free(advice: Advice, engine: Engine) -> Expected:
    """Return what the run of all phases takes, and the one that is timed."""
    systems = [p.system for p in free_case(advice).cases[0].phased]
    costs = [run_seconds(engine, s) for s in systems if engine.probe().available and takes(engine, s)]
    return Expected(seconds=longest_first(costs, 1), runs=len(costs), packings=0, at_once=1)
