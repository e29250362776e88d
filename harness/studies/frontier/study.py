"""The study: every engine on every law and packing, and along the axes of the map; bisection, side by side."""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from harness.runs.folder import require_folder, runs_root
from harness.runs.outcome import Host, host_facts
from harness.scene.system import System
from harness.studies.frontier.formula import formula_limit
from harness.studies.frontier.keep import Kept
from harness.studies.frontier.laws import LawCase
from harness.studies.frontier.packings import PackingCase
from harness.studies.frontier.plan import Case, Planned, Skipped, chosen_engines, frontier_cases, late_packings, planned
from harness.studies.frontier.search import LOOKS, REFUSED, End, Search, Wanted, search_all
from harness.studies.frontier.theory import TOLERANCE, linear_packing, theory_of, touching

if TYPE_CHECKING:
    from harness.engines.protocol import Engine
    from harness.runs.progress import Progress

KEPT = "frontiers"
"""Where finished frontiers are kept."""

TIME_LIMIT = 120.0
"""Seconds of one run of some thousand steps of a hundred particles."""


@dataclass(frozen=True, kw_only=True)
class Frontier:
    """One engine, law and packing. Steps are in s; `unit`: sqrt(m/k) of the lightest particle and the largest slope.

    exact: of theory, None where nothing was derived (`note` says why). formula: what scenes are refused beyond.
    stable, unstable: the bracket; None where there is none, and `fault` says why. end: what the smallest unstable step
    did. axis, value: of the map, else "".
    """

    engine: str
    law: str
    packing: str
    system: System
    particles: int
    contacts: int
    unit: float
    formula: float
    linear: bool
    exact: float | None
    note: str
    stable: float | None
    unstable: float | None
    looks: int
    fault: str
    end: End
    axis: str = ""
    value: float | None = None

    @property
    def measured(self) -> float | None:
        """Middle of the bracket, s; 0 where every step is unstable; None where nothing was measured.

        An engine that refuses every step was not measured, but where theory says that none is stable, they agree.
        """
        if self.stable is not None and self.unstable is not None:
            return math.sqrt(self.stable * self.unstable)
        return 0.0 if self.never and not (self.refused and self.exact) else None

    @property
    def refused(self) -> bool:
        """Whether the engine began at none of the steps: it is more careful than theory, or right."""
        return self.fault.startswith(REFUSED)

    @property
    def careful(self) -> bool:
        """Whether the engine does not begin at steps that theory lets it take: nothing was measured up to the limit."""
        return self.end == "refused" and bool(self.exact) and (self.stable or 0.0) < self.exact

    @property
    def never(self) -> bool:
        """Whether every step that was tried is unstable."""
        return self.stable is None and self.unstable is not None

    @property
    def deviation(self) -> float | None:
        """Measured over exact limit, less 1; None where one of them is missing; 0 if both say: no step is stable.

        None, too, where the engine refuses below the limit: that says nothing about what grows.
        """
        if self.exact is None or self.measured is None or not self.linear or self.careful:
            return None
        if self.exact == 0.0:
            return 0.0 if self.never else math.inf
        return self.measured / self.exact - 1

    @property
    def verdict(self) -> str:
        """Word of the comparison with theory."""
        if self.deviation is None:
            return "not_checked"
        return "agrees" if abs(self.deviation) <= TOLERANCE else "differs"


@dataclass(frozen=True, kw_only=True)
class Frontiers:
    """Everything a report needs. skipped: what an engine does not compute, by engine, law and packing, and why.

    An engine called "all" stands for every one. versions: by engine. wall_seconds: of the study this time, kept runs
    included.
    """

    size: str
    found: tuple[Frontier, ...]
    skipped: tuple[Skipped, ...]
    versions: dict[str, str]
    host: Host
    wall_seconds: float

    @property
    def base(self) -> list[Frontier]:
        """Those of laws and packings as they are."""
        return [f for f in self.found if not f.axis]

    @property
    def exit_status(self) -> int:
        """1 when a frontier differs from theory, one was not found, or nothing was compared; a refusal is an answer."""
        verdicts = [f.verdict for f in self.found]
        missing = any(f.measured is None and not f.refused for f in self.found)
        return 1 if missing or "differs" in verdicts or "agrees" not in verdicts else 0


def frontiers(
    out: Path, *, full: bool = False, engines: Sequence[str] | None = None, time_limit: float = TIME_LIMIT,
    workers: int | None = None, progress: Callable[[], Progress] | None = None,
) -> Frontiers:
    """Measure all frontiers of a size; packings, runs and finished frontiers are kept and reused below `out`.

    Raises InputError for engines that do not exist, before anything is written.
    """
    begun = time.monotonic()
    chosen = chosen_engines(engines)
    require_folder(out / KEPT)
    cases, late = frontier_cases(full=full), late_packings(full=full)
    plan, skipped = planned(cases, chosen, out / "packings", late, _display(progress))
    searches = _shown([p.wanted for p in plan], out, time_limit, workers, _display(progress))
    found = tuple(_frontier(p, search) for p, search in zip(plan, searches, strict=True))
    return Frontiers(
        size="full" if full else "quick", found=found, skipped=tuple(skipped), host=host_facts(),
        versions={e.name: e.probe().version for e in chosen}, wall_seconds=time.monotonic() - begun,
    )


def measured_frontier(
    engine: Engine, rest: System, root: Path, *, law: str = "", packing: str = "", time_limit: float = TIME_LIMIT
) -> Frontier:
    """Return the frontier of one system at rest, of any law: for other studies. Runs are kept below `root`."""
    case = Case(
        law=LawCase(name=law, contact=None), packing=PackingCase(name=packing, dimension=rest.dimension, make=None)
    )
    one = Planned(case=case, engine=engine, rest=rest, theory=theory_of(rest, engine.name))
    return _frontier(one, *search_all([one.wanted], root, time_limit=time_limit))


def _display(progress: Callable[[], Progress] | None) -> Progress:
    from harness.runs.progress import Silent

    return progress() if progress else Silent()


def _shown(
    wanted: list[Wanted], out: Path, time_limit: float, workers: int | None, shown: Progress
) -> list[Search]:
    """Search, telling a display how far each search is; what was found in an earlier call is taken from there."""
    shown.begin([w.label for w in wanted], [w.seconds for w in wanted])

    def tell(number: int, search: Search) -> None:
        if search.done:
            shown.done(number, f"{wanted[number].label}: {_words(search)}")
        else:
            shown.running(number, min(0.9, len(search.looks) / LOOKS))

    try:
        return search_all(
            wanted, runs_root(out), time_limit=time_limit, workers=workers, tell=tell, kept=Kept(folder=out / KEPT)
        )
    finally:
        shown.end()


def _words(search: Search) -> str:
    return search.fault or f"stable at {search.stable:.4g} s, not at {search.unstable:.4g} s"


def _frontier(one: Planned, search: Search) -> Frontier:
    case, rest, theory = one.case, one.rest, one.theory
    return Frontier(
        engine=one.engine.name, law=case.law.name, packing=case.packing.name, system=rest,
        particles=len(rest.particles), contacts=len(touching(rest)[1]), unit=unit_of_time(rest),
        formula=formula_limit(rest), linear=case.law.linear, exact=theory.exact, note=theory.note,
        stable=search.stable, unstable=search.unstable, looks=len(search.looks), fault=search.fault, end=search.end,
        axis=case.axis, value=case.value,
    )


def unit_of_time(rest: System) -> float:
    """sqrt(m/k), s: of the lightest particle and the largest slope of a normal force among the contacts."""
    slope = np.max(linear_packing(rest).springs.normal)
    return math.sqrt(float(rest.particles.mass.min()) / float(slope))
