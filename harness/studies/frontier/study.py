"""The study: every engine on every law and packing, and along the axes of the map; bisection, side by side."""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from harness.engines.registry import ENGINES, KERNEL_PREFIX, choose_engines
from harness.runs.folder import require_folder, runs_root
from harness.runs.outcome import Host, host_facts
from harness.scene.laws import turning
from harness.scene.system import System
from harness.studies.frontier import laws, packings
from harness.studies.frontier.formula import formula_limit
from harness.studies.frontier.keep import Kept
from harness.studies.frontier.laws import LawCase
from harness.studies.frontier.map import AXES
from harness.studies.frontier.packings import PackingCase, resting_system
from harness.studies.frontier.probe import LATE_STEPS, STEPS
from harness.studies.frontier.search import LOOKS, REFUSED, Search, Wanted, search_all
from harness.studies.frontier.theory import Theory, felt_late, linear_packing, scheme, theory_of, touching

if TYPE_CHECKING:
    from harness.engines.protocol import Engine
    from harness.runs.progress import Progress

USUAL = ("lammps", "liggghts", "kernel:lammps", "kernel:talk")
"""The codes, the kernel as they do it, and as the talks do: its friction springs are felt one step late."""

KEPT, PLANNING = "frontiers", "packings and exact limits"
"""Where finished frontiers are kept, and how the first part of the study is called."""

TIME_LIMIT = 120.0
"""Seconds of one run of some thousand steps of a hundred particles."""

TOLERANCE = 0.05
"""Measured and exact limits may differ by so much of the exact one where motions are linear."""


@dataclass(frozen=True, kw_only=True)
class Frontier:
    """One engine, law and packing. Steps are in s; `unit`: sqrt(m/k) of the lightest particle and the largest slope.

    exact: of theory, None where nothing was derived (`note` says why). formula: what scenes are refused beyond.
    stable, unstable: the bracket; None where there is none, and `fault` says why. axis, value: of the map, else "".
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
    def never(self) -> bool:
        """Whether every step that was tried is unstable."""
        return self.stable is None and self.unstable is not None

    @property
    def deviation(self) -> float | None:
        """Measured over exact limit, less 1; None where one of them is missing; 0 if both say: no step is stable."""
        if self.exact is None or self.measured is None or not self.linear:
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

    versions: by engine. wall_seconds: of the study this time, kept runs included.
    """

    size: str
    found: tuple[Frontier, ...]
    skipped: tuple[tuple[str, str, str, str], ...]
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


@dataclass(frozen=True, kw_only=True)
class Case:
    """A law on a packing; axis, value: of the map, else "" and None."""

    law: LawCase
    packing: PackingCase
    axis: str = ""
    value: float | None = None

    @property
    def label(self) -> str:
        """How a search is called."""
        at = f", {self.axis} = {self.value:g}" if self.axis else ""
        return f"{self.law.name}, {self.packing.name}{at}"


@dataclass(frozen=True, kw_only=True)
class _Planned:
    case: Case
    engine: Engine
    rest: System
    theory: Theory

    @property
    def label(self) -> str:
        return f"{self.engine.name}: {self.case.label}"

    @property
    def wanted(self) -> Wanted:
        steps = looked_steps(self.engine, self.rest)
        return Wanted(label=self.label, engine=self.engine, rest=self.rest, guess=self.theory.guess, steps=steps)


def looked_steps(engine: Engine, rest: System) -> int:
    """Return the steps of one look."""
    return LATE_STEPS if felt_late(engine.name, rest) else STEPS


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
    plan, skipped = _planned(cases, chosen, out / "packings", late, _display(progress))
    searches = _shown([p.wanted for p in plan], out, time_limit, workers, _display(progress))
    found = tuple(_frontier(p, search) for p, search in zip(plan, searches, strict=True))
    return Frontiers(
        size="full" if full else "quick", found=found, skipped=tuple(skipped), host=host_facts(),
        versions={e.name: e.probe().version for e in chosen}, wall_seconds=time.monotonic() - begun,
    )


def chosen_engines(names: Sequence[str] | None) -> tuple[Engine, ...]:
    """Return the engines that were asked for, or the usual ones. Raises InputError."""
    return choose_engines(list(names)) if names else tuple(ENGINES[name] for name in USUAL)


def late_packings(*, full: bool) -> Sequence[PackingCase]:
    """Return the packings on which springs that are felt late are followed, which takes many steps."""
    return packings.WHOLE if full else packings.QUICK[:1]


def measured_frontier(
    engine: Engine, rest: System, root: Path, *, law: str = "", packing: str = "", time_limit: float = TIME_LIMIT
) -> Frontier:
    """Return the frontier of one system at rest, of any law: for other studies. Runs are kept below `root`."""
    case = Case(
        law=LawCase(name=law, contact=None), packing=PackingCase(name=packing, dimension=rest.dimension, make=None)
    )
    planned = _Planned(case=case, engine=engine, rest=rest, theory=theory_of(rest, engine.name))
    return _frontier(planned, *search_all([planned.wanted], root, time_limit=time_limit))


def frontier_cases(*, full: bool) -> list[Case]:
    """Return laws times packings, then the map. The quick size has the rarer laws on its first packing only."""
    chosen = packings.WHOLE if full else packings.QUICK
    rare = chosen if full else chosen[:1]
    cases = [
        Case(law=law, packing=packing)
        for packing in chosen for law in (laws.WHOLE if packing in rare else laws.QUICK)
    ]
    for axis in AXES:
        cases += [
            Case(law=axis.law(v), packing=axis.packing(v), axis=axis.name, value=v) for v in axis.values(full=full)
        ]
    return cases


def _planned(
    cases: list[Case], engines: Sequence[Engine], cache: Path, late: Sequence[PackingCase], shown: Progress
) -> tuple[list[_Planned], list[tuple[str, str, str, str]]]:
    """Return every search, with what theory expects, and what is left out and why. late: see `wanted_of`."""
    plan, skipped = [], []
    shown.begin([PLANNING], [float(len(cases))])
    try:
        for number, case in enumerate(cases):
            shown.running(0, number / len(cases))
            rest = resting_system(case.packing, case.packing.make(cache), case.law)
            able, refused = wanted_of(case, rest, engines, late)
            known = {scheme(e.name): theory_of(rest, e.name) for e in _one_each(able)}
            plan += [_Planned(case=case, engine=e, rest=rest, theory=known[scheme(e.name)]) for e in able]
            skipped += [(e.name, case.law.name, case.packing.name, why) for e, why in refused]
        shown.done(0, f"{PLANNING}: {len(plan)} frontiers to be found")
    finally:
        shown.end()
    return plan, list(dict.fromkeys(skipped))


def wanted_of(
    case: Case, rest: System, engines: Sequence[Engine], late: Sequence[PackingCase]
) -> tuple[list[Engine], list[tuple[Engine, str]]]:
    """Return the engines whose frontier is searched for, and those that do not run the system, with the reason.

    late: the packings on which springs that are felt late are followed, which takes many steps; not on the map.
    """
    able, refused = [], []
    for engine in _distinct(engines, rest):
        if felt_late(engine.name, rest) and (case.axis or case.packing not in late):
            continue
        reason = _refusal(engine, rest)
        if reason:
            refused.append((engine, reason))
        else:
            able.append(engine)
    return able, refused


def _one_each(engines: Sequence[Engine]) -> list[Engine]:
    """Return an engine of every scheme among the engines: theory is the same for all of one."""
    return list({scheme(e.name): e for e in engines}.values())


def _refusal(engine: Engine, rest: System) -> str:
    """Return why an engine does not run a system, "" if it does."""
    from harness.engines.protocol import REFUSED

    probe = engine.probe()
    if not probe.available:
        return probe.detail
    return "; ".join(f"{s.effect}: {s.note}" for s in engine.supports(rest) if s.level in REFUSED)


def _distinct(engines: Sequence[Engine], system: System) -> tuple[Engine, ...]:
    """Without tangential laws all conventions of the kernel's leapfrog are one: `kernel:talk` stands for them."""
    if turning(system):
        return tuple(engines)
    leapfrogs = [e for e in engines if e.name.startswith(KERNEL_PREFIX) and e.name != "kernel:corrected"]
    single = (ENGINES["kernel:talk"] if e in leapfrogs else e for e in engines)
    return tuple(dict.fromkeys(single))


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


def _frontier(planned: _Planned, search: Search) -> Frontier:
    case, rest, theory = planned.case, planned.rest, planned.theory
    return Frontier(
        engine=planned.engine.name, law=case.law.name, packing=case.packing.name, system=rest,
        particles=len(rest.particles), contacts=len(touching(rest)[1]), unit=unit_of_time(rest),
        formula=formula_limit(rest), linear=case.law.linear, exact=theory.exact, note=theory.note,
        stable=search.stable, unstable=search.unstable, looks=len(search.looks), fault=search.fault, axis=case.axis,
        value=case.value,
    )


def unit_of_time(rest: System) -> float:
    """sqrt(m/k), s: of the lightest particle and the largest slope of a normal force among the contacts."""
    slope = np.max(linear_packing(rest).springs.normal)
    return math.sqrt(float(rest.particles.mass.min()) / float(slope))
