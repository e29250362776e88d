"""Run an engine as a child process: time limit, own log files, its CPU time, its last words."""

from __future__ import annotations

import os
import signal
import subprocess
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

from harness.engines.guardian import Guardian

_guardian = Guardian()
_lock = threading.Lock()
_live: set[int] = set()
_stopped: set[int] = set()
_stopping = threading.Event()


class Stopped(KeyboardInterrupt):
    """The harness itself ended the child, so the engine has no outcome."""


@dataclass(frozen=True, kw_only=True)
class Child:
    """How a child process ended. `signal` is its name ("SIGSEGV") when a signal ended it, else ""."""

    returncode: int
    signal: str
    timed_out: bool
    cpu_seconds: float
    wall_seconds: float
    last_lines: tuple[str, ...]


def run_child(
    command: list[str], *, folder: Path, log: str, time_limit: float, env: dict[str, str] | None = None
) -> Child:
    """Run `command` in `folder`, standard output and error into the file `log` there.

    A child that outlives `time_limit` seconds is killed with all processes of its group; so is one that outlives
    the harness, even when that is killed.
    A command that cannot be started at all returns code 127 with the reason as last line.
    Raises Stopped when `children_stopped` ended the child or keeps it from starting.
    """
    start = time.monotonic()
    with open(folder / log, "wb") as out:
        try:
            process = _start(command, folder, out, one_thread_env() if env is None else env)
        except OSError as error:
            return Child(returncode=127, signal="", timed_out=False, cpu_seconds=0.0, wall_seconds=0.0,
                         last_lines=(str(error),))
        code, cpu, timed_out = _wait(process, time_limit)
    return Child(
        returncode=code,
        signal=signal.Signals(-code).name if code < 0 else "",
        timed_out=timed_out,
        cpu_seconds=cpu,
        wall_seconds=time.monotonic() - start,
        last_lines=last_lines(folder / log),
    )


def last_lines(path: Path, count: int = 12) -> tuple[str, ...]:
    """Return the last non-empty lines of a text file, undecodable bytes replaced."""
    if not path.exists():
        return ()
    with open(path, "rb") as f:
        f.seek(max(0, path.stat().st_size - 8192))
        text = f.read().decode("utf-8", errors="replace")
    return tuple(line.rstrip() for line in text.splitlines() if line.strip())[-count:]


def last_step(path: Path) -> int:
    """Return the first number of the last whole line of a table that an engine is still writing."""
    if not path.exists():
        return 0
    with open(path, "rb") as f:
        f.seek(max(0, path.stat().st_size - 4096))
        lines = f.read().decode("ascii", errors="replace").split("\n")[:-1]
    words = [line.replace(",", " ").split() for line in lines]
    steps = [w[0] for w in words if w and w[0].isdigit()]
    return int(steps[-1]) if steps else 0


def raise_if_stopping() -> None:
    """Raise Stopped while `children_stopped` holds; for whoever waits for something else than a child."""
    if _stopping.is_set():
        raise Stopped


@contextmanager
def children_stopped() -> Iterator[None]:
    """Kill the running children of all threads, and start none while this holds."""
    with _lock:
        _stopping.set()
        _stopped.update(_live)
        for pid in _live:
            os.killpg(pid, signal.SIGKILL)
    try:
        yield
    finally:
        _stopping.clear()


def _start(command: list[str], folder: Path, out, env: dict[str, str]) -> subprocess.Popen:
    with _lock:
        raise_if_stopping()
        process = subprocess.Popen(command, cwd=folder, stdin=subprocess.DEVNULL, stdout=out,
                                   stderr=subprocess.STDOUT, env=env, start_new_session=True)
        _live.add(process.pid)
    _guardian.watch(process.pid)
    return process


def _wait(process: subprocess.Popen, time_limit: float) -> tuple[int, float, bool]:
    """Wait, then reap: until it is reaped its pid cannot be another's, so killing it is safe."""
    expired = threading.Event()

    def kill() -> None:
        with _lock:
            if process.pid in _live:
                expired.set()
                os.killpg(process.pid, signal.SIGKILL)

    timer = threading.Timer(time_limit, kill)
    timer.daemon = True
    timer.start()
    try:
        os.waitid(os.P_PID, process.pid, os.WEXITED | os.WNOWAIT)
    except BaseException:
        os.killpg(process.pid, signal.SIGKILL)
        raise
    finally:
        timer.cancel()
        cpu, stopped = _reap(process)
    if stopped:
        raise Stopped
    return process.returncode, cpu, expired.is_set()


def _reap(process: subprocess.Popen) -> tuple[float, bool]:
    with _lock:
        _live.discard(process.pid)
        stopped = process.pid in _stopped
        _stopped.discard(process.pid)
    _guardian.release(process.pid)
    _, status, usage = os.wait4(process.pid, 0)
    process.returncode = os.waitstatus_to_exitcode(status)
    return usage.ru_utime + usage.ru_stime, stopped


FOREIGN_LAUNCHERS = ("SLURM_", "PMI_", "PMIX_")
"""Variables of whoever launched the harness itself. Open MPI takes them for its own orders: LIGGGHTS in a Slurm step,
started as it is here and not by srun, aborts before MPI_INIT (Slurm 22.05, Open MPI 4.1)."""


def one_thread_env() -> dict[str, str]:
    """Return the environment of an engine: one thread, and no word of a queue.

    One thread: fair timings, and no oversubscription by a pool of runs. An engine's own MPI starts on this machine.
    """
    kept = {k: v for k, v in os.environ.items() if not k.startswith(FOREIGN_LAUNCHERS)}
    return kept | dict.fromkeys(("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"), "1")
