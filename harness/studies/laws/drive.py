"""Drive every engine along the paths: one folder, one child process a run; what it answers is a value.

Finished runs are kept, verified and never made twice, as all runs are.
"""

from __future__ import annotations

import os
import threading
from collections.abc import Callable, Iterator, Mapping, Sequence
from concurrent.futures import Future, ThreadPoolExecutor, wait
from dataclasses import dataclass, field
from datetime import UTC, datetime
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

from harness.engines.child import children_stopped
from harness.engines.protocol import REFUSED, Reaction
from harness.runs.execute import outcome_of
from harness.runs.folder import deck_digest
from harness.runs.outcome import Outcome, Status, write_outcome
from harness.runs.signals import terminable
from harness.studies.laws.arrangement import Arrangement
from harness.studies.laws.kept import PathFile, PrescribedFolder, keep_reaction, read_reaction

if TYPE_CHECKING:
    from harness.engines.protocol import Engine, Probe, RunResult, Support
    from harness.scene.system import System
    from harness.studies.laws.cases import Laws

POLL = 1.0
"""Seconds between two words to whoever waits."""


@dataclass(frozen=True, kw_only=True)
class Job:
    """One combination of laws on one engine, in one arrangement."""

    laws: Laws
    engine: Engine
    arrangement: Arrangement


@dataclass(frozen=True, kw_only=True)
class Driven:
    """What became of a job. reason: one line, empty when completed. notes: what the engine computes only in part.

    kept: made by an earlier call.
    """

    job: Job
    status: Status
    reason: str
    notes: tuple[str, ...] = ()
    reaction: Reaction | None = None
    folder: Path | None = None
    kept: bool = False

    @property
    def engine(self) -> str:
        """The engine's name."""
        return self.job.engine.name

    @property
    def part(self) -> str:
        """Which arrangement it was, in words."""
        return part_name(self.job.arrangement)


def part_name(arrangement: Arrangement) -> str:
    """Return what people call an arrangement."""
    return f"{'pairs' if arrangement.partner == 'pair' else 'planes'} in {arrangement.dimension}D"


@dataclass(kw_only=True)
class Driver:
    """Where runs are made and how. making: names of the laws of which a run is really made."""

    root: Path
    time_limit: float
    workers: int
    making: set[str] = field(default_factory=set)
    _probes: dict[str, Probe] = field(default_factory=dict)
    _paths: dict[int, tuple[Arrangement, PathFile]] = field(default_factory=dict)
    _lock: threading.Lock = field(default_factory=threading.Lock)

    def each(
        self, groups: Sequence[Sequence[Job]], waiting: Callable[[int, float], None] | None = None
    ) -> Iterator[list[Driven]]:
        """Yield what became of each group of jobs, in the order given; later groups go on meanwhile.

        waiting: told about once a second which group is waited for, and which part of it is done. An interrupt ends
        the engines at once and goes on as KeyboardInterrupt or SystemExit.
        """
        with terminable(), ThreadPoolExecutor(self.workers) as pool:
            futures = [[pool.submit(self.drive, job) for job in group] for group in groups]
            try:
                for k, group in enumerate(futures):
                    while wait(group, timeout=POLL).not_done:
                        if waiting:
                            waiting(k, sum(f.done() for f in group) / len(group))
                    yield [f.result() for f in group]
                    futures[k] = []
            except BaseException:
                _stop([f for group in futures for f in group])
                raise

    def drive(self, job: Job) -> Driven:
        """Run one job; what the engine does wrong is an outcome, never an exception."""
        probe = self._probe(job.engine)
        if not probe.available:
            return Driven(job=job, status="unavailable", reason=probe.detail)
        system = job.arrangement.system(job.laws, _name(job))
        supports = job.engine.supports(system)
        refused = [_quote(s) for s in supports if s.level in REFUSED]
        if refused:
            return Driven(job=job, status="unsupported", reason="; ".join(refused))
        notes = tuple(_quote(s) for s in supports if s.level == "partial")
        return self._run(job, system, probe, notes)

    def _run(self, job: Job, system: System, probe: Probe, notes: tuple[str, ...]) -> Driven:
        deck, path = job.engine.render_prescribed(system), self._path(job.arrangement)
        folder = PrescribedFolder.of(self.root, system, job.engine.name, probe.version, path=path.digest)
        made = partial(outcome_of, job.engine, system, probe, deck_digest=deck_digest(deck), partial=notes)
        run = _Run(job=job, folder=folder, deck=deck, path=path, time_limit=self.time_limit)
        with folder.lock():
            kept = folder.completed(deck)
            if kept is None:
                self.making.add(job.laws.name)
                status, reason, reaction = run.make(made)
            else:
                status, reason, reaction = run.read()
        return Driven(
            job=job, status=status, reason=reason, notes=notes, reaction=reaction, folder=folder.path,
            kept=kept is not None,
        )

    def _path(self, arrangement: Arrangement) -> PathFile:
        """The same file for all laws; an arrangement that is kept here keeps its identity."""
        with self._lock:
            if id(arrangement) not in self._paths:
                self._paths[id(arrangement)] = arrangement, PathFile.of(self.root.absolute(), arrangement.path)
            return self._paths[id(arrangement)][1]

    def _probe(self, engine: Engine) -> Probe:
        with self._lock:
            if engine.name not in self._probes:
                self._probes[engine.name] = engine.probe()
            return self._probes[engine.name]


@dataclass(frozen=True, kw_only=True)
class _Run:
    """One run that is made, or was."""

    job: Job
    folder: PrescribedFolder
    deck: Mapping[str, str]
    path: PathFile
    time_limit: float

    def read(self) -> Answered:
        """Return what an earlier call kept; the path beside it is put back where it was lost."""
        self.path.put(self.folder.path)
        return read_reaction(self.folder.trajectory, self.job.arrangement.path)

    def make(self, outcome: Callable[..., Outcome]) -> Answered:
        """Make the folder, run, keep the reaction; outcome.json is the last file written."""
        start = {"started": datetime.now(UTC), "load_average": os.getloadavg()[0]}
        self.folder.prepare(self.deck)
        self.path.put(self.folder.path)
        result = self.job.engine.run_prescribed(self.folder.path, time_limit=self.time_limit)
        status, reason, reaction = self._answer(result)
        record = None if reaction is None else keep_reaction(self.folder.trajectory, reaction)
        write_outcome(self.folder.outcome, outcome(
            **start, status=status, reason=reason, trajectory=record, cpu_seconds=result.cpu_seconds,
            wall_seconds=result.wall_seconds, last_lines=result.last_lines, timings=result.timings,
        ))
        return status, reason, reaction

    def _answer(self, result: RunResult) -> Answered:
        if result.status != "completed":
            return result.status, result.reason or "the engine gave no reason", None
        if not self.path.is_in(self.folder.path):
            return "crashed", "the path was changed while the engine ran", None
        return read_reaction(self.folder.trajectory, self.job.arrangement.path)


Answered = tuple[Status, str, Reaction | None]
"""Status, reason, and the reaction of a completed run."""


def _name(job: Job) -> str:
    a = job.arrangement
    return f"{job.laws.name}-{a.partner}-{a.dimension}d"


def _stop(futures: list[Future]) -> None:
    begun = [f for f in futures if not f.cancel()]
    with children_stopped():
        wait(begun)


def _quote(support: Support) -> str:
    return f"{support.effect}: {support.level.replace('_', ' ')}: {support.note}"
