"""From a study's cases to what was measured in them: packings shared, runs kept, one trajectory in memory at a time."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Generic, TypeVar

from harness.packing import Flow, Packing
from harness.runs.folder import runs_root
from harness.runs.outcome import Outcome
from harness.runs.pool import run_many
from harness.scene.laws import first_stiffness
from harness.scene.model import Biaxial
from harness.scene.resolve import resolve
from harness.studies.compare.study import distinct_engines
from harness.studies.prepare import Prepared, prepare
from harness.studies.reproduce.protocol import Ask, Case, StudyRun

if TYPE_CHECKING:
    from harness.scene.system import System
    from postproc.trajectory import Trajectory

T = TypeVar("T")


@dataclass(frozen=True, kw_only=True)
class Made(Generic[T]):
    """One run and what was measured in it; `found` is None unless it completed. packing: counted from 0."""

    case: str
    engine: str
    packing: int
    outcome: Outcome
    folder: Path
    found: T | None


Measure = Callable[["Case", "Trajectory", "System"], T]
"""What is measured in a finished run."""


def run_cases(ask: Ask, cases: Sequence[Case], measure: Measure) -> list[Made]:
    """Run every case from each of its packings on every engine; return all runs, in the order of the cases.

    What is kept is not run again, and a case that was interrupted goes on. Raises InputError for a wrong scene.
    """
    starts = _starts(ask, cases)
    plan = [(c, s, e) for c in cases for s in starts[c.name] for e in distinct_engines(ask.engines, c.scene)]
    done = run_many(
        [(f"{c.name} #{s.number + 1} {e.name}", e, s.system) for c, s, e in plan], runs_root(ask.out),
        time_limit=ask.time_limit, workers=ask.workers, executor=ask.executor, native="drop",
        progress=ask.progress and ask.progress(),
    )
    return [_made(c, s, e.name, d, measure) for (c, s, e), d in zip(plan, done, strict=True)]


def study_runs(made: Sequence[Made]) -> tuple[StudyRun, ...]:
    """Return the runs as a result lists them."""
    return tuple(StudyRun(engine=m.engine, case=m.case, packing=m.packing, outcome=m.outcome) for m in made)


def unsupported(made: Sequence[Made]) -> dict[str, str]:
    """Return why an engine computed nothing, by its name: it lacks a law, or is not installed."""
    refused = {m.engine: m.outcome.reason for m in made if m.outcome.status in ("unsupported", "unavailable")}
    return {e: why for e, why in refused.items() if not any(m.engine == e and m.found is not None for m in made)}


def by_engine(made: Sequence[Made], case: str) -> dict[str, dict[int, object]]:
    """Return what was found in a case, by engine and packing; engines in the order in which they ran."""
    found: dict[str, dict[int, object]] = {}
    for m in made:
        if m.case == case and m.found is not None:
            found.setdefault(m.engine, {})[m.packing] = m.found
    return found


def engines_of(made: Sequence[Made]) -> list[str]:
    """Return the engines that measured anything, in the order in which they ran."""
    return list(dict.fromkeys(m.engine for m in made if m.found is not None))


def _made(case: Case, start: Prepared, engine: str, done, measure: Measure) -> Made:
    from postproc.trajectory import read_trajectory

    found = None
    if done.outcome.status == "completed":
        found = measure(case, read_trajectory(done.folder / "trajectory.h5"), start.system)
    return Made(
        case=case.name, engine=engine, packing=start.number, outcome=done.outcome, folder=done.folder, found=found
    )


def _starts(ask: Ask, cases: Sequence[Case]) -> dict[str, list[Prepared]]:
    """Make the packings; cases with the same particles, pressure and first stiffness share theirs."""
    packed: dict[tuple, list[Packing | Flow | None]] = {}
    found = {}
    for c in cases:
        key = _packing_key(c)
        if key not in packed:
            made = prepare(c.scene, c.file, packings=c.packings, cache=ask.out / "packings", progress=ask.progress)
            packed[key] = [p.packing for p in made]
            found[c.name] = made
        else:
            found[c.name] = [
                Prepared(number=k, system=resolve(c.scene, c.file, p), packing=p) for k, p in enumerate(packed[key])
            ]
    return found


def _packing_key(case: Case) -> tuple:
    """Return what decides a case's packings; a ring's flow is its own."""
    scene = case.scene
    if not isinstance(scene, Biaxial):
        return (case.name,)
    return scene.particles, scene.preparation, first_stiffness(scene.contact.normal), case.packings
