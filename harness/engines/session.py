"""The harness' end of a timing session: a child process that is asked one line and answers one line."""

from __future__ import annotations

import contextlib
import json
import os
import select
import signal
import subprocess
import time
from pathlib import Path

import numpy as np

from harness.engines.child import last_lines
from harness.engines.rounds import PLACES
from harness.engines.timed import Timed

LOG = "child.log"


class Lost(Exception):
    """The child ended, failed or did not answer in time; the message says which in one line."""


class Session:
    """A code that has built the deck in `folder` and waits. A context: on leaving it the child is ended."""

    def __init__(self, timed: Timed, folder: Path, *, core: int | None, time_limit: float):
        """Start the child and wait until it has built its system. Raises Lost."""
        self._folder, self._time_limit, self._rest = folder, time_limit, b""
        with open(folder / LOG, "wb") as log:
            try:
                self._child = subprocess.Popen(
                    timed.command(core), cwd=folder, stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=log,
                    env=timed.environment(), start_new_session=True,
                )
            except OSError as error:
                raise Lost(str(error)) from error
        try:
            self.setup_seconds = float(self._reply()["setup"])
            """CPU time in which the child built its system."""
        except BaseException:
            self.close()
            raise

    def run(self, steps: int) -> float:
        """Make steps; return the CPU seconds they took. Raises Lost."""
        return float(self._ask(f"run {steps}")["cpu"])

    def places(self) -> np.ndarray:
        """Return the positions, (N, dim) in m. Raises Lost."""
        self._ask("places")
        return np.load(self._folder / PLACES)

    def facts(self) -> dict[str, int]:
        """Return memory and what else there is to tell: `harness.engines.rounds`. Raises Lost."""
        return self._ask("facts")

    def close(self) -> None:
        """End the child, whatever it does."""
        if self._child.poll() is None:
            os.killpg(self._child.pid, signal.SIGKILL)
        self._child.wait()
        for pipe in (self._child.stdin, self._child.stdout):
            with contextlib.suppress(BrokenPipeError):  # of a request that nobody read any more
                pipe.close()

    def __enter__(self) -> Session:
        return self

    def __exit__(self, *_) -> None:
        self.close()

    def _ask(self, request: str) -> dict:
        try:
            self._child.stdin.write(f"{request}\n".encode())
            self._child.stdin.flush()
        except BrokenPipeError:
            raise Lost(self._end()) from None
        return self._reply()

    def _reply(self) -> dict:
        end = time.monotonic() + self._time_limit
        pipe = self._child.stdout.fileno()
        while b"\n" not in self._rest:
            if not select.select([pipe], [], [], max(0.0, end - time.monotonic()))[0]:
                raise Lost(f"no answer within {self._time_limit:g} s")
            read = os.read(pipe, 4096)
            if not read:
                raise Lost(self._end())
            self._rest += read
        line, self._rest = self._rest.split(b"\n", 1)
        reply = json.loads(line)
        if "error" in reply:
            raise Lost(reply["error"])
        return reply

    def _end(self) -> str:
        """Say how a child that answers no more has ended."""
        code = self._child.wait()
        how = f"ended by {signal.Signals(-code).name}" if code < 0 else f"ended with status {code}"
        words = last_lines(self._folder / LOG)
        return f"{how}: {words[-1]}" if words else how
