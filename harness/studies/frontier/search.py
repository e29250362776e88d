"""Bisection for the largest stable step: from theory's guess outwards until it is enclosed, then halved."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Literal

from harness.runs.outcome import usable_cores
from harness.scene.system import System
from harness.studies.frontier.probe import STEPS, Look, disturbed

if TYPE_CHECKING:
    from collections.abc import Callable
    from pathlib import Path

    from harness.engines.protocol import Engine
    from harness.studies.frontier.keep import Kept

PRECISION = 0.01
"""Width of the bracket at the end, over its middle."""

FIRST = 0.03
"""The first two looks are this far below and above the guess."""

WIDEN = 1.6
"""Factor of the following ones, while the limit is not enclosed."""

LOWEST, HIGHEST = 0.1, 8.0
"""Of the guess: nothing is looked for beyond."""

REFUSED, BEFORE_A_STEP = "refused", "step 0:"
"""Word for an engine that does not begin at all, and what its reasons say then."""

End = Literal["", "grew", "stopped", "refused"]
"""Of the smallest unstable step: motions grew, the code broke off on the way, or it did not begin."""

LOOKS = 5
"""That a search takes, about (measured: 5.1 on the mean of 36)."""

SIDE_BY_SIDE = 2
"""Searches that are under way for every run at a time: the next look of one waits for those of the others."""


@dataclass(kw_only=True)
class Search:
    """The search for one frontier; `next_step` asks for a look, `tell` answers. precision: see PRECISION."""

    guess: float
    precision: float = PRECISION
    looks: list[Look] = field(default_factory=list)

    @property
    def stable(self) -> float | None:
        """Largest step below all unstable ones that was seen to be stable, s."""
        ends = [x.dt for x in self.looks if x.seen == "stable" and x.dt < (self.unstable or math.inf)]
        return max(ends, default=None)

    @property
    def unstable(self) -> float | None:
        """Smallest step that was seen to be unstable, s."""
        return min((x.dt for x in self.looks if x.seen == "unstable"), default=None)

    @property
    def end(self) -> End:
        """What the smallest unstable step did, "" if there is none."""
        first = min((x for x in self.looks if x.seen == "unstable"), key=lambda x: x.dt, default=None)
        if first is None:
            return ""
        return "refused" if BEFORE_A_STEP in first.reason else "stopped" if first.reason else "grew"

    @property
    def fault(self) -> str:
        """Why the search was given up, "" if it was not."""
        failed = next((x for x in self.looks if x.seen == "failed"), None)
        if failed is not None:
            return failed.reason
        if self.stable is None and self.unstable is not None and self.unstable <= LOWEST * self.guess * 1.001:
            how = REFUSED if all(BEFORE_A_STEP in x.reason for x in self.looks) else "unstable"
            return f"{how} at every step down to {LOWEST:g} of the guess"
        if self.unstable is None and self.stable is not None and self.stable >= HIGHEST * self.guess / 1.001:
            return f"stable at every step up to {HIGHEST:g} of the guess"
        return ""

    @property
    def done(self) -> bool:
        """Whether the limit is enclosed as closely as asked for, or never will be."""
        if self.fault:
            return True
        enclosed = self.stable is not None and self.unstable is not None
        return enclosed and self.unstable - self.stable <= self.precision * self.middle

    @property
    def middle(self) -> float:
        """Of the bracket, s."""
        return math.sqrt(self.stable * self.unstable)

    def next_step(self) -> float:
        """Return the step to look at next, s."""
        if not self.looks:
            return self.guess * (1 - FIRST)
        if self.unstable is None:
            return min(self._beyond(self.stable, up=True), HIGHEST * self.guess)
        if self.stable is None:
            return max(self._beyond(self.unstable, up=False), LOWEST * self.guess)
        return self.middle

    def _beyond(self, end: float, *, up: bool) -> float:
        """The guess' other side first, then further and further."""
        if up and end < self.guess:
            return self.guess * (1 + FIRST)
        return end * WIDEN if up else end / WIDEN

    def tell(self, look: Look) -> None:
        """Take what was seen."""
        self.looks.append(look)


@dataclass(frozen=True, kw_only=True)
class Wanted:
    """A frontier to be searched for: a system at rest, the engine, and where theory expects it, s.

    steps: of a look; with `steps_at`, of the step in s, on the mean.
    """

    label: str
    engine: Engine
    rest: System
    guess: float
    steps: int = STEPS
    steps_at: Callable[[float], int] | None = None

    def disturbed(self, dt: float) -> System:
        """Return what a look at a step of dt, s, runs."""
        return disturbed(self.rest, dt, self.steps if self.steps_at is None else self.steps_at(dt))

    @property
    def seconds(self) -> float:
        """What the search takes, roughly."""
        look = self.engine.startup_seconds + 1e-6 * self.engine.microseconds_per_step(self.rest) * self.steps
        return LOOKS * look


def search_all(
    wanted: list[Wanted], root: Path, *, time_limit: float, workers: int | None = None, precision: float = PRECISION,
    kept: Kept | None = None, tell: Callable[[int, Search], None] = lambda *_: None,
) -> list[Search]:
    """Search for all frontiers, the longest first, a few side by side; runs are kept and reused below `root`.

    kept: where finished searches are read from and put as soon as they are done. tell: is told of every search, by its
    number, when it begins and after each of its looks.
    """
    searches = [
        Search(guess=w.guess, precision=precision, looks=kept.looks(w, precision) if kept else []) for w in wanted
    ]
    for k in (k for k, search in enumerate(searches) if search.done):
        tell(k, searches[k])
    waiting = sorted((k for k, s in enumerate(searches) if not s.done), key=lambda k: -wanted[k].steps)
    open_ones: list[int] = []
    while waiting or open_ones:
        begun = waiting[: SIDE_BY_SIDE * (workers or usable_cores()) - len(open_ones)]
        waiting = waiting[len(begun):]
        for k in begun:
            tell(k, searches[k])
        open_ones += begun
        _look_once(wanted, searches, open_ones, root, time_limit=time_limit, workers=workers)
        for k in open_ones:
            if kept and searches[k].done:
                kept.put(wanted[k], searches[k])
            tell(k, searches[k])
        open_ones = [k for k in open_ones if not searches[k].done]
    return searches


def _look_once(
    wanted: list[Wanted], searches: list[Search], chosen: list[int], root: Path, *, time_limit: float,
    workers: int | None,
) -> None:
    """Take the next look of each of the chosen searches, side by side."""
    from harness.runs.pool import run_many
    from harness.studies.frontier.probe import look

    steps = {k: searches[k].next_step() for k in chosen}
    jobs = [(wanted[k].label, wanted[k].engine, wanted[k].disturbed(steps[k])) for k in chosen]
    made = run_many(jobs, root, time_limit=time_limit, workers=workers, native="drop")
    for k, done in zip(chosen, made, strict=True):
        searches[k].tell(look(done, steps[k]))
