"""What a step costs each engine: CPU time of its own process in a timing session, repeats of all engines interleaved.

A collision is too short to be timed by the process that runs it, which spends its time on starting. So a session
(`harness.engines.session`) builds the system of one rung, and then makes all its steps: the very steps of the run,
without set-up and output. Every repeat is a session of its own, in which the engines take turns.
"""

from __future__ import annotations

import hashlib
import json
import tempfile
from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from harness.engines.benches import timed_as
from harness.engines.session import Lost, Session
from harness.runs.outcome import host_facts
from harness.runs.sealed import read_sealed, write_sealed

if TYPE_CHECKING:
    from harness.engines.timed import Timed
    from harness.scene.system import System

REPEATS = 3
SKIN = 0.1
"""Of the mean radius: how far beyond contact pairs are listed, by every engine."""

Opener = Callable[["Timed", Path], Session]


@dataclass(frozen=True, kw_only=True)
class Cost:
    """seconds: CPU s a step by repeat; setup: CPU s of building the system by repeat. Empty with a `reason`."""

    seconds: tuple[float, ...] = ()
    setup: tuple[float, ...] = ()
    steps: int = 0
    reason: str = ""

    @property
    def step(self) -> float | None:
        """Median CPU time of a step, s; None where it was not timed."""
        return float(np.median(self.seconds)) if self.seconds else None


def measure_costs(
    systems: Mapping[str, System], versions: Mapping[str, str], *, kept: Path, opener: Opener,
    repeats: int = REPEATS, begun: Callable[[str], None] = lambda _: None,
) -> dict[str, Cost]:
    """Return the costs by engine; those measured before on this machine are taken from `kept`.

    systems, versions: by the engine's name; an engine that failed is left out by the caller.
    """
    files = {name: kept / f"{_digest(name, versions[name], system)}.json" for name, system in systems.items()}
    found = {name: _read(file) for name, file in files.items()}
    if all(cost is not None for cost in found.values()):
        return found
    takers = {name: timed_as(name) for name in systems}
    refused = {name: _refusal(timed, systems[name]) for name, timed in takers.items()}
    runs: dict[str, list[tuple[float, float]]] = {name: [] for name in systems}
    with tempfile.TemporaryDirectory(prefix="grainproof-accuracy-") as folder:
        for number in range(repeats):
            for name in _in_turn([n for n in systems if not refused[n]], number):
                begun(name)
                try:
                    runs[name].append(_run(takers[name], systems[name], Path(folder) / str(number), opener))
                except Lost as why:
                    refused[name] = f"lost while timed: {why}"
    costs = {name: _cost(runs[name], systems[name], refused[name]) for name in systems}
    for name, cost in costs.items():
        write_sealed(files[name], asdict(cost))
    return costs


def _run(timed: Timed, system: System, place: Path, opener: Opener) -> tuple[float, float]:
    """Make all steps of the system once; return CPU seconds a step, and of the set-up."""
    place = place.with_name(f"{place.name}-{''.join(c if c.isalnum() else '_' for c in timed.name)}")
    place.mkdir(parents=True)
    for name, text in timed.render(system, skin=SKIN * float(system.particles.radius.mean())).items():
        (place / name).write_text(text)
    session = opener(timed, place)
    try:
        return session.run(system.steps) / system.steps, session.setup_seconds
    finally:
        session.close()


def _cost(runs: Sequence[tuple[float, float]], system: System, reason: str) -> Cost:
    if reason:
        return Cost(reason=reason)
    seconds, setup = zip(*runs, strict=True)
    return Cost(seconds=seconds, setup=setup, steps=system.steps)


def _refusal(timed: Timed | None, system: System) -> str:
    """Say why an engine is not timed, "" if it is."""
    if timed is None:
        return "this version is not timed: sessions are of the codes that live here"
    probe = timed.probe()
    return timed.refusal(system) if probe.available else probe.detail


def _in_turn(names: list[str], number: int) -> list[str]:
    first = number % max(1, len(names))
    return names[first:] + names[:first]


def _digest(name: str, version: str, system: System) -> str:
    told = {"engine": name, "version": version, "system": system.digest(), "cpu": host_facts().cpu_model}
    return hashlib.sha256(json.dumps(told, sort_keys=True).encode()).hexdigest()[:16]


def _read(file: Path) -> Cost | None:
    data = read_sealed(file, "all engines take turns again, and the times are")
    return None if data is None else Cost(**{k: tuple(v) if isinstance(v, list) else v for k, v in data.items()})
