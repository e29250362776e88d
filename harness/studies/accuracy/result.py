"""What a ladder gave: values that tables, figures and words are made of."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from harness.studies.accuracy.cost import Cost
from harness.studies.accuracy.fit import RESOLVED, Fit, rms, step_for, why_no_fit


@dataclass(frozen=True, kw_only=True, eq=False)
class Point:
    """One rung of one engine. status: that of the run, else "unstable" or "unfinished".

    rung: dt_fraction as asked for. value: that of the step that ran, which is shorter where so many whole steps make
    the duration. errors: (K,) by quantity, over phases; empty unless completed. seconds: CPU time of all steps, None if
    not timed. beyond: the largest dt_fraction that the scene takes, if the step that ran is longer.
    """

    rung: float
    value: float
    dt: float
    steps: int
    status: str
    reason: str
    errors: Mapping[str, np.ndarray]
    seconds: float | None
    process_seconds: float | None
    beyond: float | None = None

    @property
    def good(self) -> bool:
        """Whether there is an error to be drawn."""
        return self.status == "completed"

    @property
    def resolved(self) -> bool:
        """Whether it is one of those that an order is fitted over: good, and with enough steps a contact."""
        return self.good and self.rung <= RESOLVED * (1.0 + 1e-9)

    @property
    def offered(self) -> bool:
        """Whether it has a time, and a scene with this step can be run."""
        return self.seconds is not None and self.beyond is None

    def size(self, quantity: str) -> float:
        """Return the root mean square over phases."""
        return float(rms(self.errors[quantity]))

    def range(self, quantity: str) -> tuple[float, float]:
        """Return the 10 and 90 per cent quantiles over phases."""
        low, high = np.quantile(self.errors[quantity], (0.1, 0.9))
        return float(low), float(high)


@dataclass(frozen=True, kw_only=True, eq=False)
class Track:
    """All rungs of one engine in one case, cheapest first. oracle: error of what it is held against, by quantity.

    parted: how far the limit of its laws is from that of the talks' laws, by quantity; None where it is not known.
    """

    case: str
    engine: str
    points: tuple[Point, ...]
    cost: Cost
    fits: Mapping[str, Fit | None]
    oracle: Mapping[str, float]
    oracle_says: str
    round_off: float | None
    growth: float | None
    parted: Mapping[str, float]

    def known(self, quantity: str) -> tuple[Point, ...]:
        """Return the good rungs that have this quantity."""
        return tuple(p for p in self.points if p.good and quantity in p.errors)

    def why_no_fit(self, quantity: str) -> str:
        """Return why no order is fitted, "" if one is."""
        size = [p.size(quantity) for p in self.known(quantity) if p.resolved]
        return why_no_fit(size, len(self.points), oracle=self.oracle.get(quantity, 0.0))

    def steps_for(self, quantity: str, target: float) -> float | None:
        """Return how many steps keep the error below `target`, None where the ladder does not tell."""
        known = self.known(quantity)
        if len(known) < 2:
            return None
        dt = step_for([p.dt for p in known], [p.size(quantity) for p in known], target)
        return None if dt is None else known[0].dt * known[0].steps / dt


@dataclass(frozen=True, kw_only=True)
class Choice:
    """The cheapest setting that keeps an error below a target; None where no rung does."""

    target: float
    track: Track | None
    point: Point | None


TARGETS = (0.1, 0.01, 0.001)


def cheapest(track: Track, quantity: str, target: float) -> Point | None:
    """Return the first rung from which on all are below the target, have a time, and can be run as a scene, or None."""
    known = track.known(quantity)
    found = None
    for point in reversed(known):
        if point.size(quantity) > target or not point.offered:
            break
        found = point
    return found


def best(tracks: list[Track], quantity: str, target: float) -> Choice:
    """Return the cheapest setting of all tracks."""
    found = [(t, p) for t in tracks if (p := cheapest(t, quantity, target)) is not None]
    track, point = min(found, key=lambda tp: tp[1].seconds, default=(None, None))
    return Choice(target=target, track=track, point=point)


def front(tracks: list[Track], quantity: str) -> list[tuple[Track, Point]]:
    """Return the points than which no other is both faster and better, fastest first."""
    points = [(t, p) for t in tracks for p in t.known(quantity) if p.offered]
    kept: list[tuple[Track, Point]] = []
    for track, point in sorted(points, key=lambda tp: (tp[1].seconds, tp[1].size(quantity))):
        if not kept or point.size(quantity) < kept[-1][1].size(quantity):
            kept.append((track, point))
    return kept
