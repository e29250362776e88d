"""The child's end of a timing session: build once, then answer requests, one line each, until the input ends.

    (built)     {"setup": CPU s}
    run 200     {"cpu": CPU s of the 200 steps}
    places      {}, positions in PLACES
    facts       {"resident": growth of the resident set since before the set-up in bytes, ...: `Running.facts`}

Replies are JSON lines on what was standard output; whatever the engine itself prints goes to standard error.
"""

from __future__ import annotations

import json
import os
import sys
import time
from collections.abc import Callable
from pathlib import Path
from typing import TextIO

import numpy as np

from harness.engines.timed import Running

PLACES = "places.npy"


def serve(start: Callable[[], Running], core: int | None) -> int:
    """Pin this process, build, answer; return the exit status. An error becomes a last reply."""
    replies = _take_standard_output()
    pin(core)
    try:
        before, clock = resident_bytes(), time.process_time()
        running = start()
        _say(replies, {"setup": time.process_time() - clock})
        for line in sys.stdin:
            _say(replies, _answer(running, line.split(), before))
    except Exception as error:  # whatever it is, the other end wants to know
        _say(replies, {"error": f"{type(error).__name__}: {error}"})
        return 1
    return 0


def pin(core: int | None) -> None:
    """Keep this process on one core, where the system can; None leaves it free."""
    if core is not None:
        os.sched_setaffinity(0, {core})


def can_pin() -> bool:
    """Can this system keep a process on a core?"""
    return hasattr(os, "sched_setaffinity")


def resident_bytes() -> int | None:
    """Return the resident set of this process; None where the system does not tell (only Linux does here)."""
    statm = Path("/proc/self/statm")
    return int(statm.read_text().split()[1]) * os.sysconf("SC_PAGE_SIZE") if statm.exists() else None


def core_of(words: list[str]) -> int | None:
    """Return the core that the command line names, None for "-"."""
    return None if words[-1] == "-" else int(words[-1])


def core_word(core: int | None) -> str:
    """Return what `core_of` reads."""
    return "-" if core is None else str(core)


def _answer(running: Running, request: list[str], before: int | None) -> dict:
    word, *numbers = request
    if word == "run":
        start = time.process_time()
        running.advance(int(numbers[0]))
        return {"cpu": time.process_time() - start}
    if word == "places":
        np.save(PLACES, running.places())
        return {}
    if word == "facts":
        resident = resident_bytes()
        grown = {} if before is None or resident is None else {"resident": resident - before}
        return grown | running.facts()
    raise ValueError(f"unknown request {word!r}")


def _take_standard_output() -> TextIO:
    """Return a private copy of standard output, and send what others print there to standard error."""
    sys.stdout.flush()
    copy = os.fdopen(os.dup(1), "w")
    os.dup2(2, 1)
    return copy


def _say(replies: TextIO, reply: dict) -> None:
    print(json.dumps(reply), file=replies, flush=True)
