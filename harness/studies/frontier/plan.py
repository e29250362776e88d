"""What is searched for: laws times packings and the map, on every engine, and what is left out and why."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from harness.engines.registry import ENGINES, KERNEL_PREFIX, choose_engines
from harness.scene.laws import turning
from harness.scene.system import System
from harness.studies.frontier import laws, packings
from harness.studies.frontier.late import TYPICAL, Followed
from harness.studies.frontier.laws import LawCase
from harness.studies.frontier.map import AXES
from harness.studies.frontier.packings import PackingCase, resting_system
from harness.studies.frontier.probe import STEPS
from harness.studies.frontier.rest import at_rest, unrest
from harness.studies.frontier.search import LOWEST, Wanted
from harness.studies.frontier.theory import Theory, felt_late, linear_packing, scheme, theory_of

if TYPE_CHECKING:
    from harness.engines.protocol import Engine
    from harness.runs.progress import Progress

USUAL = ("lammps", "liggghts", "kernel:lammps", "kernel:talk")
"""The codes, the kernel as they do it, and as the talks do: its friction springs are felt one step late."""

PLANNING = "packings and exact limits"
"""How the first part of the study is called."""

EVERY = "all"
"""In the place of an engine: a packing that is no state at rest is left out for all of them."""

Skipped = tuple[str, str, str, str]
"""Engine, law, packing, and why it was left out."""


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
class Planned:
    """A frontier to be found: a case as a system at rest, an engine, and what theory says of its scheme."""

    case: Case
    engine: Engine
    rest: System
    theory: Theory

    @property
    def followed(self) -> Followed | None:
        """How long motions are followed if springs are felt late; None: as long as all others."""
        if not felt_late(self.engine.name, self.rest) or self.theory.exact is None:
            return None
        packing = linear_packing(self.rest, late=True)
        return Followed(packing=packing, limit=self.theory.exact, lowest=LOWEST * self.theory.guess)

    @property
    def wanted(self) -> Wanted:
        """The search for it."""
        followed = self.followed
        return Wanted(
            label=f"{self.engine.name}: {self.case.label}", engine=self.engine, rest=self.rest,
            guess=self.theory.guess, steps=looked_steps(self.engine, self.rest),
            steps_at=None if followed is None else followed.steps,
        )


def looked_steps(engine: Engine, rest: System) -> int:
    """Return the steps of one look, on the mean where springs are felt late."""
    return TYPICAL if felt_late(engine.name, rest) else STEPS


def chosen_engines(names: Sequence[str] | None) -> tuple[Engine, ...]:
    """Return the engines that were asked for, or the usual ones. Raises InputError."""
    return choose_engines(list(names)) if names else tuple(ENGINES[name] for name in USUAL)


def late_packings(*, full: bool) -> Sequence[PackingCase]:
    """Return the packings on which springs that are felt late are followed, which takes many steps."""
    return packings.WHOLE if full else packings.QUICK[:1]


def frontier_cases(*, full: bool) -> list[Case]:
    """Return laws times packings, then the map. The quick size has the rarer laws on its first packing only."""
    chosen = packings.WHOLE if full else packings.QUICK
    cases = [Case(law=law, packing=packing) for packing in chosen for law in _laws(packing, full=full)]
    for axis in AXES:
        cases += [
            Case(law=axis.law(v), packing=axis.packing(v), axis=axis.name, value=v) for v in axis.values(full=full)
        ]
    return cases


def _laws(packing: PackingCase, *, full: bool) -> list[LawCase]:
    """Of a packing: twisting needs three dimensions."""
    if not full:
        return [*laws.QUICK, *(laws.RARE if packing in packings.QUICK[:1] else ())]
    return [law for law in laws.WHOLE if law.contact.torsion is None or packing.dimension == 3]


def planned(
    cases: list[Case], engines: Sequence[Engine], cache: Path, late: Sequence[PackingCase], shown: Progress
) -> tuple[list[Planned], list[Skipped]]:
    """Return every search, with what theory expects, and what is left out and why. late: see `wanted_of`."""
    plan, skipped = [], []
    shown.begin([PLANNING], [float(len(cases))])
    try:
        for number, case in enumerate(cases):
            shown.running(0, number / len(cases))
            found, left = _of_case(case, engines, cache, late)
            plan += found
            skipped += [(name, case.law.name, case.packing.name, why) for name, why in left]
        shown.done(0, f"{PLANNING}: {len(plan)} frontiers to be found")
    finally:
        shown.end()
    return plan, list(dict.fromkeys(skipped))


def _of_case(
    case: Case, engines: Sequence[Engine], cache: Path, late: Sequence[PackingCase]
) -> tuple[list[Planned], list[tuple[str, str]]]:
    """Return the searches of a case, and the engines that are left out, with the reason."""
    rest = at_rest(resting_system(case.packing, case.packing.make(cache), case.law))
    why = unrest(rest)
    if why:
        return [], [(EVERY, why)]
    able, refused = wanted_of(case, rest, engines, late)
    known = {scheme(e.name): theory_of(rest, e.name) for e in _one_each(able)}
    found = [Planned(case=case, engine=e, rest=rest, theory=known[scheme(e.name)]) for e in able]
    unseen = {p.engine.name: p.followed.unseen() for p in found if p.followed is not None}
    left = [(e.name, said) for e, said in refused] + [(name, said) for name, said in unseen.items() if said]
    return [p for p in found if not unseen.get(p.engine.name)], left


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
    return tuple(dict.fromkeys(_stand_ins(engines)))


def _stand_ins(engines: Sequence[Engine]) -> Iterator[Engine]:
    for e in engines:
        leapfrog = e.name.startswith(KERNEL_PREFIX) and e.name != "kernel:corrected"
        yield ENGINES["kernel:talk"] if leapfrog else e
