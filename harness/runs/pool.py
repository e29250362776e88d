"""Many runs side by side: longest first, one failure ends nothing, an interrupt ends everything at once.

Threads suffice by default: an engine computes in its own process, the thread only waits. Reading
output does compute in the thread; where that dominates give a `ProcessPoolExecutor` (engines and
systems must pickle) or a cluster's executor: anything that follows `concurrent.futures.Executor`.
"""

from __future__ import annotations

import os
from collections.abc import Iterable
from concurrent.futures import FIRST_COMPLETED, Executor, Future, ThreadPoolExecutor, wait
from contextlib import nullcontext
from dataclasses import dataclass
from datetime import UTC, datetime
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

from harness.engines.child import children_stopped
from harness.runs.cores import Cores, cores_for
from harness.runs.execute import outcome_of, run_one
from harness.runs.executors import Requesting, lost
from harness.runs.folder import RunFolder, require_root
from harness.runs.native import NativePolicy
from harness.runs.outcome import Outcome, describe_outcome, host_facts, usable_cores
from harness.runs.progress import Progress, Silent
from harness.runs.signals import hear_no_more, terminable

if TYPE_CHECKING:
    from harness.engines.protocol import Engine, Probe
    from harness.scene.system import System

POLL = 1.0
"""Seconds between two looks at the engines' progress."""


class Job(NamedTuple):
    """A run to be made; `label` is how the caller and the progress display call it."""

    label: str
    engine: Engine
    system: System


class Done(NamedTuple):
    """A run that was made, or reused, or refused."""

    label: str
    outcome: Outcome
    folder: Path


@dataclass(frozen=True, kw_only=True)
class _Planned:
    number: int
    job: Job
    probe: Probe
    folder: RunFolder
    cost: float
    since: datetime

    def begun(self) -> bool:
        """Return whether the run is being made; before, a finished one may still be found to be good."""
        return self.folder.path.exists() and not self.folder.outcome.exists()

    def last_words(self, outcome: Outcome) -> str:
        """Say how the run ended, and of one that is older than this call that it was kept; no name twice."""
        kept = f"kept, made {outcome.finished:%Y-%m-%d %H:%M} UTC: " if outcome.started < self.since else ""
        named = (outcome.scene_name, outcome.engine, f"{outcome.scene_name}, {outcome.engine}")
        label = "" if self.job.label in named else f"{self.job.label}: "
        return f"{label}{kept}{describe_outcome(outcome)}"

    def lost(self, error: BaseException) -> Outcome:
        """Return the outcome of a run whose worker is gone; its folder is unfinished, the next call makes it."""
        return outcome_of(
            self.job.engine, self.job.system, self.probe, started=self.since, load_average=os.getloadavg()[0],
            status="crashed", reason=f"whoever made this run is gone: {error}",
        )

    def fraction(self) -> float:
        """Return the part of the steps that is done, 0 while the engine's table cannot be read."""
        try:
            return min(1.0, self.job.engine.steps_done(self.folder.path) / self.job.system.steps)
        except (OSError, ValueError):
            return 0.0


def run_many(
    jobs: Iterable[tuple[str, Engine, System]], root: Path, *, time_limit: float, workers: int | None = None,
    executor: Executor | None = None, progress: Progress | None = None, force: bool = False,
    native: NativePolicy = "gzip",
) -> list[Done]:
    """Run all jobs (label, engine, system) by `run_one`; return what became of them in the order given.

    workers: how many processes at a time, the number of usable cores unless given; a run of several MPI processes
    takes as many places. An `executor` has its own.
    progress: see `harness.runs.progress.progress_for`; nothing is shown without.

    On an interrupt (Ctrl-C, SIGTERM, SIGHUP) nothing more is started, engines are killed and their
    folders stay unfinished; output that is just being read is kept; then KeyboardInterrupt or
    SystemExit goes on. Those of `harness.runs.executors` end their engines, too, except for jobs of a queue; another
    executor of other processes has to see to its own: Ctrl-C in a terminal reaches them, a signal to this process
    alone does not.
    Errors of the harness are raised together, as ExceptionGroup, once all other jobs are done; the
    runs of those are on disk. Raises InputError when runs cannot be kept at `root`.
    """
    require_root(Path(root))
    plan = _plan([Job(*job) for job in jobs], Path(root))
    progress = progress or Silent()
    host_facts()  # of the machine, not of the core that a thread may be pinned to
    workers = max(1, min(workers or usable_cores(), len(plan)))
    futures: dict[Future, _Planned] = {}
    with terminable(), nullcontext(executor) if executor else ThreadPoolExecutor(workers) as pool:
        try:
            progress.begin([p.job.label for p in plan], [p.cost for p in plan])
            cores = None if executor else cores_for(workers)
            for p in sorted(plan, key=lambda p: -p.cost):
                futures[_submit(pool, cores, p, root, time_limit=time_limit, force=force, native=native)] = p
            _watch(futures, progress)
        except BaseException:
            _stop(futures, executor)
            raise
        finally:
            progress.end()
    return _collect(futures)


def _plan(jobs: list[Job], root: Path) -> list[_Planned]:
    """Ask each engine once for its version; the folder follows from it, and with it the progress."""
    since = datetime.now(UTC)
    probes = {id(engine): engine.probe() for engine in {id(j.engine): j.engine for j in jobs}.values()}
    return [
        _Planned(
            number=number,
            job=job,
            probe=probes[id(job.engine)],
            folder=RunFolder.of(root, job.system, job.engine.name, probes[id(job.engine)].version),
            cost=job.engine.microseconds_per_step(job.system) * job.system.steps,
            since=since,
        )
        for number, job in enumerate(jobs)
    ]


def _submit(pool: Executor, cores: Cores | None, planned: _Planned, root: Path, **options) -> Future:
    """Submit to an executor of somebody else, or to our threads, where a run waits for its cores."""
    work = (planned.job.engine, planned.job.system, root)
    options["probe"] = planned.probe
    return pool.submit(run_one, *work, **options) if cores is None else pool.submit(_run_on, cores, *work, **options)


def _run_on(cores: Cores, engine: Engine, *work, **options) -> tuple[Outcome, Path]:
    with cores.taken(getattr(engine, "ranks", 1)):
        return run_one(engine, *work, **options)


def _watch(futures: dict[Future, _Planned], progress: Progress) -> None:
    """Tell `progress` what happens until all are done."""
    pending = set(futures)
    while pending:
        done, pending = wait(pending, timeout=POLL, return_when=FIRST_COMPLETED)
        for future in done:
            progress.done(futures[future].number, _last_words(future, futures[future]))
        for future in pending:
            if future.running() and futures[future].begun():
                progress.running(futures[future].number, futures[future].fraction())


def _last_words(future: Future, planned: _Planned) -> str:
    error, label = future.exception(), planned.job.label
    if error is None:
        return planned.last_words(future.result()[0])
    if isinstance(error, KeyboardInterrupt):  # a worker process met the interrupt first
        raise error
    if lost(error):
        return planned.last_words(planned.lost(error))
    return f"{label}: error in the harness: {type(error).__name__}: {error}"


def _stop(futures: dict[Future, _Planned], executor: Executor | None) -> None:
    hear_no_more()
    begun = [future for future in futures if not future.cancel()]
    with children_stopped():
        if isinstance(executor, Requesting):
            executor.stop()
        wait(begun)


def _collect(futures: dict[Future, _Planned]) -> list[Done]:
    errors, results = [], {}
    for future, planned in futures.items():
        error = future.exception()
        if error is None:
            results[planned.number] = Done(planned.job.label, *future.result())
        elif lost(error):
            results[planned.number] = Done(planned.job.label, planned.lost(error), planned.folder.path)
        else:
            error.add_note(f"in job '{planned.job.label}', folder {planned.folder.path}")
            errors.append(error)
    if errors:
        raise BaseExceptionGroup(f"{len(errors)} of {len(futures)} jobs met an error of the harness", errors)
    return [results[number] for number in sorted(results)]
