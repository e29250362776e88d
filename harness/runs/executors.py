"""Executors beyond this process' threads: the machine's cores, or a cluster's queue, through executorlib.

Each run asks for as many cores as it has MPI processes, in one Python process that starts the engine, and for as much
time as its limit; results go through the run folders, so ``--out`` has to lie on a file system that all nodes see.
"""

from __future__ import annotations

import os
from collections.abc import Callable
from concurrent.futures import Executor, Future
from contextlib import AbstractContextManager, nullcontext
from pathlib import Path
from typing import Literal, get_args

from harness.errors import InputError

Kind = Literal["local", "slurm"]

KINDS: tuple[str, ...] = get_args(Kind)
INSTALL = 'pip install "grainproof[cluster]"'
MARGIN = 600.0
"""Seconds beyond an engine's time limit: the start of Python, reading and checking of the output."""
CACHE = ".executor"
"""Folder below the results where executorlib keeps what it passes on."""


class Requesting(Executor):
    """An executorlib executor behind the standard interface: what a run needs is read off what is submitted."""

    def __init__(self, inner: Executor, *, timed: bool):
        self._inner, self._timed = inner, timed

    def submit(self, fn: Callable, /, *args, **options) -> Future:
        """Submit ``fn(engine, ...)`` with a request for the engine's processes and its `time_limit`."""
        limit = options["time_limit"] if self._timed else None
        return self._inner.submit(fn, *args, resource_dict=request(args[0], limit), **options)

    def shutdown(self, wait: bool = True, *, cancel_futures: bool = False) -> None:
        """End the inner one."""
        self._inner.shutdown(wait=wait, cancel_futures=cancel_futures)


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
    cache = Path(out).absolute() / CACHE
    cache.mkdir(parents=True, exist_ok=True)
    if kind == "local":
        from harness.runs.outcome import usable_cores

        return Requesting(executorlib.SingleNodeExecutor(
            max_cores=usable_cores(), cache_directory=str(cache), hostname_localhost=True,
        ), timed=False)
    inside = "SLURM_JOB_ID" in os.environ
    _require("srun" if inside else "sbatch")
    slurm = executorlib.SlurmJobExecutor if inside else executorlib.SlurmClusterExecutor
    return Requesting(slurm(cache_directory=str(cache)), timed=True)


def _require(command: str) -> None:
    import shutil

    if shutil.which(command) is None:
        raise InputError(
            file="--executor", expected=f"Slurm's {command} on the path", got="none",
            fix="log in to the cluster, or use --executor local",
        )
