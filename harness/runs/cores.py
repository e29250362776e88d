"""The cores that runs share: a run waits until as many are free as it has processes, and may be pinned to them."""

from __future__ import annotations

import os
import threading
from collections.abc import Iterable, Iterator
from contextlib import contextmanager

QUIET = 1.0
"""Load of the machine below which it is ours alone."""


class Cores:
    """A number of cores. pin: whether a run is bound to those it got, or the system shares them out."""

    def __init__(self, cores: Iterable[int], *, pin: bool):
        self._free = sorted(cores)
        self._count = len(self._free)
        self._pin = pin
        self._changed = threading.Condition()

    @contextmanager
    def taken(self, count: int) -> Iterator[tuple[int, ...]]:
        """Own so many cores, all when there are fewer; what this thread starts meanwhile runs there if pinned."""
        ours = self._take(min(count, self._count))
        try:
            with _bound(ours) if self._pin else _unbound():
                yield ours
        finally:
            with self._changed:
                self._free = sorted([*self._free, *ours])
                self._changed.notify_all()

    def _take(self, count: int) -> tuple[int, ...]:
        with self._changed:
            self._changed.wait_for(lambda: len(self._free) >= count)
            ours, self._free = tuple(self._free[:count]), self._free[count:]
        return ours


def cores_for(workers: int) -> Cores:
    """Return the cores of a pool. They are pinned when its runs fill them and nobody else is at work.

    On a busy machine, or with cores to spare, the system finds better places than we can: two campaigns would sit
    on the same first core. More workers than cores share them as they come.
    """
    cores = _usable()
    pin = len(cores) == workers > 1 and os.getloadavg()[0] < QUIET and hasattr(os, "sched_setaffinity")
    return Cores(cores if pin else range(workers), pin=pin)


def _usable() -> list[int]:
    return sorted(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else list(range(os.cpu_count() or 1))


@contextmanager
def _bound(cores: tuple[int, ...]) -> Iterator[None]:
    """Bind this thread, and the processes that it starts, to cores."""
    before = os.sched_getaffinity(0)
    os.sched_setaffinity(0, cores)
    try:
        yield
    finally:
        os.sched_setaffinity(0, before)


@contextmanager
def _unbound() -> Iterator[None]:
    yield
