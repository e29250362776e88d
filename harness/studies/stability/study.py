"""The gauntlet: every chosen hard case on every engine, each run judged by its invariants."""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from harness.engines.registry import choose_alone
from harness.runs.folder import runs_root
from harness.runs.outcome import Host, host_facts
from harness.runs.pool import Done, run_many
from harness.studies.prepare import prepare
from harness.studies.stability.cases import Case, all_cases, choose_cases, with_twins
from harness.studies.stability.judge import Result, judge_refusal, judge_run
from harness.studies.stability.seen import Seen
from postproc.trajectory import read_trajectory

if TYPE_CHECKING:
    from harness.engines.protocol import Engine
    from harness.runs.progress import Progress
    from harness.scene.system import System

USUAL = ("lammps", "liggghts", "kernel:talk")
"""The codes, and the kernel with the laws of the talks."""

TIME_LIMIT = 1800.0


@dataclass(frozen=True, kw_only=True)
class Stability:
    """Everything a report needs. results: a row for every case and engine, cases in the order of `cases`.

    wall_seconds: of the whole study this time.
    """

    cases: tuple[Case, ...]
    engines: tuple[str, ...]
    results: tuple[Result, ...]
    host: Host
    wall_seconds: float

    def of(self, case: str, engine: str) -> Result:
        """Return the result of a case on an engine."""
        return next(r for r in self.results if (r.case, r.engine) == (case, engine))

    @property
    def surprises(self) -> tuple[Result, ...]:
        """What ended otherwise than declared, or may never be."""
        return tuple(r for r in self.results if not r.as_declared or r.kernel_failed_silently)

    @property
    def exit_status(self) -> int:
        """1 when something ended otherwise than declared, the kernel failed silently, or no run was made at all."""
        ran = any(r.ended not in ("unsupported", "unavailable") for r in self.results)
        return 0 if ran and not self.surprises else 1


def stability(
    names: Sequence[str], out: Path, *, engines: Sequence[str] | None = None, long: bool = False,
    time_limit: float = TIME_LIMIT, workers: int | None = None, folder: Path | None = None,
    progress: Callable[[], Progress] | None = None,
) -> Stability:
    """Run the named cases, or the standard set; runs are kept below `out` and reused.

    folder: where cases are; the shipped ones unless given. Raises InputError for an unknown case or engine, and for a
    case that is wrong, before anything is written.
    """
    begun = time.monotonic()
    known = all_cases(folder)
    chosen = choose_cases(known, names, long=long)
    codes = choose_alone(list(engines or USUAL))
    runs = _runs(with_twins(chosen, known), codes, out, time_limit=time_limit, workers=workers, progress=progress)
    return Stability(
        cases=chosen, engines=tuple(e.name for e in codes), host=host_facts(),
        results=tuple(_result(case, engine.name, runs) for case in chosen for engine in codes),
        wall_seconds=time.monotonic() - begun,
    )


@dataclass(frozen=True, kw_only=True)
class _Made:
    """A run and what is seen of it; the trajectory is read when it is asked for."""

    system: System
    done: Done

    def seen(self) -> Seen | None:
        if self.done.outcome.status != "completed":
            return None
        return Seen(system=self.system, trajectory=read_trajectory(self.done.folder / "trajectory.h5"))


def _runs(
    cases: Sequence[Case], engines: Sequence[Engine], out: Path, *, time_limit: float, workers: int | None,
    progress: Callable[[], Progress] | None,
) -> dict[tuple[str, str], _Made]:
    """Make all runs, the packings they need first."""
    systems = {c.name: _system(c, out, progress) for c in cases if c.scene is not None}
    jobs = [(f"{name}, {e.name}", e, system) for name, system in systems.items() for e in engines]
    shown = progress() if progress else None
    made = run_many(jobs, runs_root(out), time_limit=time_limit, workers=workers, progress=shown)
    keys = [(name, e.name) for name in systems for e in engines]
    return {key: _Made(system=systems[key[0]], done=done) for key, done in zip(keys, made, strict=True)}


def _system(case: Case, out: Path, progress: Callable[[], Progress] | None) -> System:
    return prepare(case.scene, case.file, packings=1, cache=out / "packings", progress=progress)[0].system


def _result(case: Case, engine: str, runs: Mapping[tuple[str, str], _Made]) -> Result:
    if case.scene is None:
        return judge_refusal(case, engine)
    run = runs[case.name, engine]
    twins = {name: runs[name, engine].seen() for name in case.twins}
    return judge_run(case, engine, run.done.outcome, run.seen(), twins)
