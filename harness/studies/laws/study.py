"""Prove contact laws: prescribed motion, then collisions; a matrix of laws and engines, and every check.

laws x engines -> runs -> reactions -> checks -> cells, one combination of laws at a time; then the same for collisions.
"""

from __future__ import annotations

import shlex
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import TYPE_CHECKING

from harness.engines.registry import ENGINES, KERNEL_PREFIX, kernel_of, word_of
from harness.errors import InputError
from harness.runs.folder import require_root
from harness.runs.outcome import usable_cores
from harness.scene.describe import nearest
from harness.studies.laws.arrangement import arrangement
from harness.studies.laws.cases import CASES, Laws
from harness.studies.laws.collide import collide, distinct
from harness.studies.laws.collisions import Exit
from harness.studies.laws.curves import Curve, curves
from harness.studies.laws.direct import code_pairs, direct_checks
from harness.studies.laws.drive import Driven, Driver, Job
from harness.studies.laws.judge import convention_of, judge_engine
from harness.studies.laws.matrix import Answered, Cell, direct_cell, make_cell
from harness.studies.laws.reach import Reach, reach
from harness.studies.laws.stepped import Stepper
from harness.studies.verdict import Check, failed

if TYPE_CHECKING:
    from harness.engines.protocol import Engine
    from harness.runs.progress import Progress

TIME_LIMIT = 120.0
"""Seconds after which an engine's run is ended, unless the user says otherwise; it takes one or two."""


@dataclass(frozen=True, kw_only=True)
class LawsResult:
    """Everything a report needs. prescribed, collisions: the two matrices, cells in order of laws and engines.

    direct: codes against each other in prescribed motion and in collisions, cells in order of laws and pairs.
    exits: what single impacts have closed forms for. reaches: how much friction carries. versions: by engine.
    """

    laws: tuple[Laws, ...]
    engines: tuple[str, ...]
    prescribed: tuple[Cell, ...]
    collisions: tuple[Cell, ...]
    direct: tuple[tuple[Cell, ...], tuple[Cell, ...]]
    exits: tuple[Exit, ...]
    reaches: tuple[Reach, ...]
    checks: tuple[Check, ...]
    curves: tuple[Curve, ...]
    versions: dict[str, str]
    rerun: Rerun

    @property
    def has_all_laws(self) -> bool:
        """Is it about every combination that there is?"""
        return {each.name for each in self.laws} == set(CASES)

    @property
    def has_all_engines(self) -> bool:
        """Is it about every engine that there is?"""
        return set(self.engines) == set(ENGINES)

    @property
    def whole(self) -> bool:
        """Is it about everything? A part must not take the place of the whole."""
        return self.has_all_laws and self.has_all_engines

    @property
    def exit_status(self) -> int:
        """1 when a check differs, a run failed or nothing was compared; else 0."""
        broken = any(c.shown == "failed" for c in (*self.prescribed, *self.collisions))
        return 1 if broken or failed(self.checks) else 0


@dataclass(frozen=True, kw_only=True)
class Rerun:
    """The command that repeats the study for some laws and engines. words: what a user types, by engine's name.

    >>> Rerun(out=Path("out"))("linear", "lammps")
    'grainproof laws --law linear --engines lammps --out out'
    """

    out: Path
    words: Mapping[str, str] = field(default_factory=dict)

    def __call__(self, laws: str, engines: str) -> str:
        """Return the command, quoted for a shell. engines: names, with commas between them."""
        typed = ",".join(self.words.get(name, name) for name in engines.split(","))
        return shlex.join(["grainproof", "laws", "--law", laws, "--engines", typed, "--out", str(self.out)])


def choose_laws(words: Sequence[str]) -> tuple[Laws, ...]:
    """Return the combinations a user named, all if none; raises InputError for an unknown one."""
    for word in words:
        if word not in CASES:
            expected = f"one of {', '.join(CASES)}"
            raise InputError(file="--law", expected=expected, got=word or "nothing", fix=nearest(word, CASES))
    return tuple(CASES[w] for w in dict.fromkeys(words or CASES))


def with_kernels(engines: Sequence[Engine]) -> tuple[Engine, ...]:
    """Return the engines with, behind them, the kernel in the conventions of each code among them."""
    own = [ENGINES[kernel_of(e.name)] for e in engines if kernel_of(e.name) in ENGINES]
    return tuple({e.name: e for e in (*engines, *own)}.values())


def prove_laws(
    laws: Sequence[Laws], engines: Sequence[Engine], out: Path, *, time_limit: float = TIME_LIMIT,
    workers: int | None = None, progress: Callable[[], Progress] | None = None,
) -> LawsResult:
    """Drive and collide all combinations on all engines; runs are kept below ``out/prescribed`` and ``out/runs``.

    Raises InputError when they cannot be kept there.
    """
    engines = with_kernels(engines)
    driver = Driver(root=out / "prescribed", time_limit=time_limit, workers=workers or usable_cores())
    require_root(driver.root)
    rerun = Rerun(out=out, words={e.name: word_of(e) for e in engines})
    proven = _prove_prescribed(laws, engines, driver, rerun, progress)
    hit = collide(
        laws, engines, out, rerun=rerun, time_limit=time_limit, workers=workers, progress=progress and progress()
    )
    return LawsResult(
        laws=tuple(laws), engines=tuple(e.name for e in engines), prescribed=tuple(proven.cells), collisions=hit.cells,
        direct=(_direct_cells(laws, engines, proven.checks), _direct_cells(laws, engines, hit.checks)),
        exits=hit.exits, reaches=tuple(proven.reaches), checks=(*proven.checks, *hit.checks),
        curves=tuple(proven.curves), versions={e.name: e.probe().version for e in engines}, rerun=rerun,
    )


def _direct_cells(laws: Sequence[Laws], engines: Sequence[Engine], checks: Sequence[Check]) -> tuple[Cell, ...]:
    pairs = code_pairs(e.name for e in engines)
    return tuple(direct_cell(each.name, pair, checks) for each in laws for pair in pairs)


# --- prescribed motion -----------------------------------------------------------------------------


@dataclass(frozen=True, kw_only=True)
class _Proven:
    """What prescribed motion has shown; reactions themselves are let go, one combination after the other."""

    cells: list[Cell] = field(default_factory=list)
    checks: list[Check] = field(default_factory=list)
    reaches: list[Reach] = field(default_factory=list)
    curves: list[Curve] = field(default_factory=list)


def _prove_prescribed(
    laws: Sequence[Laws], engines: Sequence[Engine], driver: Driver, rerun: Rerun, progress
) -> _Proven:
    proven = _Proven()
    for each, runs in zip(laws, _driven(laws, engines, driver, progress), strict=True):
        found = _judge(each, runs, engines, rerun)
        proven.cells.extend(
            make_cell(each.name, name, [_answered(r) for r in of], found[name])
            for name, of in _by_engine(runs, engines).items()
        )
        proven.checks.extend(c for of in found.values() for c in of)
        proven.reaches.extend(_reaches(runs))
        proven.curves.extend(curves(runs))
    return proven


def _driven(laws: Sequence[Laws], engines: Sequence[Engine], driver: Driver, progress) -> Iterable[list[Driven]]:
    """Yield all runs of each combination of laws, kernels that compute the same thing made to stand for each other."""
    from harness.runs.progress import Silent

    shown, labels = progress() if progress else Silent(), [each.name for each in laws]
    groups = [_jobs(each, distinct(each, engines)) for each in laws]

    def waiting(k: int, fraction: float) -> None:
        if labels[k] in driver.making:
            shown.running(k, fraction)

    shown.begin(labels, [float(len(g)) for g in groups])
    try:
        for k, runs in enumerate(driver.each(groups, waiting)):
            shown.done(k, f"{labels[k]}: {_says(runs)}")
            yield [*runs, *_stand_ins(runs, engines)]
    finally:
        shown.end()


def _jobs(laws: Laws, engines: Sequence[Engine]) -> list[Job]:
    places = [arrangement(p, d, laws.grains) for d in laws.dimensions for p in ("pair", "plane")]
    return [Job(laws=laws, engine=e, arrangement=a) for a in places for e in engines]


def _stand_ins(runs: list[Driven], engines: Sequence[Engine]) -> list[Driven]:
    """Return the runs of kernels that another kernel has made for them."""
    made = {r.engine for r in runs}
    kernel = next((r.engine for r in runs if r.engine.startswith(KERNEL_PREFIX)), None)
    return [
        replace(r, job=replace(r.job, engine=e))
        for e in engines if e.name not in made for r in runs if r.engine == kernel
    ]


def _by_engine(runs: Iterable[Driven], engines: Sequence[Engine]) -> dict[str, list[Driven]]:
    return {e.name: [r for r in runs if r.engine == e.name] for e in engines}


def _judge(laws: Laws, runs: list[Driven], engines: Sequence[Engine], rerun: Rerun) -> dict[str, list[Check]]:
    """Return the checks by engine; those of codes against each other at the first of the two."""
    completed = {
        name: {r.part: r for r in of if r.reaction is not None} for name, of in _by_engine(runs, engines).items()
    }
    absent = {r.engine: r.reason for r in reversed(runs) if r.reason}
    stepper, found = Stepper(laws=laws), {}
    for name, of in completed.items():
        kernel = kernel_of(name)
        found[name] = judge_engine(
            laws, name, of, completed.get(kernel, {}), rerun(laws.name, name), absent.get(kernel, ""), stepper
        )
    for left, right in code_pairs(completed):
        again = rerun(laws.name, f"{left},{right}")
        found[left] += direct_checks(laws, completed[left], completed[right], stepper, again)
    return found


def _reaches(runs: Iterable[Driven]) -> list[Reach]:
    """One an engine: of the first of its runs that has one."""
    found: dict[str, Reach] = {}
    for run in runs:
        convention = convention_of(run.engine)
        one = None if convention is None else reach(run, convention)
        if one is not None:
            found.setdefault(run.engine, one)
    return list(found.values())


def _answered(run: Driven) -> Answered:
    where = f" (log in {run.folder})" if run.reason and run.folder else ""
    return Answered(part=run.part, status=run.status, reason=run.reason + where, notes=run.notes)


def _says(runs: list[Driven]) -> str:
    """Count statuses, and say how many runs were there already."""
    counts = {s: [r.kept for r in runs if r.status == s] for s in dict.fromkeys(r.status for r in runs)}
    return ", ".join(
        f"{len(kept)} {status.replace('_', ' ')}" + f" ({sum(kept)} kept from before)" * any(kept)
        for status, kept in counts.items()
    )
