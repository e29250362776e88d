"""What a step of every variant costs on an engine: CPU time in sessions that stay open side by side.

A session (`harness.engines.session`) builds one variant and waits. Then all variants make a stretch of steps, one after
the other, and again, beginning with another one each time: what else the machine does hits all alike, and the ratio of
a variant to the scene as declared is taken stretch by stretch. Set-up and output are outside. Stretches of a scene of
many bodies follow its start; those of a short scene divide its whole time, of all variants the same time, in steps so
much finer that a stretch is long enough: what a step costs does not depend on its length.
"""

from __future__ import annotations

import hashlib
import json
import math
import tempfile
from collections.abc import Callable, Mapping
from contextlib import ExitStack
from dataclasses import asdict, dataclass
from pathlib import Path

import numpy as np

from harness.engines.session import Lost, Session
from harness.engines.whole import Whole, quiet, whole
from harness.runs.atomic import write_json_atomic
from harness.runs.outcome import host_facts
from harness.scene.system import System
from harness.studies.effects.copies import copies
from harness.studies.effects.variants import BASE

ROUNDS = 7
STRETCH = 0.12
"""CPU seconds that one stretch is to take, of scenes that are long enough."""

LEAST, MOST = 1000, 20_000
"""Steps of a stretch."""

TIME_LIMIT = 600.0
SCHEMA = 3
"""Of the files: raise it when what is measured changes."""

Opener = Callable[[Whole, Path], Session]


@dataclass(frozen=True, kw_only=True)
class StepCost:
    """One variant on one engine. seconds: CPU s a step by stretch. ratios: over the scene as declared, by stretch.

    setup: CPU s of building it. steps: of a stretch. bodies: that were timed. All empty with a `reason`.
    """

    seconds: tuple[float, ...] = ()
    ratios: tuple[float, ...] = ()
    setup: float | None = None
    steps: int = 0
    bodies: int = 0
    reason: str = ""

    @property
    def step(self) -> float | None:
        """CPU time of a step, s: all stretches together, as they may be of different parts of a scene."""
        return float(np.mean(self.seconds)) if self.seconds else None

    @property
    def ratio(self) -> float | None:
        """Median over the stretches."""
        return float(np.median(self.ratios)) if self.ratios else None

    def differs(self, steps: float = 1.0) -> bool:
        """Whether the whole range of stretches lies on one side of equal times, with `steps` times as many steps.

        By chance that happens to seven stretches with probability 1/64.
        """
        return self.shorter(steps) or (len(self.ratios) > 1 and steps * min(self.ratios) > 1.0)

    def shorter(self, steps: float = 1.0) -> bool:
        """Whether every stretch took less time than as declared, with `steps` times as many steps."""
        return len(self.ratios) > 1 and steps * max(self.ratios) < 1.0

    @property
    def range(self) -> tuple[float, float] | None:
        """Least and largest ratio."""
        return (min(self.ratios), max(self.ratios)) if self.ratios else None


def step_costs(
    engine: str, version: str, systems: Mapping[str, System], *, kept: Path, opener: Opener,
    rounds: int = ROUNDS, told: Callable[[float], None] = lambda _: None,
) -> dict[str, StepCost]:
    """Return the costs by variant, BASE among them; measured before on this machine they are taken from `kept`.

    told: called with the fraction that is done.
    """
    file = kept / f"{_digest(engine, version, systems, rounds)}.json"
    found = _read(file)
    if found is not None:
        return found
    timed = whole(engine)
    refused = {name: _refusal(timed, system) for name, system in systems.items()}
    measured: dict[str, StepCost] = {}
    if not refused[BASE]:
        measured = _measure(timed, {n: s for n, s in systems.items() if not refused[n]}, opener, rounds, told)
    else:
        refused = {name: why or refused[BASE] for name, why in refused.items()}
    costs = {n: measured.get(n) or StepCost(reason=refused[n] or "not timed") for n in systems}
    kept.mkdir(parents=True, exist_ok=True)
    write_json_atomic(file, {name: asdict(cost) for name, cost in costs.items()})
    return costs


def _measure(
    timed: Whole, systems: Mapping[str, System], opener: Opener, rounds: int, told: Callable[[float], None]
) -> dict[str, StepCost]:
    finer = finer_steps(systems[BASE], rounds)
    many = {
        name: copies(s.with_(dt=s.dt / finer, steps=s.steps * finer)) for name, s in systems.items()
    }
    seconds: dict[str, list[float]] = {name: [] for name in many}
    lost: dict[str, str] = {}
    with tempfile.TemporaryDirectory(prefix="grainproof-effects-") as folder, ExitStack() as stack:
        sessions: dict[str, Session] = {}
        for number, (name, system) in enumerate(many.items()):
            try:
                sessions[name] = stack.enter_context(_open(timed, system, Path(folder) / str(number), opener))
            except Lost as why:
                lost[name] = f"lost while it was built: {why}"
        steps = stretch_steps(many, lambda: [s.run(LEAST) / LEAST for s in sessions.values()], rounds)
        for number in range(rounds):
            for name in _in_turn([n for n in sessions if n not in lost], number):
                try:
                    seconds[name].append(sessions[name].run(steps[name]) / steps[name])
                except Lost as why:
                    lost[name] = f"lost while timed: {why}"
            told((number + 1) / rounds)
        setup = {name: session.setup_seconds for name, session in sessions.items()}
    return {
        name: StepCost(reason=lost[name]) if name in lost else _cost(
            seconds[name], seconds[BASE], setup[name], steps[name], len(system.particles)
        )
        for name, system in many.items()
    }


def _cost(seconds: list[float], base: list[float], setup: float, steps: int, bodies: int) -> StepCost:
    return StepCost(
        seconds=tuple(seconds), ratios=tuple(a / b for a, b in zip(seconds, base, strict=False)), setup=setup,
        steps=steps, bodies=bodies,
    )


def finer_steps(base: System, rounds: int = ROUNDS) -> int:
    """Return by how much steps are made finer, so that the whole time of a short scene is `rounds` stretches."""
    return max(1, math.ceil(rounds * LEAST / base.steps))


def stretch_steps(
    systems: Mapping[str, System], step_seconds: Callable[[], list[float]], rounds: int = ROUNDS
) -> dict[str, int]:
    """Return the steps of a stretch by variant: the same time for all, whether their steps are as long or not.

    step_seconds: asked where a scene is long enough to choose; CPU s of a step, of every variant.
    """
    base = systems[BASE]
    wanted = base.steps // rounds
    if wanted > 2 * LEAST:
        wanted = int(np.clip(STRETCH / float(np.median(step_seconds())), LEAST, min(MOST, wanted)))
    return {name: max(1, round(wanted * base.dt / s.dt)) for name, s in systems.items()}


def _open(timed: Whole, system: System, place: Path, opener: Opener) -> Session:
    place.mkdir(parents=True)
    for name, text in timed.render(quiet(system)).items():
        (place / name).write_text(text)
    return opener(timed, place)


def _refusal(timed: Whole | None, system: System) -> str:
    if timed is None:
        return "this version is not timed: sessions are of the codes that live here, on one process"
    probe = timed.probe()
    return timed.refusal(system.with_(contacts=False)) if probe.available else probe.detail


def _in_turn(names: list[str], number: int) -> list[str]:
    first = number % max(1, len(names))
    return names[first:] + names[:first]


def _digest(engine: str, version: str, systems: Mapping[str, System], rounds: int) -> str:
    told = {
        "engine": engine, "version": version, "rounds": rounds, "schema": SCHEMA, "cpu": host_facts().cpu_model,
        "systems": {name: system.digest() for name, system in systems.items()},
    }
    return hashlib.sha256(json.dumps(told, sort_keys=True).encode()).hexdigest()[:16]


def _read(file: Path) -> dict[str, StepCost] | None:
    """Return what is kept, None if it is missing or damaged: then it is measured anew."""
    try:
        data = json.loads(file.read_text())
        return {
            name: StepCost(**{k: tuple(v) if isinstance(v, list) else v for k, v in cost.items()})
            for name, cost in data.items()
        }
    except (FileNotFoundError, ValueError, TypeError, AttributeError):
        return None
