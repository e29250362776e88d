"""Nobody computes for a harness that is gone: runs in other processes look at a file that the harness holds locked.

The harness owns the lock as long as it wants runs and lives; when it is killed, by whatever signal, the system frees
it. Each process that makes a run looks a few times a second. When the lock is gone it kills its engine and ends; the
run's folder stays unfinished and is made anew by the next call.
"""

from __future__ import annotations

import fcntl
import os
import signal
import socket
import tempfile
import threading
import time
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path
from typing import Any

from harness.engines.child import Stopped, children_stopped

POLL = 0.2
"""Seconds between two looks at the lease."""

GRACE = 30.0
"""Seconds that output which is just being read may take to be kept, once the engine has ended."""

FRESH = 60.0
"""Seconds for which a file that nobody holds may be one that is about to be locked."""

GONE = 75
"""Exit status of a process that ends because its harness is gone: EX_TEMPFAIL of sysexits.h, try again."""


class Lease:
    """A locked file in `folder`, named by this machine; freed by `release`, with the object, or with its process."""

    def __init__(self, folder: Path):
        _bury(folder)
        number, name = tempfile.mkstemp(prefix=f"harness@{socket.gethostname()}@", suffix=".lock", dir=folder)
        self._handle, self.path = os.fdopen(number), Path(name)
        fcntl.flock(self._handle, fcntl.LOCK_EX)

    def release(self) -> None:
        """End all runs that look at it; a second call does nothing."""
        self.path.unlink(missing_ok=True)
        self._handle.close()


def _bury(folder: Path) -> None:
    """Delete what killed harnesses of this machine left; not what another one has just made and is about to lock."""
    for path in folder.glob(f"harness@{socket.gethostname()}@*.lock"):
        with suppress(FileNotFoundError):  # another harness was faster
            if time.time() - path.stat().st_mtime > FRESH and Watch(path).gone():
                path.unlink()


class Watch:
    """Tells whether the harness that holds the lease at `path` is gone.

    A file that is not there was released. One that is not locked is taken for that of a killed harness only on its
    own machine, or after it was once seen locked: not all file systems pass locks on to other nodes.
    """

    def __init__(self, path: Path):
        self._path = path
        self._tells = path.name.split("@")[1] == socket.gethostname()

    def gone(self) -> bool:
        """Look once."""
        try:
            locked = _locked(self._path)
        except FileNotFoundError:
            return True
        self._tells = self._tells or locked
        return self._tells and not locked


def _locked(path: Path) -> bool:
    """Try a shared lock, so that two that look at the same time do not take each other for the owner."""
    with open(path) as handle:
        try:
            fcntl.flock(handle, fcntl.LOCK_SH | fcntl.LOCK_NB)
        except BlockingIOError:
            return True
    return False


def while_held(lease: Path, fn: Callable, /, *args: Any, **options: Any) -> Any:
    """Return fn(*args, **options); once the lease is gone end this process instead, with its engine.

    For the main thread of a process that serves one harness. Ctrl-C in a terminal reaches such processes, too; they
    leave it to the harness, whose end they follow.
    """
    signal.signal(signal.SIGINT, _left_to_the_harness)
    working = threading.Lock()
    with working:
        threading.Thread(target=_end_when_gone, args=(Watch(lease), working), daemon=True).start()
        try:
            return fn(*args, **options)
        except Stopped:
            os._exit(GONE)


def _left_to_the_harness(number: int, frame: object) -> None:
    """Do nothing; a signal that were ignored would stay so in the engine."""


def _end_when_gone(watch: Watch, working: threading.Lock) -> None:
    """Output that is just being read is kept; a worker that waits for its next task ends at once."""
    while not watch.gone():
        time.sleep(POLL)
    with children_stopped():
        working.acquire(timeout=GRACE)
        os._exit(GONE)
