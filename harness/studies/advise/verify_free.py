"""The advised step of a free scene at phases of its own, against the oracle that its ladder was held against.

The oracle is that of the scene as declared, in the engine's own laws, so that effects left out count as errors. The
ladder ran other phases of the step: an error that was right by the choice of phases is not right again.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from harness.scene.resolve import resolve
from harness.studies.accuracy.cases import Case
from harness.studies.accuracy.phases import SEED
from harness.studies.accuracy.result import Point, Track
from harness.studies.accuracy.steps import TIMED_STEPS, Ladders, climb, ladders
from harness.studies.advise.free_ladders import rms_error
from harness.studies.advise.study import Advice
from harness.studies.advise.verification import Side, Verification, verdict_of
from harness.studies.statistics.difference import Difference
from harness.studies.verdict import Verdict

if TYPE_CHECKING:
    from harness.engines.protocol import Engine
    from harness.runs.progress import Progress

OTHER = SEED + 1
"""Of the phases here."""


def verify_free(
    advice: Advice, engine: Engine, out: Path, *, time_limit: float, workers: int | None,
    progress: Callable[[], Progress] | None,
) -> Verification:
    """Run the advised scene at as many phases as the study has, and hold it against the oracle."""
    (track,) = climb(
        free_case(advice), [engine], advice.evidence.scene_file, out, time_limit=time_limit, workers=workers,
        progress=progress,
    )
    return _judged(advice, engine, track, track.points[0])


def free_case(advice: Advice) -> Ladders:
    """Return the advised scene as a ladder, to be held against the laws of the scene as declared.

    Its rungs are the advised one and, to be timed as ladders are, their finest one that is short enough; see
    `harness.studies.accuracy.steps`.
    """
    evidence, choice = advice.evidence, advice.choice
    step, rungs = choice.rungs["dt"].value, evidence.ladders[choice.engine]["dt"].rungs
    values = (step, *(r.value for r in rungs if r.value < step))
    made = ladders(advice.scene, evidence.scene_file, values, evidence.packings, seed=OTHER)
    (case, *_), contact_time, _ = made
    timed = max((k for k, p in enumerate(case.phased) if p.system.steps <= TIMED_STEPS), default=0)
    kept = sorted({0, timed})
    declared = replace(
        case, case=Case(name="as advised", scene=evidence.scene, declared=True),
        plain=resolve(evidence.scene, evidence.scene_file), values=tuple(values[k] for k in kept),
        phased=tuple(case.phased[k] for k in kept),
    )
    return Ladders((declared,), contact_time, min(values))


def _judged(advice: Advice, engine: Engine, track: Track, point: Point) -> Verification:
    evidence, choice = advice.evidence, advice.choice
    side = _side(advice, track, point)
    found = None if side.mean is None else Difference(
        value=side.mean, error=side.error, dof=len(side.values) - 1.0, count=len(side.values), paired=True
    )
    verdict, why, needed = _verdict(advice, side, found)
    return Verification(
        quantity=evidence.quantity, unit=evidence.unit, engine=engine.name, free=True, advised=side, reference=None,
        count=evidence.packings, scale=1.0, over="the largest relative speed at the start", tolerance=advice.tolerance,
        difference=found, expected=choice.total.error(1), remaining=track.oracle.get(evidence.quantity),
        verdict=verdict, why=why, needed=needed,
    )


def _side(advice: Advice, track: Track, point: Point) -> Side:
    errors = point.errors.get(advice.evidence.quantity)
    facts = {} if errors is None else {
        "values": errors[:, None], "mean": float(np.sqrt((errors**2).mean())),
        "error": math.hypot(rms_error(errors.tolist()), track.oracle[advice.evidence.quantity]),
    }
    return Side(
        name="advised", settings={"dt": point.value}, without=advice.choice.without, steps=point.steps,
        particles=len(resolve(advice.scene, advice.evidence.scene_file).particles), status=point.status,
        reason=point.reason, seconds=point.seconds, foretold_seconds=advice.choice.seconds, **facts,
    )


def _verdict(advice: Advice, side: Side, found: Difference | None) -> tuple[Verdict, str, int | None]:
    if found is not None:
        return verdict_of(found, advice.tolerance, "phases")
    if not side.good:
        return "not_checked", f"the advised run is {side.status.replace('_', ' ')}: {side.reason}", None
    return "not_checked", f"nothing of the advised scene has a {advice.evidence.quantity}", None
