"""How a run ended, as a value: status, why, with what, on which machine, at what cost."""

from __future__ import annotations

import hashlib
import math
import os
import platform
import re
from datetime import datetime
from functools import cache
from pathlib import Path
from typing import Literal

import msgspec
import numpy as np

from harness.runs.atomic import write_text_atomic

Status = Literal["completed", "unstable", "crashed", "timed_out", "unsupported", "unavailable"]


class Damaged(Exception):
    """A file of a run folder is not what it should be; the message names it and says how."""


class Host(msgspec.Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """The machine and the Python that ran it; `cores` are those this process may use."""

    cpu_model: str
    cores: int
    os: str
    python: str
    numpy: str


class FileRecord(msgspec.Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """What a file was when it was written: size in bytes, SHA-256 in hexadecimal digits."""

    size: int
    sha256: str


class Outcome(msgspec.Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """What became of one run. Times are in seconds, `started` and `finished` in UTC.

    reason: one line, empty when completed. partial: effects the engine computes only partially.
    deck_digest: SHA-256 of the rendered deck; an outcome of another deck is out of date.
    timings: by phase, a phase that was not timed is absent: "render", "read", "write" are the
    harness's own; "run" and, where the engine tells, "setup" and "output" are the engine's.
    cpu_seconds (user + system of the engine's process) and wall_seconds are None if it never ran.
    resumed_at: step from which a killed run went on; CPU time is then that of all parts, elapsed time of the last.
    load_average: runnable processes of the machine at the start; times of a busy machine mislead.
    native: what became of the engine's own output. trajectory: recorded for completed runs only, and so are
    `files`, all others in the folder, by name.
    warning: what the engine itself says is wrong with a run that it completed; absent from the file otherwise.
    watch: of watched runs the largest size of each quantity, or why there is none; absent from the file otherwise.
    """

    status: Status
    reason: str
    scene_name: str
    engine: str
    engine_version: str
    harness_version: str
    host: Host
    system_digest: str
    particles_digest: str
    steps: int
    particles: int
    started: datetime
    finished: datetime
    load_average: float
    steps_done: int = 0
    partial: tuple[str, ...] = ()
    deck_digest: str | None = None
    timings: dict[str, float] = {}
    cpu_seconds: float | None = None
    resumed_at: int | None = None
    wall_seconds: float | None = None
    last_lines: tuple[str, ...] = ()
    reproduce: str = ""
    native: str = ""
    trajectory: FileRecord | None = None
    files: dict[str, FileRecord] = {}
    warning: str | msgspec.UnsetType = msgspec.UNSET
    watch: dict[str, float | str] | msgspec.UnsetType = msgspec.UNSET

    @property
    def warnings(self) -> tuple[str, ...]:
        """What the engine says is wrong, or nothing."""
        return () if self.warning is msgspec.UNSET else (self.warning,)

    def __post_init__(self) -> None:
        """Refuse what no run can have; raises ValueError."""
        if (self.status == "completed") != (self.trajectory is not None):
            raise ValueError("a trajectory belongs to a completed run and to no other")
        if (self.status == "completed") != (not self.reason):
            raise ValueError("a reason belongs to every run but a completed one")
        if not all(math.isfinite(t) and t >= 0 for t in self.timings.values()):
            raise ValueError(f"timings must be finite and >= 0, got {self.timings}")


msgspec.json.Decoder(Outcome)
# Needed for what it does once: msgspec learns a type's fields at its first use and shares what it has so far. Two
# threads that met there ended the process (msgspec 0.22.0: segmentation fault in 8 of 160 starts on kept runs).

CHECKSUM = "sha256"
"""The last entry of outcome.json: of all the others, so that an edited outcome is not believed."""


def write_outcome(path: Path, outcome: Outcome) -> None:
    """Write atomically; the file's presence says that everything beside it is complete."""
    sealed = msgspec.to_builtins(outcome) | {CHECKSUM: _checksum(outcome)}
    write_text_atomic(path, msgspec.json.format(msgspec.json.encode(sealed).decode(), indent=2) + "\n")


def read_outcome(path: Path) -> Outcome:
    """Read what `write_outcome` wrote. Raises Damaged on anything else, FileNotFoundError if absent."""
    try:
        raw = msgspec.json.decode(path.read_bytes(), type=dict)
        checksum = raw.pop(CHECKSUM, None)
        outcome = msgspec.convert(raw, Outcome)
    except (msgspec.DecodeError, UnicodeDecodeError) as error:
        raise Damaged(f"{path.name} is damaged: {error}") from error
    if checksum != _checksum(outcome):
        said = "has no checksum" if checksum is None else "is not what was written (SHA-256 differs)"
        raise Damaged(f"{path.name} {said}")
    return outcome


def _checksum(outcome: Outcome) -> str:
    """SHA-256 of the outcome as compact JSON, its entries in the order of their declaration."""
    return hashlib.sha256(msgspec.json.encode(outcome)).hexdigest()


STEP = re.compile(r"(?P<by>by )?step (?P<step>\d+)[:,] ")
"""How a reason begins that says its step."""


def describe_outcome(outcome: Outcome) -> str:
    """Say in one line what happened; for a failed run it ends with the command that repeats it."""
    head = f"{outcome.scene_name}, {outcome.engine} {outcome.engine_version}: {outcome.status}"
    tail = f"; partial: {', '.join(outcome.partial)}" if outcome.partial else ""
    tail += "".join(f"; warning: {warning}" for warning in outcome.warnings)
    tail += "" if outcome.resumed_at is None else f"; went on at step {outcome.resumed_at}, the same bits"
    if outcome.status == "completed":
        line = f"{head}, {outcome.steps} steps, {outcome.particles} particles, {_times(outcome)}{tail}"
    elif outcome.status in ("unsupported", "unavailable"):
        line = f"{head}: {outcome.reason}"
    else:
        where, why = where_and_why(outcome)
        line = f"{head} {where}: {why}{last_words(outcome)}{tail}; reproduce: {outcome.reproduce}"
    return " ".join(line.split())


def reason_of(outcome: Outcome) -> str:
    """Return the status of a run that did not complete, once, and why."""
    return f"{outcome.status.replace('_', ' ')}: {outcome.reason.removeprefix(f'{outcome.status}: ')}"


def where_and_why(outcome: Outcome) -> tuple[str, str]:
    """Return at which step a failed run ended, and why.

    An engine that breaks off says its step, with which its reason begins; of the others the last sample is known.
    """
    reason = outcome.reason.removeprefix(f"{outcome.status}: ")
    told = STEP.match(reason)
    if told is None:
        return f"after step {outcome.steps_done} of {outcome.steps}", reason
    return f"{'by' if told['by'] else 'at'} step {told['step']} of {outcome.steps}", reason[told.end():]


def last_words(outcome: Outcome) -> str:
    """Return what the engine said last, unless it is the reason itself."""
    _, why = where_and_why(outcome)
    last = outcome.last_lines[-1] if outcome.last_lines else ""
    return f"; last words: {last}" if last and why not in last and last not in why else ""


def _times(outcome: Outcome) -> str:
    return f"{outcome.wall_seconds:.3g} s (cpu {outcome.cpu_seconds:.3g} s)"


@cache
def host_facts() -> Host:
    """Return the facts of this machine."""
    return Host(
        cpu_model=_cpu_model(),
        cores=usable_cores(),
        os=platform.platform(),
        python=platform.python_version(),
        numpy=np.__version__,
    )


def usable_cores() -> int:
    """Return the number of cores this process may run on, which a batch system can limit."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


def _cpu_model() -> str:
    cpuinfo = Path("/proc/cpuinfo")
    lines = cpuinfo.read_text(errors="replace").splitlines() if cpuinfo.exists() else []
    names = [line.partition(":")[2].strip() for line in lines if line.startswith("model name")]
    return names[0] if names else platform.processor() or platform.machine()
