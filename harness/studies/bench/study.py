"""All cases at all their sizes, one after the other: two cells at a time would disturb each other."""

from __future__ import annotations

import os
import tempfile
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from harness.engines.benches import BENCHES, KERNEL
from harness.engines.rounds import can_pin
from harness.engines.session import Session
from harness.engines.timed import Timed
from harness.runs.outcome import Host, host_facts
from harness.studies.bench.cases import CASES, MEAN_RADIUS, Case
from harness.studies.bench.measure import WARM_STEPS, Effort, Entrant, Opener, Track, measure
from harness.studies.bench.packing import BenchPacking
from harness.studies.bench.problem import problem

if TYPE_CHECKING:
    from harness.runs.progress import Progress

QUICK, FULL = Effort(rounds=5, seconds=0.03), Effort(rounds=9, seconds=0.15)

SLOW_SHARE = 0.125
"""Part of a round's steps that slow codes make."""

SLOW_LIMIT = {True: 2000, False: 20_000}
"""Largest number of particles for slow codes, quick or not."""

QUICK_EXTRAS = (2000, 20_000)
"""Sizes at which a quick run has slow codes and the kernel in the case's base; a full one has them at all."""

FEW_PARTICLES = 12

ANSWER_LIMIT = 600.0
"""Seconds within which a code has to answer."""

TIME_LIMIT = {True: 600.0, False: 3600.0}
"""Seconds after which no further cell is begun, quick or not; the largest takes two minutes or three."""

OUT_OF_TIME = "the time was up"


@dataclass(frozen=True, kw_only=True)
class Cell:
    """One case at one size, timed. load: runnable processes of the machine when it ended.

    steps_made: of the kernel, with those before the rounds. seconds: on the clock, with packing and set-up.
    """

    case: Case
    count: int
    packing: BenchPacking
    tracks: dict[str, Track]
    load: float
    steps_made: int
    seconds: float


@dataclass(frozen=True, kw_only=True)
class Bench:
    """What was timed, where. kernel, others: names of the codes. skipped: cases that the kernel does not compute,
    with the reason. left_out: case and particle number of the cells for which there was no time.

    notes: how each code computes. versions: of those that are here. core: what all children were pinned to; None
    if the system cannot.
    """

    quick: bool
    cells: tuple[Cell, ...]
    skipped: dict[str, str]
    left_out: tuple[tuple[str, int], ...]
    kernel: str
    others: tuple[str, ...]
    notes: dict[str, str]
    versions: dict[str, str]
    host: Host
    core: int | None
    effort: Effort

    @property
    def exit_status(self) -> int:
        """1 when a code failed or solved another problem, else 0: how fast anything is, is no verdict."""
        bad = ("lost", "differs")
        return int(any(t.status in bad for cell in self.cells for t in cell.tracks.values()))


@dataclass(frozen=True, kw_only=True)
class _Field:
    """Who takes part in every cell, and how it is timed."""

    timed: Sequence[Timed]
    kernel: Timed
    cases: Mapping[str, Case]
    opener: Opener
    effort: Effort
    cache: Path

    def base_entrants(self, case: Case, count: int) -> list[Entrant]:
        """Return the kernel in the case's base, if it has one."""
        if case.base is None:
            return []
        base = self.cases[case.base]
        system, _ = problem(base, count, cache=self.cache)
        return [Entrant(label=base_label(self.kernel, case), timed=self.kernel, system=system,
                        skin=base.skin * MEAN_RADIUS, same_problem=False)]


def announced(*, quick: bool, time_limit: float | None = None, cases: Sequence[Case] = CASES) -> str:
    """Return one line on how much there is to do, and when it ends at the latest."""
    counts = [n for c in cases for n in (c.quick if quick else c.full)]
    minutes = (TIME_LIMIT[quick] if time_limit is None else time_limit) / 60.0
    return f"{len(counts)} cells, up to {max(counts)} particles; none is begun later than after {minutes:.3g} minutes"


def bench(
    *, quick: bool, out: Path, progress: Callable[[], Progress] | None = None, cases: Sequence[Case] = CASES,
    timed: Sequence[Timed] = BENCHES, kernel: Timed = KERNEL, opener: Opener | None = None,
    effort: Effort | None = None, time_limit: float | None = None, clock: Callable[[], float] = time.monotonic,
) -> Bench:
    """Time all cases; packings are kept in ``out/packings``. `kernel` is one of `timed`.

    When the time limit (s; TIME_LIMIT unless given) is over no further cell is begun, and those left out are named.
    """
    end = clock() + (TIME_LIMIT[quick] if time_limit is None else time_limit)
    core = chosen_core()
    field = _Field(
        timed=timed, kernel=kernel, cases={c.name: c for c in cases}, cache=out / "packings",
        effort=effort or (QUICK if quick else FULL),
        opener=opener or (lambda t, folder: Session(t, folder, core=core, time_limit=ANSWER_LIMIT)),
    )
    skipped = {c.name: why for c in cases if (why := _refused_by_kernel(c, field))}
    plan = [(c, n) for c in cases if c.name not in skipped for n in (c.quick if quick else c.full)]
    probes = {t.name: t.probe() for t in timed}
    cells = tuple(_cells(plan, field, progress, quick=quick, in_time=lambda: clock() < end))
    return Bench(
        quick=quick, cells=cells, skipped=skipped, kernel=kernel.name,
        left_out=tuple((c.name, n) for c, n in plan[len(cells) :]),
        others=tuple(t.name for t in timed if t is not kernel), effort=field.effort, host=host_facts(), core=core,
        notes={t.name: t.note for t in timed}, versions={n: p.version for n, p in probes.items() if p.available},
    )


def _cells(
    plan, field: _Field, progress: Callable[[], Progress] | None, *, quick: bool, in_time: Callable[[], bool]
) -> Iterator[Cell]:
    with _shown(progress, plan) as shown:
        for job, (case, count) in enumerate(plan):
            if not in_time():
                return
            shown.running(job, 0.0)
            cell = _cell(case, count, field, quick=quick)
            shown.done(job, f"{case.name}, N = {count}: {_says(cell, field.kernel)}")
            yield cell


def _refused_by_kernel(case: Case, field: _Field) -> str:
    """Ask with a few particles: what there are operations for depends on the case alone."""
    return field.kernel.refusal(problem(case, FEW_PARTICLES, cache=field.cache)[0])


def chosen_core() -> int | None:
    """Return the last core that this process may use; None where the system cannot pin."""
    return max(os.sched_getaffinity(0)) if can_pin() else None


def base_label(kernel: Timed, case: Case) -> str:
    """Return the label of the kernel in the case's base."""
    return f"{kernel.name}, {case.base}"


def _cell(case: Case, count: int, field: _Field, *, quick: bool) -> Cell:
    start = time.monotonic()
    system, packing = problem(case, count, cache=field.cache)
    skin, extras = case.skin * MEAN_RADIUS, not quick or count in QUICK_EXTRAS
    slow = extras and count <= SLOW_LIMIT[quick]
    others = [t for t in field.timed if t is not field.kernel and (slow or not t.slow)]
    entrants = [
        Entrant(label=t.name, timed=t, system=system, skin=skin, share=SLOW_SHARE if t.slow else 1.0)
        for t in (field.kernel, *others)
    ]
    with tempfile.TemporaryDirectory(prefix="grainproof-bench-") as folder:
        entrants += field.base_entrants(case, count) if extras else []
        tracks = measure(entrants, Path(folder), field.opener, field.effort)
    made = WARM_STEPS + tracks[field.kernel.name].steps * field.effort.rounds
    return Cell(
        case=case, count=count, packing=packing, tracks=tracks, load=os.getloadavg()[0], steps_made=made,
        seconds=time.monotonic() - start,
    )


def _says(cell: Cell, kernel: Timed) -> str:
    """Return one line on the kernel, and who is not there."""
    track = cell.tracks[kernel.name]
    missing = [f"{label} {t.status}" for label, t in cell.tracks.items() if t.status != "timed"]
    times = [f"{1e6 * float(np.median(track.seconds)):.3g} us a step"] if track.status == "timed" else []
    return ", ".join(times + missing)


@contextmanager
def _shown(progress: Callable[[], Progress] | None, plan: list[tuple[Case, int]]) -> Iterator[Progress]:
    from harness.runs.progress import Silent

    shown = progress() if progress else Silent()
    shown.begin([f"{c.name}, N = {n}" for c, n in plan], [5000.0 + n for _, n in plan])
    try:
        yield shown
    finally:
        shown.end()
