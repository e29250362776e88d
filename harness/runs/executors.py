"""Executors beyond this process' threads: the machine's cores, or a cluster's queue, through executorlib.

Each run asks for as many cores as it has MPI processes, in one Python process that starts the engine, and for as much
time as its limit; results go through the run folders, so ``--out`` has to lie on a file system that all nodes see.
What executorlib keeps of earlier calls is never asked: whether a run is finished and whole, its folder says.
"""

from __future__ import annotations

import os
import threading
from collections import deque
from collections.abc import Callable
from concurrent import futures
from concurrent.futures import BrokenExecutor, Executor, Future
from contextlib import AbstractContextManager, nullcontext
from functools import partial
from pathlib import Path
from typing import Literal, NamedTuple, get_args

from harness.errors import InputError
from harness.runs.lease import Lease, while_held
from harness.runs.outcome import usable_cores
from harness.runs.signals import deaf_threads, undisturbed

Kind = Literal["local", "slurm"]

KINDS: tuple[str, ...] = get_args(Kind)
INSTALL = 'pip install "grainproof[cluster]"'
MARGIN = 600.0
"""Seconds beyond an engine's time limit: the start of Python, reading and checking of the output."""
JOB = """\
#!/bin/bash
#SBATCH --job-name=grainproof
#SBATCH --output=job.out
#SBATCH --chdir={{working_directory}}
#SBATCH --nodes=1
#SBATCH --ntasks={{cores}}
#SBATCH --time={{[1, run_time_max // 60] | max}}

{{command}}
"""
"""What a queue is told of a run. It names no partition or account, so that Slurm's own defaults hold and those of
$SBATCH_PARTITION and $SBATCH_ACCOUNT; the line of pysqa's own script, which names an empty one, Slurm refuses."""
CACHE = ".executor"
"""Folder below the results: the lease that runs look at, and what executorlib passes on to a queue."""


class Requesting(Executor):
    """An executorlib executor behind the standard interface: what a run needs is read off what is submitted.

    lease: what runs look at while they are made, see `harness.runs.lease`; jobs of a queue have none, they outlive
    the harness.
    """

    def __init__(self, inner: Executor, *, timed: bool, lease: Lease | None = None, job: str | None = None):
        self._inner, self._timed, self._lease = inner, timed, lease
        self._job = {} if job is None else {"submission_template": job}

    def submit(self, fn: Callable, /, *args, **options) -> Future:
        """Submit ``fn(engine, ...)`` with a request for the engine's processes and its `time_limit`."""
        limit = options["time_limit"] if self._timed else None
        work = (fn, *args) if self._lease is None else (while_held, self._lease.path, fn, *args)
        return self._inner.submit(*work, resource_dict=request(args[0], limit) | self._job, **options)

    def stop(self) -> None:
        """End the runs that are being made, wherever they are; nothing can be submitted afterwards."""
        if self._lease is not None:
            self._lease.release()

    def shutdown(self, wait: bool = True, *, cancel_futures: bool = False) -> None:
        """End the inner one, then the lease."""
        with undisturbed():
            self._inner.shutdown(wait=wait, cancel_futures=cancel_futures)
            self.stop()


class _Waiting(NamedTuple):
    future: Future
    cores: int
    submit: Callable[[], Future]


class InTurn(Requesting):
    """Hands a run on only when its cores are free; one that wants more than there are gets all.

    executorlib, given a number of cores, waits for free ones in a loop that keeps a core busy, for ever if a run
    wants more, and starts a process even for what was cancelled.
    """

    def __init__(self, inner: Executor, *, cores: int, lease: Lease):
        super().__init__(inner, timed=False, lease=lease)
        self._cores = self._free = cores
        self._waiting: deque[_Waiting] = deque()
        self._all: set[Future] = set()
        self._lock = threading.RLock()

    def submit(self, fn: Callable, /, *args, **options) -> Future:
        """Submit ``fn(engine, ...)``, which waits for its turn."""
        cores = min(getattr(args[0], "ranks", 1), self._cores)
        run = _Waiting(Future(), cores, partial(super().submit, fn, *args, **options))
        with self._lock:
            self._all.add(run.future)
            self._waiting.append(run)
        self._hand_on()
        return run.future

    def _hand_on(self) -> None:
        with self._lock:
            while self._waiting and self._waiting[0].cores <= self._free:
                run = self._waiting.popleft()
                if run.future.set_running_or_notify_cancel():
                    self._free -= run.cores
                    self._begin(run)

    def _begin(self, run: _Waiting) -> None:
        try:
            run.submit().add_done_callback(partial(self._ended, run))
        except Exception as error:  # noqa: BLE001 (whoever waits for the run is to hear of it)
            self._free += run.cores
            run.future.set_exception(error)

    def _ended(self, run: _Waiting, made: Future) -> None:
        with self._lock:
            self._free += run.cores
        self._hand_on()
        error = made.exception()
        run.future.set_result(made.result()) if error is None else run.future.set_exception(error)

    def shutdown(self, wait: bool = True, *, cancel_futures: bool = False) -> None:  # noqa: ARG002
        """End when all that was submitted has ended, with `wait` or without, as the inner one is needed till then.

        cancel_futures: without what still waits for its turn.
        """
        for run in list(self._waiting) if cancel_futures else []:
            run.future.cancel()
        futures.wait(self._all)
        super().shutdown()


def lost(error: BaseException) -> bool:
    """Return whether an executor says that a worker or a job of a queue is gone: killed, out of memory, cancelled."""
    ours = type(error).__module__.startswith("executorlib") or str(error).startswith("executorlib: queue job")
    return isinstance(error, BrokenExecutor) or ours


def request(engine, time_limit: float | None) -> dict[str, int]:
    """Return what a run asks for, in executorlib's words; without a time limit no time, which only queues know.

    `cores` would start the function itself so many times; an engine starts its own processes, on the cores that
    executorlib calls threads.
    """
    cores = {"cores": 1, "threads_per_core": getattr(engine, "ranks", 1)}
    return cores if time_limit is None else cores | {"run_time_max": int(time_limit + MARGIN)}


def executor(kind: Kind | None, out: Path) -> AbstractContextManager[Executor | None]:
    """Return the executor that a user named; `out` is where results go. Raises InputError without executorlib.

    None was named: nothing, so that runs are made by threads of this process.

    slurm: inside an allocation ($SLURM_JOB_ID) runs are steps of it, by srun; elsewhere each is a job, by sbatch.
    """
    if kind is None:
        return nullcontext()
    try:
        import executorlib
    except ImportError:
        raise InputError(file="--executor", expected="executorlib", got="none installed", fix=INSTALL) from None
    inside = "SLURM_JOB_ID" in os.environ
    if kind == "slurm":
        _require("srun" if inside else "sbatch")
    cache = Path(out).absolute() / CACHE
    cache.mkdir(parents=True, exist_ok=True)
    _forget_results(cache)
    if kind == "slurm" and not inside:
        _require_pysqa()
        with deaf_threads():
            return Requesting(executorlib.SlurmClusterExecutor(cache_directory=str(cache)), timed=True, job=JOB)
    lease = Lease(cache)
    if kind == "slurm":
        return Requesting(executorlib.SlurmJobExecutor(disable_dependencies=True), timed=True, lease=lease)
    inner = executorlib.SingleNodeExecutor(disable_dependencies=True, hostname_localhost=True)
    return InTurn(inner, cores=usable_cores(), lease=lease)


def _require_pysqa() -> None:
    from importlib.util import find_spec

    if find_spec("pysqa") is None:
        raise InputError(
            file="--executor", expected="pysqa, through which executorlib asks a queue", got="none installed",
            fix=INSTALL,
        )


def _forget_results(cache: Path) -> None:
    """Delete what executorlib would answer with instead of asking again: a time-out, a run that was deleted since."""
    for result in cache.glob("*_o.h5"):
        result.unlink(missing_ok=True)


def _require(command: str) -> None:
    import shutil

    if shutil.which(command) is None:
        raise InputError(
            file="--executor", expected=f"Slurm's {command} on the path", got="none",
            fix="log in to the cluster, or use --executor local",
        )
