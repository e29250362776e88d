"""Interrupts: unwind at the first one, and let nothing disturb the end of the runs."""

from __future__ import annotations

import signal
import threading
from collections.abc import Iterator
from contextlib import contextmanager

ENDING = (signal.SIGINT, signal.SIGTERM, signal.SIGHUP)


@contextmanager
def terminable() -> Iterator[None]:
    """Let SIGTERM and SIGHUP unwind like Ctrl-C, so that no engine is left computing for nobody.

    Signals that somebody handles or ignores (nohup) are left alone; only the main thread may ask.
    """
    with _restored() as before:
        for number, handler in before.items():
            if handler is signal.SIG_DFL:
                signal.signal(number, _exit_by_signal)
        yield


@contextmanager
def undisturbed() -> Iterator[None]:
    """Let a second Ctrl-C not interrupt what the first one has begun: an end that is interrupted leaves somebody."""
    with _restored():
        hear_no_more()
        yield


def hear_no_more() -> None:
    """Ignore interrupts until the `terminable` around it is left."""
    if threading.current_thread() is threading.main_thread():
        for number in ENDING:
            signal.signal(number, signal.SIG_IGN)


@contextmanager
def deaf_threads() -> Iterator[None]:
    """Let threads that begin here, and the programs that they start, not hear interrupts.

    A terminal sends Ctrl-C to all: a squeue of executorlib's thread would die of it, the thread of that, and nobody
    would take the jobs out of the queue.
    """
    before = signal.pthread_sigmask(signal.SIG_BLOCK, ENDING)
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)


@contextmanager
def _restored() -> Iterator[dict[int, object]]:
    """Give the handlers of now, none outside the main thread, and set them again afterwards."""
    main = threading.current_thread() is threading.main_thread()
    before = {number: signal.getsignal(number) for number in ENDING} if main else {}
    try:
        yield before
    finally:
        for number, handler in before.items():
            signal.signal(number, signal.SIG_DFL if handler is None else handler)


def _exit_by_signal(number: int, frame: object) -> None:  # noqa: ARG001 (signal's own signature)
    raise SystemExit(128 + number)
