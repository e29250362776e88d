"""How long runs and comparisons are expected to take: rough, from what was measured of each engine on one core."""

from __future__ import annotations

import heapq
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from functools import singledispatch
from pathlib import Path
from typing import TYPE_CHECKING

from harness.engines.protocol import REFUSED, Engine, takes
from harness.engines.registry import find_engine
from harness.packing.stand_in import stand_in
from harness.scene.model import Biaxial, Couette, Scene
from harness.scene.resolve import known_system, needs_packing, resolve
from harness.scene.system import System

if TYPE_CHECKING:
    from harness.studies.reproduce.protocol import Case

REPORT_SECONDS = 2.0
"""Start and a page (measured: 1.7 s for two bodies)."""
RUN_SECONDS = 0.4
"""Reading, checking and judging one run (33 runs of 200 discs: 20 s)."""
PARTICLE_FRAME_SECONDS = 2.5e-5
"""Averaging and drawing a particle in a frame (947 in 5 runs of 250 frames: 28 s; 1950 in 5 of 50: 19 s)."""


@dataclass(frozen=True, kw_only=True)
class Expected:
    """A comparison: `seconds` in all, of how many runs on how many packings, with how many runs at a time.

    beside: what else takes time, in words.
    """

    seconds: float
    runs: int
    packings: int
    at_once: int
    beside: str = ""

    @property
    def says(self) -> str:
        """What is counted."""
        packed = f" and {self.packings} packing{'s' * (self.packings > 1)}" if self.packings else ""
        side = f", {self.at_once} at a time" if self.at_once > 1 else ""
        runs = f"{self.runs} run{'s' * (self.runs != 1)}"
        beside = f", {self.beside}" if self.beside else ""
        return f"{runs}{packed}{side}{beside}, on idle cores; what --out holds already is not made again"


def likely_system(scene: Scene, path: Path) -> System:
    """Return the system as far as it is known, else one with as many particles of the same kind. Raises InputError."""
    return known_system(scene, path) or resolve(scene, path, stand_in(scene))


def run_seconds(engine: Engine, system: System) -> float:
    """Return the seconds of one run; see `microseconds_per_step` of each engine for what was measured."""
    return engine.startup_seconds + 1e-6 * engine.microseconds_per_step(system) * system.steps


def judging_seconds(system: System, runs: int) -> float:
    """Return the seconds in which runs are read, averaged, judged and drawn; REPORT_SECONDS come once."""
    frames = system.steps // system.frame_every
    return runs * (RUN_SECONDS + PARTICLE_FRAME_SECONDS * frames * len(system.particles))


def refusals(engine: Engine, system: System) -> list[str]:
    """Return why an engine would not run the system; empty if it would."""
    refused = (s for s in engine.supports(system) if s.level in REFUSED)
    return list(dict.fromkeys(f"{s.effect}: {s.note}" for s in refused))


def expected_comparison(
    scene: Scene, system: System, engines: Sequence[Engine], *, starts: int, workers: int | None = None
) -> Expected:
    """Return what a comparison of `engines` from `starts` packings takes, as `run_many` shares runs out.

    Engines that are missing or would refuse the system are not run. Packings are made one after the other.
    """
    from harness.runs.outcome import usable_cores
    from harness.studies.compare.replicates import responder
    from harness.studies.compare.study import distinct_engines

    able = [e for e in distinct_engines(tuple(engines), scene) if e.probe().available and takes(e, system)]
    kicked = responder(scene, able)
    costs = [run_seconds(e, system) for e in able] * starts + ([run_seconds(kicked, system)] if kicked else [])
    at_once = max(1, min(workers or usable_cores(), len(costs)))
    packings = starts if needs_packing(scene) else 0
    return Expected(
        seconds=packings * packing_seconds(scene, system) + longest_first(costs, at_once)
        + judging_seconds(system, len(costs)) + REPORT_SECONDS,
        runs=len(costs), packings=packings, at_once=at_once,
    )


def longest_first(costs: Iterable[float], workers: int) -> float:
    """Return when the last of several jobs ends if the longest is always begun next.

    >>> longest_first([3.0, 1.0, 2.0, 2.0], 2)
    4.0
    """
    ends = [0.0] * workers
    for cost in sorted(costs, reverse=True):
        heapq.heapreplace(ends, ends[0] + cost)
    return max(ends)


@dataclass(frozen=True, kw_only=True)
class ExpectedCases(Expected):
    """Several scenes; cpu: seconds of all runs together."""

    cpu: float


def expected_cases(
    cases: Sequence[Case], engines: Sequence[Engine], *, workers: int | None = None, beyond: float = 0.0
) -> ExpectedCases:
    """Return what the runs of a study's cases take together, packings included. beyond: s, of what are no runs."""
    from harness.runs.outcome import usable_cores

    costs: list[float] = []
    packing, packings, judging = 0.0, 0, REPORT_SECONDS + beyond
    for case in cases:
        system = likely_system(case.scene, case.file)
        each = [run_seconds(e, system) for e in engines if e.probe().available and takes(e, system)]
        costs += each * case.packings
        judging += judging_seconds(system, len(each) * case.packings)
        if needs_packing(case.scene):
            packing += case.packings * packing_seconds(case.scene, system)
            packings += case.packings
    at_once = max(1, min(workers or usable_cores(), len(costs)))
    return ExpectedCases(
        seconds=packing + longest_first(costs, at_once) + judging, cpu=packing + sum(costs) + judging,
        runs=len(costs),
        packings=packings, at_once=at_once,
    )


# --- by kind of scene ------------------------------------------------------------------------


@singledispatch
def packing_seconds(scene: Scene, system: System) -> float:  # noqa: ARG001
    """Return the seconds in which the start of a scene is made; 0 for one that stands in its file."""
    return 0.0


@packing_seconds.register
def _(scene: Biaxial, system: System) -> float:  # noqa: ARG001
    """Measured at 100 N/m: 1.0 s for 200 discs, 23 s for 1950."""
    return 1.0 * (len(system.particles) / 200) ** 1.38


@packing_seconds.register
def _(scene: Couette, system: System) -> float:
    """The kernel computes it, step by step."""
    steps = (scene.preparation.grow + scene.preparation.settle) / system.dt
    return 1e-6 * find_engine("kernel").microseconds_per_step(system) * steps
