"""One case at one size: all codes side by side, in short rounds that take turns.

The machine is shared, so no time means much alone. Every round gives every code some steps, one after the other on
one core; ratios are taken within a round, and only then their median.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from contextlib import ExitStack
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Literal, Protocol

import numpy as np

from harness.engines.session import Lost
from harness.engines.timed import Timed
from harness.scene.system import System

WARM_STEPS = 96
"""Steps that every code makes before it is timed; their result is compared."""

FEWEST_STEPS = 40
"""Steps of a round, at least. A multiple of those between two looks of the kernel at its list, as all rounds are."""

SAME = 0.02
"""Codes that solve the same problem are as near to the kernel after WARM_STEPS, in rms displacements. Conventions
of friction differ by a few thousandths; a missing wall, damper or spring by far more."""

Status = Literal["timed", "refused", "unavailable", "lost", "differs"]


class Asked(Protocol):
    """What a session answers; raises Lost."""

    def run(self, steps: int) -> float:
        """Return CPU seconds."""

    def places(self) -> np.ndarray:
        """Return positions, (N, dim)."""

    def facts(self) -> dict[str, int]:
        """Return memory in bytes and other counts."""

    def close(self) -> None:
        """End it."""


Opener = Callable[[Timed, Path], Asked]


@dataclass(frozen=True, kw_only=True)
class Effort:
    """How long is measured. seconds: CPU time of a round's chunk, about, for the fastest code."""

    rounds: int
    seconds: float


@dataclass(frozen=True, kw_only=True)
class Entrant:
    """A code and what it computes. share: the part of a round's steps that it makes; 1/8 for a slow one.

    same_problem: whether its result has to be the kernel's; not so where it computes another case.
    """

    label: str
    timed: Timed
    system: System
    skin: float
    share: float = 1.0
    same_problem: bool = True


@dataclass(frozen=True, kw_only=True)
class Track:
    """What became of an entrant. seconds: (rounds,) CPU s a step, empty unless timed.

    off: rms distance from the kernel's positions after WARM_STEPS over the rms displacement; None if not
    compared. facts: see `harness.engines.rounds`.
    """

    status: Status
    reason: str = ""
    seconds: np.ndarray = field(default_factory=lambda: np.empty(0))
    steps: int = 0
    off: float | None = None
    facts: Mapping[str, int] = field(default_factory=dict)


def measure(entrants: Sequence[Entrant], folder: Path, opener: Opener, effort: Effort) -> dict[str, Track]:
    """Return the track of every entrant by its label; the first is the kernel that others are compared with.

    A code that fails is out, the others go on.
    """
    with ExitStack() as stack:
        runners = {e.label: _Runner(e, folder, opener, stack) for e in entrants}
        warm = [r for r in runners.values() if r.warm_up()]
        steps = _steps_of_a_round([r.warm_seconds for r in warm], effort.seconds)
        for number in range(effort.rounds):
            for runner in _in_turn(warm, number):
                runner.race(steps)
        for runner in warm:
            runner.weigh()
        return _judged({label: r.track() for label, r in runners.items()}, runners)


class _Runner:
    """An entrant's session and what it has given so far."""

    def __init__(self, entrant: Entrant, folder: Path, opener: Opener, stack: ExitStack):
        self.entrant = entrant
        self.status, self.reason = _standing(entrant)
        self.warm_seconds, self.steps = math.nan, 0
        self.seconds: list[float] = []
        self.places: np.ndarray | None = None
        self.facts: dict[str, int] = {}
        self._session: Asked | None = None
        if self.status == "timed":
            self._trying(lambda: self._open(folder, opener, stack))

    def warm_up(self) -> bool:
        """Make the first steps, which are compared, and some that tell how fast it is; return whether it runs."""
        self._trying(self._warm_up)
        return self.status == "timed"

    def race(self, steps: int) -> None:
        """Make one round's steps."""
        self.steps = max(1, round(self.entrant.share * steps))
        self._trying(lambda: self.seconds.append(self._session.run(self.steps) / self.steps))

    def weigh(self) -> None:
        """Ask for memory and other facts, which ends the timing."""
        self._trying(lambda: self.facts.update(self._session.facts()))

    def track(self) -> Track:
        """Return what came of it."""
        if self.status != "timed":
            return Track(status=self.status, reason=self.reason)
        return Track(status="timed", seconds=np.array(self.seconds), steps=self.steps, facts=self.facts)

    def _open(self, folder: Path, opener: Opener, stack: ExitStack) -> None:
        entrant = self.entrant
        place = folder / "".join(c if c.isalnum() else "_" for c in entrant.label)
        place.mkdir(parents=True, exist_ok=True)
        for name, text in entrant.timed.render(entrant.system, skin=entrant.skin).items():
            (place / name).write_text(text)
        self._session = opener(entrant.timed, place)
        stack.callback(self._session.close)

    def _warm_up(self) -> None:
        self.warm_seconds = self._session.run(WARM_STEPS) / WARM_STEPS
        self.places = self._session.places()

    def _trying(self, act: Callable[[], object]) -> None:
        if self.status != "timed":
            return
        try:
            act()
        except Lost as why:
            self.status, self.reason = "lost", str(why)


def _standing(entrant: Entrant) -> tuple[Status, str]:
    """Can the code take part?"""
    probe = entrant.timed.probe()
    if not probe.available:
        return "unavailable", probe.detail
    refusal = entrant.timed.refusal(entrant.system)
    return ("refused", refusal) if refusal else ("timed", "")


def _steps_of_a_round(warm_seconds: list[float], seconds: float) -> int:
    """Return how many steps the fastest code makes in about `seconds`, a multiple of FEWEST_STEPS."""
    fastest = min(warm_seconds, default=math.inf)
    return FEWEST_STEPS * max(1, round(seconds / max(fastest, 1e-9) / FEWEST_STEPS))


def _in_turn(runners: list[_Runner], number: int) -> list[_Runner]:
    """Begin every round with another code: what comes next to what must not always be the same."""
    first = number % max(1, len(runners))
    return runners[first:] + runners[:first]


def _judged(tracks: dict[str, Track], runners: dict[str, _Runner]) -> dict[str, Track]:
    """Compare positions after the first steps with those of the first entrant."""
    first = next(iter(runners.values()))
    if tracks[first.entrant.label].status != "timed":
        return tracks
    judged = {}
    for label, track in tracks.items():
        runner = runners[label]
        if runner is first or track.status != "timed" or not runner.entrant.same_problem:
            judged[label] = track
            continue
        off = distance(first.entrant.system, first.places, runner.places)
        judged[label] = replace(track, off=off) if off <= SAME else Track(
            status="differs", off=off,
            reason=f"not the same problem: {off:.3g} rms displacements from the kernel after {WARM_STEPS} steps",
        )
    return judged


def distance(system: System, expected: np.ndarray, got: np.ndarray) -> float:
    """Return rms |got - expected| over the rms displacement of `expected` since the start; inf for NaN."""
    away = _rms_apart(system, got, expected) / _rms_apart(system, expected, system.particles.x)
    return away if math.isfinite(away) else math.inf


def _rms_apart(system: System, a: np.ndarray, b: np.ndarray) -> float:
    """Root mean square of |a - b| by the nearest images, m."""
    d = a - b
    if system.periodic is not None:
        period = np.where(np.array(system.periodic) > 0, system.periodic, np.inf)
        d -= np.where(np.isfinite(period), period, 0.0) * np.round(d / period)
    return math.sqrt(float((d**2).sum(axis=1).mean()))
