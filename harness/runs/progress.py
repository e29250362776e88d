"""How far the runs are: bars with the time left on a terminal, a few plain lines elsewhere."""

from __future__ import annotations

import sys
import time
from collections.abc import Callable
from dataclasses import dataclass
from typing import Protocol, TextIO

QUIET = 10.0
"""Seconds between two plain lines of one job, at least."""

SILENT = 60.0
"""Seconds after which a line comes even without a tenth of progress: build servers kill silent jobs."""


class Progress(Protocol):
    """Told by `run_many` what happens; jobs are named by their number in the caller's list."""

    def begin(self, labels: list[str], costs: list[float]) -> None:
        """All jobs, with their expected cost in any common unit."""

    def running(self, job: int, fraction: float) -> None:
        """The job is under way, `fraction` of its steps done; called about once a second."""

    def done(self, job: int, line: str) -> None:
        """The job has ended; `line` says how."""

    def end(self) -> None:
        """No job is running any more; called once, also after an interrupt."""


def progress_for(stream: TextIO | None = None) -> Progress:
    """Return bars if `stream` (standard error unless given) is a terminal, else plain lines."""
    stream = sys.stderr if stream is None else stream
    return Bars(stream) if stream.isatty() else Lines(stream)


class Silent:
    """Shows nothing."""

    def begin(self, labels: list[str], costs: list[float]) -> None:
        """See Progress."""

    def running(self, job: int, fraction: float) -> None:
        """See Progress."""

    def done(self, job: int, line: str) -> None:
        """See Progress."""

    def end(self) -> None:
        """See Progress."""


@dataclass
class _Shown:
    """What the last line of a job said, and when."""

    since: float
    at: float
    fraction: float


class Lines:
    """A line when a job starts, about every tenth of it (at most every QUIET s), and when it ends."""

    def __init__(self, stream: TextIO, clock: Callable[[], float] = time.monotonic):
        self._stream, self._clock = stream, clock
        self._labels: list[str] = []
        self._shown: dict[int, _Shown] = {}
        self._ended = 0

    def begin(self, labels: list[str], costs: list[float]) -> None:  # noqa: ARG002 (bars need the costs)
        """See Progress."""
        self._labels = labels

    def running(self, job: int, fraction: float) -> None:
        """See Progress."""
        now = self._clock()
        if job not in self._shown:
            self._shown[job] = _Shown(since=now, at=now, fraction=fraction)
            self._say(f"{self._labels[job]}: started")
            return
        shown = self._shown[job]
        if _is_due(now - shown.at, fraction - shown.fraction):
            elapsed = now - shown.since
            left = f", {clock_time(elapsed * (1 - fraction) / fraction)} left" if fraction > 0 else ""
            self._say(f"{self._labels[job]}: {fraction:.0%}, {clock_time(elapsed)} elapsed{left}")
            shown.at, shown.fraction = now, fraction

    def done(self, job: int, line: str) -> None:  # noqa: ARG002 (the line names the run)
        """See Progress."""
        self._ended += 1
        self._say(f"[{self._ended}/{len(self._labels)}] {line}")

    def end(self) -> None:
        """See Progress."""

    def _say(self, line: str) -> None:
        print(line, file=self._stream, flush=True)


class Bars:
    """One bar for each running job and one for all, by expected cost; ended jobs scroll away above."""

    def __init__(self, stream: TextIO, **console_options):
        from rich.console import Console
        from rich.progress import BarColumn, TaskProgressColumn, TextColumn, TimeElapsedColumn, TimeRemainingColumn
        from rich.progress import Progress as RichProgress

        self._bars = RichProgress(
            TextColumn("{task.description}", markup=False), BarColumn(), TaskProgressColumn(),
            TimeElapsedColumn(), TextColumn("left"), TimeRemainingColumn(),
            console=Console(file=stream, **console_options),
        )
        self._labels: list[str] = []
        self._costs: list[float] = []
        self._tasks: dict[int, int] = {}
        self._fractions: dict[int, float] = {}

    def begin(self, labels: list[str], costs: list[float]) -> None:
        """See Progress."""
        self._labels, self._costs = labels, costs
        self._all = self._bars.add_task(f"{len(labels)} runs", total=sum(costs))
        self._bars.start()

    def running(self, job: int, fraction: float) -> None:
        """See Progress."""
        if job not in self._tasks:
            self._tasks[job] = self._bars.add_task(self._labels[job], total=1.0)
        self._bars.update(self._tasks[job], completed=fraction)
        self._count(job, fraction)

    def done(self, job: int, line: str) -> None:
        """See Progress."""
        if job in self._tasks:
            self._bars.remove_task(self._tasks.pop(job))
        self._bars.console.print(line, markup=False, highlight=False)
        self._count(job, 1.0)

    def end(self) -> None:
        """See Progress."""
        self._bars.stop()

    def _count(self, job: int, fraction: float) -> None:
        self._fractions[job] = fraction
        self._bars.update(self._all, completed=sum(self._costs[j] * f for j, f in self._fractions.items()))


def clock_time(seconds: float) -> str:
    """Return h:mm:ss.

    >>> clock_time(3725.4)
    '1:02:05'
    """
    minutes, seconds = divmod(round(seconds), 60)
    return f"{minutes // 60}:{minutes % 60:02d}:{seconds:02d}"


def _is_due(seconds: float, advance: float) -> bool:
    return seconds >= QUIET and (advance > 0.0999 or seconds >= SILENT)
