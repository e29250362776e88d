"""From how the process ended and what it printed to a status: the marker alone means "completed"."""

from __future__ import annotations

import re
from pathlib import Path

from harness.engines.child import Child, last_lines, last_step
from harness.engines.liggghts.deck import FINISHED
from harness.engines.liggghts.output import SERIES
from harness.engines.protocol import RunResult

MARKER = re.compile(FINISHED + r" step (\d+) of (\d+) with (\d+) of (\d+) atoms")
LOOP = re.compile(r"^Loop time of (\S+) on ", re.MULTILINE)
SHARE = re.compile(r"^(Pair|Neigh|Comm|Outpt|Other)\s+time \(%\) = (\S+) ", re.MULTILINE)
ERROR = re.compile(r"^ERROR[^:]*: (.*)$", re.MULTILINE)
PLACE = re.compile(r" \(\S+:\d+\)$")
RUNAWAY = {
    "Lost atoms": "a particle left the domain",
    "Mesh elements have been lost": "a moving wall left the domain",
    "Domain too large": "a coordinate ran away",
    "Non-numeric": "a coordinate is not a number",
    "Internal error (./src/tri_mesh": "a coordinate is not a number",
}
"""What LIGGGHTS says when the numbers ran away, and what it means.

The internal error is that of a point which is on no side of a triangle's edges.
"""

PHASES = {"Pair": "forces", "Neigh": "neighbours", "Comm": "communication", "Outpt": "output", "Other": "other"}


def judge(child: Child, folder: Path, log: str, time_limit: float) -> RunResult:
    """Return what one run came to."""
    text = _text(folder / log)
    status, reason = _status(child, text, folder, time_limit)
    return RunResult(
        status=status, reason=reason, last_lines=child.last_lines, cpu_seconds=child.cpu_seconds,
        wall_seconds=child.wall_seconds, timings=_timings(text, child.wall_seconds),
    )


def _status(child: Child, text: str, folder: Path, time_limit: float) -> tuple[str, str]:
    if child.timed_out:
        return "timed_out", f"stopped after the time limit of {time_limit:g} s"
    runaway = _runaway(text, folder)
    if runaway:
        return "unstable", runaway
    marker = MARKER.search(text)
    if child.returncode == 0 and marker:
        step, steps, atoms, expected = (int(n) for n in marker.groups())
        if step != steps:
            return "crashed", f"stopped at step {step} of {steps}"
        if atoms != expected:
            return "unstable", f"{expected - atoms} of {expected} atoms were lost"
        return "completed", ""
    return "crashed", _last_word(child, text)


def _runaway(text: str, folder: Path) -> str:
    """Return why the run is unstable, "" if it is not known to be."""
    error = ERROR.search(text)
    for words, meaning in RUNAWAY.items():
        if error and words in error[1]:
            return f"{meaning} after step {last_step(folder / SERIES)}"
    for row in last_lines(folder / SERIES, count=2):
        if "nan" in row or "inf" in row:
            return f"not a number in the series at step {row.split()[0]}"
    return ""


def _last_word(child: Child, text: str) -> str:
    """Return the engine's error, else the signal or exit status."""
    error = ERROR.search(text)
    if error:
        return PLACE.sub("", error[1])
    if child.signal:
        return f"ended by {child.signal}"
    if child.returncode == 127:
        return child.last_lines[-1] if child.last_lines else "the command could not be started"
    return f"ended with exit status {child.returncode} before its finished marker"


def _timings(text: str, wall_seconds: float) -> dict[str, float]:
    """Return seconds by phase of the run proper; set-up is what its loop does not explain."""
    loops = LOOP.findall(text)
    if not loops or not MARKER.search(text):
        return {"run": wall_seconds}
    run = float(loops[-1])
    shares = {PHASES[name]: float(seconds) for name, seconds in SHARE.findall(text)[-len(PHASES):]}
    return {"run": run, "setup": max(0.0, wall_seconds - run), **shares}


def _text(path: Path) -> str:
    return path.read_bytes().decode("utf-8", errors="replace") if path.exists() else ""
