"""Nobody computes for a harness that was killed: a small process of its own ends its children.

The harness tells the guardian through a pipe which children run. When the harness dies, by whatever signal,
the system closes its end of the pipe; the guardian then kills the process groups that are left. This needs
nothing of the children, costs them nothing, and works wherever there are pipes and process groups.
"""

from __future__ import annotations

import subprocess
import sys
import threading

SCRIPT = r"""
import os, signal, sys
alive = set()
for line in sys.stdin:
    pid = int(line[1:])
    alive.add(pid) if line[0] == "+" else alive.discard(pid)
for pid in alive:
    try:
        os.killpg(pid, signal.SIGKILL)
    except OSError:
        pass
"""


class Guardian:
    """Watches over process groups, which are named by the process that leads them; started with the first one."""

    def __init__(self) -> None:
        self._lock = threading.Lock()
        self._process: subprocess.Popen | None = None

    def watch(self, pid: int) -> None:
        """Kill the group of `pid` if this process ends before `release` is called."""
        self._tell(f"+{pid}\n")

    def release(self, pid: int) -> None:
        """Forget the group: its leader has ended, and its number may become another's."""
        self._tell(f"-{pid}\n")

    def _tell(self, line: str) -> None:
        """Write the line; without a guardian, where none can be started, runs go on unguarded."""
        with self._lock:
            try:
                if self._process is None:
                    self._process = _started()
                self._process.stdin.write(line.encode())
                self._process.stdin.flush()
            except OSError:
                return


def _started() -> subprocess.Popen:
    """Start it in a session of its own: Ctrl-C in a terminal must not end it before the harness."""
    return subprocess.Popen(
        [sys.executable, "-I", "-S", "-c", SCRIPT], stdin=subprocess.PIPE, stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL, start_new_session=True,
    )
