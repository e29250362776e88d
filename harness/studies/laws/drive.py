"""Drive every engine along the paths: one folder, one child process a run; what it answers is a value.

Nothing of these runs is kept but deck, log and the outcome: reactions are large, and made again in a second.
"""

from __future__ import annotations

import hashlib
import os
import shutil
import threading
import time
from collections.abc import Iterator, Sequence
from concurrent.futures import Future, ThreadPoolExecutor, wait
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from harness import SCHEMA
from harness.engines.child import children_stopped
from harness.engines.protocol import PATH_FILE, REACTION_FILE, REFUSED, Prescribed, Reaction
from harness.runs.folder import RunFolder
from harness.runs.outcome import Status
from harness.runs.pool import terminable
from harness.studies.laws.arrangement import Arrangement

if TYPE_CHECKING:
    from harness.engines.protocol import Engine, Probe, Support
    from harness.scene.system import System
    from harness.studies.laws.cases import Laws

RECORD = "run.json"


@dataclass(frozen=True, kw_only=True)
class Job:
    """One combination of laws on one engine, in one arrangement."""

    laws: Laws
    engine: Engine
    arrangement: Arrangement


@dataclass(frozen=True, kw_only=True)
class Driven:
    """What became of a job. reason: one line, empty when completed. notes: what the engine computes only in part."""

    job: Job
    status: Status
    reason: str
    notes: tuple[str, ...] = ()
    reaction: Reaction | None = None
    seconds: float = 0.0
    folder: Path | None = None

    @property
    def engine(self) -> str:
        """The engine's name."""
        return self.job.engine.name

    @property
    def part(self) -> str:
        """Which arrangement it was, in words."""
        return part_name(self.job.arrangement)


def part_name(arrangement: Arrangement) -> str:
    """Return what people call an arrangement."""
    return f"{'pairs' if arrangement.partner == 'pair' else 'planes'} in {arrangement.dimension}D"


@dataclass(kw_only=True)
class Driver:
    """Where runs are made and how. probes: asked once an engine."""

    root: Path
    time_limit: float
    workers: int
    _probes: dict[str, Probe] = field(default_factory=dict)
    _lock: threading.Lock = field(default_factory=threading.Lock)

    def each(self, groups: Sequence[Sequence[Job]]) -> Iterator[list[Driven]]:
        """Yield what became of each group of jobs, in the order given; later groups go on meanwhile.

        An interrupt ends the engines at once and goes on as KeyboardInterrupt or SystemExit.
        """
        with terminable(), ThreadPoolExecutor(self.workers) as pool:
            futures = [[pool.submit(self.drive, job) for job in group] for group in groups]
            try:
                for k, group in enumerate(futures):
                    yield [f.result() for f in group]
                    futures[k] = []
            except BaseException:
                _stop([f for group in futures for f in group])
                raise

    def drive(self, job: Job) -> Driven:
        """Run one job; what the engine does wrong is an outcome, never an exception."""
        probe = self._probe(job.engine)
        if not probe.available:
            return Driven(job=job, status="unavailable", reason=probe.detail)
        system = job.arrangement.system(job.laws, _name(job))
        supports = job.engine.supports(system)
        refused = [_quote(s) for s in supports if s.level in REFUSED]
        if refused:
            return Driven(job=job, status="unsupported", reason="; ".join(refused))
        notes = tuple(_quote(s) for s in supports if s.level == "partial")
        return self._run(job, system, probe, notes)

    def _run(self, job: Job, system: System, probe: Probe, notes: tuple[str, ...]) -> Driven:
        folder = self._folder(job, system, probe)
        start = time.monotonic()
        with folder.lock():
            folder.prepare(job.engine.render_prescribed(system))
            self._put_path(job.arrangement, folder.path)
            result = job.engine.run_prescribed(folder.path, time_limit=self.time_limit)
            status, reason, reaction = result.status, result.reason or "the engine gave no reason", None
            if status == "completed":
                status, reason, reaction = _answer(folder.path / REACTION_FILE, job.arrangement.path)
            _record(folder.path, status, reason, result)
        return Driven(
            job=job, status=status, reason=reason, notes=notes, reaction=reaction, folder=folder.path,
            seconds=time.monotonic() - start,
        )

    def _folder(self, job: Job, system: System, probe: Probe) -> RunFolder:
        identity = {
            "system": system.identity(), "path": digest(job.arrangement.path), "engine": job.engine.name,
            "version": probe.version, "schema": SCHEMA,
        }
        name = f"{_name(job)}-{job.engine.name.replace(':', '-')}"
        return RunFolder(root=self.root.absolute(), name=name, identity=identity)

    def _put_path(self, arrangement: Arrangement, folder: Path) -> None:
        """The same path for all laws: one file, linked where the file system can."""
        shared = self.root.absolute() / "paths" / f"{digest(arrangement.path)[:16]}.npz"
        with self._lock:
            if not shared.exists():
                shared.parent.mkdir(parents=True, exist_ok=True)
                part = shared.with_name(f".{os.getpid()}.npz")
                np.savez(part, **vars(arrangement.path))
                os.replace(part, shared)
        try:
            os.link(shared, folder / PATH_FILE)
        except OSError:
            shutil.copyfile(shared, folder / PATH_FILE)

    def _probe(self, engine: Engine) -> Probe:
        with self._lock:
            if engine.name not in self._probes:
                self._probes[engine.name] = engine.probe()
            return self._probes[engine.name]


def digest(path: Prescribed) -> str:
    """SHA-256 of the path's numbers."""
    h = hashlib.sha256()
    for name in ("x", "v", "spin"):
        h.update(np.ascontiguousarray(getattr(path, name), "<f8").tobytes())
    return h.hexdigest()


def _name(job: Job) -> str:
    a = job.arrangement
    return f"{job.laws.name}-{a.partner}-{a.dimension}d"


def _answer(file: Path, path: Prescribed) -> tuple[Status, str, Reaction | None]:
    """Read the reaction and remove its file; anything but finite numbers of the right shape is no answer."""
    try:
        with np.load(file) as found:
            reaction = Reaction(force=found["force"], torque=found["torque"])
    except (OSError, ValueError, KeyError) as error:
        return "crashed", f"{REACTION_FILE} cannot be read: {error}", None
    file.unlink()
    if reaction.force.shape != path.x[1:].shape or reaction.torque.shape != path.spin[1:].shape:
        shapes = f"{reaction.force.shape} and {reaction.torque.shape}"
        return "crashed", f"force and torque have the shapes {shapes}", None
    if not (np.isfinite(reaction.force).all() and np.isfinite(reaction.torque).all()):
        return "unstable", "forces or torques are not finite", None
    return "completed", "", reaction


def _record(folder: Path, status: str, reason: str, result) -> None:
    from harness.runs.atomic import write_json_atomic

    write_json_atomic(folder / RECORD, {
        "status": status, "reason": reason, "cpu_seconds": result.cpu_seconds, "wall_seconds": result.wall_seconds,
        "last_lines": result.last_lines,
    })


def _stop(futures: list[Future]) -> None:
    begun = [f for f in futures if not f.cancel()]
    with children_stopped():
        wait(begun)


def _quote(support: Support) -> str:
    return f"{support.effect}: {support.level.replace('_', ' ')}: {support.note}"
