"""The ladder of time steps on a free scene: runs, oracles, times, slopes.

    cases x engines x rungs -> runs of many phases -> exits - oracle -> errors -> slopes;  sessions -> times
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from harness.engines.rounds import can_pin
from harness.engines.session import Session
from harness.runs.folder import runs_root
from harness.runs.outcome import usable_cores
from harness.runs.pool import Done, run_many
from harness.scene.grains import grains_of
from harness.scene.laws import head_on, turning
from harness.scene.resolve import resolve
from harness.studies.accuracy.cases import Case, cases_of
from harness.studies.accuracy.cost import Cost, measure_costs
from harness.studies.accuracy.exits import errors, exits_of, fault
from harness.studies.accuracy.fit import fit_order
from harness.studies.accuracy.keep import kept_oracle
from harness.studies.accuracy.oracle import Oracle, convention_of
from harness.studies.accuracy.phases import SEED, Phased, delays, stepped, with_phases
from harness.studies.accuracy.result import Point, Track
from harness.studies.accuracy.shown import Grouped
from harness.studies.accuracy.turn import largest_fraction

if TYPE_CHECKING:
    from harness.engines.protocol import Engine
    from harness.runs.progress import Progress
    from harness.scene.model import Free
    from harness.scene.system import System

SHORT = (0.16, 0.00125)
"""dt_fraction: range of the rungs that a case without some effects is run on; its slope is all that is asked of it."""

TIMED_STEPS = 4000
"""A session runs the finest rung that has at most as many steps: enough to be timed, and no more."""

FAMILIES = ("normal", "sliding", "rolling", "torsion")

TIME_LIMIT = 600.0
"""Seconds within which a session has to answer."""


@dataclass(frozen=True, kw_only=True)
class Ladder:
    """One case on all rungs. plain: the system without copies. values: dt_fraction as asked for. phased: by rung.

    contact_time: which steps are parts of, s. largest: dt_fraction beyond which the case's scene is refused.
    """

    case: Case
    plain: System
    values: tuple[float, ...]
    phased: tuple[Phased, ...]
    contact_time: float
    largest: float


class Ladders(NamedTuple):
    """All cases; contact_time: that which dt_fraction is a part of, s.

    finest: dt_fraction that oracles are finer than, None for that of each case.
    """

    cases: tuple[Ladder, ...]
    contact_time: float
    finest: float | None = None

    def finest_step(self, ladder: Ladder) -> float:
        """Return the step that the oracle of a case is finer than, s."""
        return (self.finest or min(ladder.values)) * self.contact_time


def ladders(scene: Free, file: Path, values: Sequence[float], phases: int, *, seed: int = SEED) -> Ladders:
    """Return the systems of all cases and rungs; all last as long as the scene and its longest step.

    seed: of the phases. Raises InputError for scenes without free flight.
    """
    declared = resolve(scene, file)
    grains = grains_of(scene, declared.particles)
    contact_time = head_on(scene.contact.normal, grains.pairs[0]).time_scale
    delay = delays(phases, max(values) * contact_time, seed)
    duration = scene.duration + max(values) * contact_time
    made = []
    for case in cases_of(scene):
        plain = declared.with_(**{f: getattr(case.scene.contact, f) for f in FAMILIES})
        rungs = tuple(values) if case.declared else _short(values)
        systems = (stepped(plain, f * contact_time, duration) for f in rungs)
        phased = tuple(with_phases(system, delay, file) for system in systems)
        made.append(Ladder(
            case=case, plain=plain, values=rungs, phased=phased, contact_time=contact_time,
            largest=largest_fraction(case.scene, grains),
        ))
    return Ladders(tuple(made), contact_time)


def _short(values: Sequence[float]) -> tuple[float, ...]:
    inside = tuple(v for v in values if SHORT[1] <= v <= SHORT[0])
    return inside if len(inside) >= 2 else tuple(values)


def climb(
    all_cases: Ladders, engines: Sequence[Engine], file: Path, out: Path, *, time_limit: float, workers: int | None,
    progress: Callable[[], Progress] | None,
) -> list[Track]:
    """Run everything that is not kept below `out` and return one track a case and engine."""
    oracles = _oracles(all_cases, engines, file, out, workers, progress)
    runs = _runs(all_cases, engines, out, time_limit=time_limit, workers=workers, progress=progress)
    tracks = []
    for ladder, costs in zip(all_cases.cases, _costs(all_cases, runs, out, progress), strict=True):
        mine = {c: oracles[ladder.case.name, c] for c in _conventions(ladder.case, engines)}
        tracks += [_track(ladder, e, runs, costs[e.name], mine) for e in engines]
    return tracks


def _conventions(case: Case, engines: Sequence[Engine]) -> list[str]:
    return list(dict.fromkeys(["talk", *(_limit_of(case, e) for e in engines)]))


def _limit_of(case: Case, engine: Engine) -> str:
    """Return the convention whose limit an engine tends to; where nothing rubs all are one."""
    return convention_of(engine.name) if turning(case.scene.contact) else "talk"


Runs = Mapping[tuple[str, str, int], Done]
"""By case, engine and number of the rung."""


def _runs(all_cases: Ladders, engines: Sequence[Engine], out: Path, *, progress, **options) -> Runs:
    plan = [(ladder, e, k) for ladder in all_cases.cases for e in engines for k in range(len(ladder.phased))]
    labels = [f"{ladder.case.name}, {e.name}" for ladder, e, _ in plan]
    jobs = [(f"{label}, rung {k + 1}", e, ladder.phased[k].system)
            for label, (ladder, e, k) in zip(labels, plan, strict=True)]
    shown = Grouped(labels, progress()) if progress else None
    done = run_many(jobs, runs_root(out), native="drop", progress=shown, **options)
    return {(ladder.case.name, e.name, k): d for (ladder, e, k), d in zip(plan, done, strict=True)}


# --- oracles -----------------------------------------------------------------------------------------


def oracle_plan(all_cases: Ladders, engines: Sequence[Engine]) -> list[tuple[Ladder, str]]:
    """Return the cases and the conventions that each has an oracle in."""
    return [(ladder, c) for ladder in all_cases.cases for c in _conventions(ladder.case, engines)]


def _oracles(
    all_cases: Ladders, engines: Sequence[Engine], file: Path, out: Path, workers: int | None,
    progress: Callable[[], Progress] | None,
) -> dict[tuple[str, str], Oracle]:
    plan = oracle_plan(all_cases, engines)
    labels = [f"oracle: {ladder.case.name}, {c}'s laws" for ladder, c in plan]
    from harness.runs.progress import Silent

    shown = progress() if progress else Silent()
    shown.begin(labels, [1.0] * len(plan))
    try:
        with ProcessPoolExecutor(min(workers or usable_cores(), len(plan))) as pool:
            tasks = [
                pool.submit(
                    kept_oracle, ladder.plain, c, kept=out / "oracles", file=file, contact_time=all_cases.contact_time,
                    finest=all_cases.finest_step(ladder),
                )
                for ladder, c in plan
            ]
            found = {}
            for number, ((ladder, c), task) in enumerate(zip(plan, tasks, strict=True)):
                shown.running(number, 0.0)
                found[ladder.case.name, c] = task.result()
                shown.done(number, f"{labels[number]}: {found[ladder.case.name, c].says}")
    finally:
        shown.end()
    return found


# --- times -------------------------------------------------------------------------------------------


def _costs(
    all_cases: Ladders, runs: Runs, out: Path, progress: Callable[[], Progress] | None
) -> list[dict[str, Cost]]:
    from harness.runs.progress import Silent

    shown, labels = progress() if progress else Silent(), [f"times: {c.case.name}" for c in all_cases.cases]
    shown.begin(labels, [1.0] * len(labels))
    core = max(_cores()) if can_pin() else None
    found = []
    try:
        for number, ladder in enumerate(all_cases.cases):
            shown.running(number, 0.0)
            found.append(_case_costs(ladder, runs, out, core))
            shown.done(number, f"{labels[number]}: {', '.join(_says(*c) for c in found[-1].items())}")
    finally:
        shown.end()
    return found


def _cores() -> set[int]:
    import os

    return os.sched_getaffinity(0)


def timed_rung(ladder: Ladder) -> int:
    """Return the number of the rung that sessions run: the finest that is short enough."""
    short = [k for k, p in enumerate(ladder.phased) if p.system.steps <= TIMED_STEPS]
    return short[-1] if short else 0


def _case_costs(ladder: Ladder, runs: Runs, out: Path, core: int | None) -> dict[str, Cost]:
    """Only engines with a run that passed its checks on the timed rung are timed."""
    rung = timed_rung(ladder)
    outcomes = {e: runs[case, e, k].outcome for case, e, k in runs if case == ladder.case.name and k == rung}
    good = {e: o for e, o in outcomes.items() if o.status == "completed"}
    measured = measure_costs(
        dict.fromkeys(good, ladder.phased[rung].system), {e: o.engine_version for e, o in good.items()},
        kept=out / "times", opener=lambda t, place: Session(t, place, core=core, time_limit=TIME_LIMIT),
    )
    return {e: measured.get(e) or Cost(reason=f"no time of a run that is {o.status}") for e, o in outcomes.items()}


def _says(engine: str, cost: Cost) -> str:
    return f"{engine} {cost.reason or f'{1e6 * cost.step:.3g} us a step'}"


# --- judging -----------------------------------------------------------------------------------------


def _track(ladder: Ladder, engine: Engine, runs: Runs, cost: Cost, oracles: Mapping[str, Oracle]) -> Track:
    exact = oracles[_limit_of(ladder.case, engine)]
    turns = bool(turning(ladder.case.scene.contact))
    points = tuple(
        _point(ladder, k, runs[ladder.case.name, engine.name, k], cost, exact, turns=turns)
        for k in range(len(ladder.values))
    )
    parted = errors(exact.exits, oracles["talk"].exits, ladder.plain, turns=turns)
    return Track(
        case=ladder.case.name, engine=engine.name, points=points, cost=cost, oracle=exact.error,
        oracle_says=exact.says, round_off=exact.round_off, growth=exact.growth,
        parted={q: float(v.max()) for q, v in parted.items()},
        fits={q: _fit(points, q, exact.error[q]) for q in exact.error},
    )


def _point(ladder: Ladder, rung: int, done: Done, cost: Cost, exact: Oracle, *, turns: bool) -> Point:
    from postproc.trajectory import read_frame

    phased, o = ladder.phased[rung], done.outcome
    status, reason, found = o.status, o.reason, {}
    if status == "completed":
        last = read_frame(done.folder / "trajectory.h5", 1)
        status, reason = fault(last, phased)
    if status == "completed":
        found = errors(exits_of(last, phased), exact.exits, ladder.plain, turns=turns)
    seconds = cost.step * phased.system.steps if status == "completed" and cost.step is not None else None
    ran = phased.system.dt / ladder.contact_time
    return Point(
        rung=ladder.values[rung], value=ran, dt=phased.system.dt, steps=phased.system.steps, status=status,
        reason=reason, errors=found, seconds=seconds, process_seconds=o.cpu_seconds,
        beyond=ladder.largest if ran > ladder.largest else None,
    )


def _fit(points: Sequence[Point], quantity: str, oracle: float):
    """Fit over the rungs on which a contact is resolved."""
    good = [p for p in points if p.resolved]
    if not good:
        return None
    return fit_order([p.dt for p in good], np.array([p.errors[quantity] for p in good]), oracle=oracle)
