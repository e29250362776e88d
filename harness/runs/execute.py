"""One run from probe to outcome: reuse what is finished, else render, run, read, check, keep."""

from __future__ import annotations

import logging
import os
import shlex
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field
from datetime import UTC, datetime
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from harness import __version__
from harness.engines.protocol import REFUSED
from harness.runs.atomic import writing
from harness.runs.folder import RunFolder, deck_digest, record_file
from harness.runs.native import NativePolicy, settle_native
from harness.runs.outcome import Outcome, host_facts, write_outcome
from harness.runs.sanity import find_fault
from postproc.trajectory import ReadError, Trajectory, read_trajectory, write_trajectory

if TYPE_CHECKING:
    from harness.engines.protocol import Engine, Probe, RunResult, Support
    from harness.scene.system import System


log = logging.getLogger(__name__)


def run_one(
    engine: Engine, system: System, root: Path, *, time_limit: float, force: bool = False,
    native: NativePolicy = "gzip", probe: Probe | None = None,
) -> tuple[Outcome, Path]:
    """Run `system` with `engine`, or reuse the finished run; return the outcome and the run's folder.

    time_limit: seconds of wall time for the engine's process. force: run even if it is finished.
    native: what becomes of large dumps, see `harness.runs.native`. probe: the engine's answer if it
    was asked before. For "unavailable" and "unsupported" nothing is run and no folder made.

    What the engine does wrong is an outcome. Errors of the harness and of the machine (a full disk)
    are raised, and harness.engines.child.Stopped when the harness stops; the folder is then
    unfinished and the next call makes it anew.
    """
    probe = probe or engine.probe()
    folder = RunFolder.of(root, system, engine.name, probe.version)
    start = {"started": datetime.now(UTC), "load_average": os.getloadavg()[0]}
    outcome = partial(outcome_of, engine, system, probe, **start)
    if not probe.available:
        return outcome(status="unavailable", reason=probe.detail), folder.path
    supports = engine.supports(system)
    refused = [s for s in supports if s.level in REFUSED]
    if refused:
        return outcome(status="unsupported", reason="; ".join(each_once(refused))), folder.path
    said = tuple(_quote(s) for s in supports if s.level == "partial")
    deck = engine.render(system)
    with folder.lock():
        kept = None if force else folder.completed(deck)
        if kept is None:
            run = _Run(engine=engine, system=system, folder=folder, deck=deck, native=native, force=force)
            kept = run.perform(time_limit, partial(outcome, partial=said))
    return kept, folder.path


@dataclass(frozen=True, kw_only=True)
class _Run:
    """A run that is really made."""

    engine: Engine
    system: System
    folder: RunFolder
    deck: Mapping[str, str]
    native: NativePolicy
    force: bool
    timings: dict[str, float] = field(default_factory=dict)

    def perform(self, time_limit: float, outcome: Callable[..., Outcome]) -> Outcome:
        """Make the folder, run, keep what came of it; outcome.json is the last file written."""
        if not self._goes_on():
            with writing(self.folder.path):
                self.folder.prepare(self.deck)
        result = self.engine.run(self.folder.path, time_limit=time_limit)
        self.timings.update(result.timings)
        made = outcome(**self._facts(result), **self._verdict(result), timings=self.timings)
        write_outcome(self.folder.outcome, made)
        return made

    def _goes_on(self) -> bool:
        """Return whether a killed run of this deck left what the engine goes on from to the same bits."""
        if self.force or not self.folder.unfinished(self.deck) or not self.engine.resumes(self.folder.path):
            return False
        log.warning("%s: goes on from its checkpoint, with the same bits", self.folder.name)
        self.folder.outcome.unlink(missing_ok=True)
        return True

    def _facts(self, result: RunResult) -> dict:
        path = self.folder.path
        return {
            "deck_digest": deck_digest(self.deck),
            "cpu_seconds": result.cpu_seconds,
            "resumed_at": result.resumed_at,
            **({"warning": result.warning} if result.warning else {}),
            "wall_seconds": result.wall_seconds,
            "last_lines": result.last_lines,
            "steps_done": self.engine.steps_done(path),
            "reproduce": f"cd {shlex.quote(str(path))} && {shlex.join(self.engine.command(path))}",
        }

    def _verdict(self, result: RunResult) -> dict:
        """Return status and reason, and the trajectory's record if the run is completed."""
        if result.status != "completed":
            return {"status": result.status, "reason": result.reason or "the engine gave no reason"}
        try:
            with self._timed("read"):
                trajectory = self.engine.read(self.folder.path, self.system)
        except ReadError as error:
            return {"status": "crashed", "reason": f"output cannot be read: {error}"}
        fault = find_fault(self.system, trajectory)
        return self._keep(trajectory) if fault is None else {"status": fault.status, "reason": fault.reason}

    def _keep(self, trajectory: Trajectory) -> dict:
        """Write the trajectory and read it back; only then may native dumps be touched."""
        path = self.folder.trajectory
        with self._timed("write"), writing(path):
            write_trajectory(path, trajectory)
            if not same_trajectory(read_trajectory(path), trajectory):
                raise RuntimeError(f"{path} does not read back as it was written")
            record = record_file(path)
        keep = {*self.deck, path.name, "identity.json"}
        native = settle_native(self.folder.path, keep=keep, policy=self.native)
        return {
            "status": "completed", "reason": "", "trajectory": record, "native": native,
            "files": self.folder.records(),
        }

    @contextmanager
    def _timed(self, phase: str) -> Iterator[None]:
        start = time.monotonic()
        yield
        self.timings[phase] = time.monotonic() - start


def same_trajectory(a: Trajectory, b: Trajectory) -> bool:
    """Are two trajectories equal to the last bit, NaN equal to NaN?"""
    frames = a.steps == b.steps and len(a) == len(b)
    return frames and _same_table(a.series, b.series) and all(map(_same_frame, a, b))


def _same_frame(a, b) -> bool:
    tables = all(_same_table(getattr(a, g), getattr(b, g)) for g in ("particles", "contacts", "walls"))
    plain = all(getattr(a, k) == getattr(b, k) for k in ("time", "dimension", "thickness", "periodic"))
    return tables and plain and (a.box is None) == (b.box is None) and np.array_equal(a.box, b.box)


def _same_table(a, b) -> bool:
    if a is None or b is None:
        return a is b
    return set(a) == set(b) and all(np.array_equal(a[k], b[k], equal_nan=True) for k in a)


def each_once(supports: Sequence[Support]) -> list[str]:
    """Quote supports, effects with the same reason together."""
    effects: dict[tuple[str, str], list[str]] = {}
    for s in supports:
        effects.setdefault((s.level, s.note), []).append(s.effect)
    return [f"{', '.join(of)}: {level.replace('_', ' ')}: {note}" for (level, note), of in effects.items()]


def _quote(support: Support) -> str:
    return f"{support.effect}: {support.level.replace('_', ' ')}: {support.note}"


def outcome_of(engine: Engine, system: System, probe: Probe, **facts) -> Outcome:
    """Return the outcome of a run that has just ended. facts: what it does not know by itself."""
    return Outcome(
        scene_name=system.scene_name,
        engine=engine.name,
        engine_version=probe.version,
        harness_version=__version__,
        host=host_facts(),
        system_digest=system.digest(),
        particles_digest=system.particles_digest(),
        steps=system.steps,
        particles=len(system.particles),
        finished=datetime.now(UTC),
        **facts,
    )
