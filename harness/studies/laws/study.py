"""Prove contact laws: prescribed motion, then collisions; a matrix of laws and engines, and every check.

laws x engines -> runs -> reactions -> checks -> cells, one combination of laws at a time; then the same for collisions.
"""

from __future__ import annotations

import shlex
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING

from harness.engines.registry import ENGINES, KERNEL_PREFIX
from harness.errors import InputError
from harness.runs.outcome import usable_cores
from harness.studies.laws.arrangement import arrangement
from harness.studies.laws.cases import CASES, Laws
from harness.studies.laws.collide import collide, distinct
from harness.studies.laws.collisions import Exit
from harness.studies.laws.curves import Curve, curves
from harness.studies.laws.drive import Driven, Driver, Job
from harness.studies.laws.judge import judge_engine
from harness.studies.laws.matrix import Answered, Cell, make_cell
from harness.studies.verdict import Check, failed

if TYPE_CHECKING:
    from harness.engines.protocol import Engine
    from harness.runs.progress import Progress

TIME_LIMIT = 120.0
"""Seconds after which an engine's run is ended, unless the user says otherwise; it takes one or two."""


@dataclass(frozen=True, kw_only=True)
class LawsResult:
    """Everything a report needs. prescribed, collisions: the two matrices, cells in order of laws and engines.

    exits: what single impacts have closed forms for. versions: by engine.
    """

    laws: tuple[Laws, ...]
    engines: tuple[str, ...]
    prescribed: tuple[Cell, ...]
    collisions: tuple[Cell, ...]
    exits: tuple[Exit, ...]
    checks: tuple[Check, ...]
    curves: tuple[Curve, ...]
    versions: dict[str, str]
    rerun: Rerun

    @property
    def exit_status(self) -> int:
        """1 when a check differs, a run failed or nothing was compared; else 0."""
        broken = any(c.shown == "failed" for c in (*self.prescribed, *self.collisions))
        return 1 if broken or failed(self.checks) else 0


@dataclass(frozen=True, kw_only=True)
class Rerun:
    """The command that repeats the study for some laws and engines.

    >>> Rerun(out=Path("out"))("linear", "lammps")
    'grainproof laws --law linear --engine lammps --out out'
    """

    out: Path

    def __call__(self, laws: str, engine: str) -> str:
        """Return the command, quoted for a shell."""
        return shlex.join(["grainproof", "laws", "--law", laws, "--engine", engine, "--out", str(self.out)])


def choose_laws(words: Sequence[str]) -> tuple[Laws, ...]:
    """Return the combinations a user named, all if none; raises InputError for an unknown one."""
    for word in words:
        if word not in CASES:
            raise InputError(file="--law", expected=f"one of {', '.join(CASES)}", got=word or "nothing")
    return tuple(CASES[w] for w in dict.fromkeys(words or CASES))


def with_kernels(engines: Sequence[Engine]) -> tuple[Engine, ...]:
    """Return the engines with, behind them, the kernel in the conventions of each code among them."""
    own = [ENGINES[KERNEL_PREFIX + e.name] for e in engines if KERNEL_PREFIX + e.name in ENGINES]
    return tuple({e.name: e for e in (*engines, *own)}.values())


def prove_laws(
    laws: Sequence[Laws], engines: Sequence[Engine], out: Path, *, time_limit: float = TIME_LIMIT,
    workers: int | None = None, progress: Callable[[], Progress] | None = None,
) -> LawsResult:
    """Drive and collide all combinations on all engines; runs are made below ``out/prescribed`` and ``out/runs``."""
    engines = with_kernels(engines)
    driver = Driver(root=out / "prescribed", time_limit=time_limit, workers=workers or usable_cores())
    rerun = Rerun(out=out)
    drawn: list[Curve] = []
    cells, checks = [], []
    for each, runs in zip(laws, _driven(laws, engines, driver, progress), strict=True):
        drawn += curves(runs)
        for name, of in _by_engine(runs, engines).items():
            found = _judge(each, name, runs, rerun)
            checks += found
            cells.append(make_cell(each.name, name, [_answered(r) for r in of], found))
    hit = collide(
        laws, engines, out, rerun=rerun, time_limit=time_limit, workers=workers, progress=progress and progress()
    )
    return LawsResult(
        laws=tuple(laws), engines=tuple(e.name for e in engines), prescribed=tuple(cells), collisions=hit.cells,
        exits=hit.exits, checks=(*checks, *hit.checks), curves=tuple(drawn),
        versions={e.name: e.probe().version for e in engines}, rerun=rerun,
    )


# --- prescribed motion -----------------------------------------------------------------------------


def _driven(laws: Sequence[Laws], engines: Sequence[Engine], driver: Driver, progress) -> Iterable[list[Driven]]:
    """Yield all runs of each combination of laws, kernels that compute the same thing made to stand for each other."""
    from harness.runs.progress import Silent

    shown, labels = progress() if progress else Silent(), [each.name for each in laws]
    groups = [_jobs(each, distinct(each, engines)) for each in laws]
    shown.begin(labels, [float(len(g)) for g in groups])
    try:
        shown.running(0, 0.0)
        for k, runs in enumerate(driver.each(groups)):
            shown.done(k, f"{labels[k]}: {_says(runs)}")
            if k + 1 < len(labels):
                shown.running(k + 1, 0.0)
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


def _judge(laws: Laws, engine: str, runs: list[Driven], rerun: Rerun) -> list[Check]:
    def completed(name: str) -> dict[str, Driven]:
        return {r.part: r for r in runs if r.engine == name and r.reaction is not None}

    kernel = KERNEL_PREFIX + engine
    absent = next((r.reason for r in runs if r.engine == kernel and r.reason), "")
    command = rerun(laws.name, engine)
    return judge_engine(laws, engine, completed(engine), completed(kernel), command, no_kernel=absent)


def _answered(run: Driven) -> Answered:
    where = f" (log in {run.folder})" if run.reason and run.folder else ""
    return Answered(part=run.part, status=run.status, reason=run.reason + where, notes=run.notes)


def _says(runs: list[Driven]) -> str:
    counts = {s: sum(r.status == s for r in runs) for s in dict.fromkeys(r.status for r in runs)}
    return ", ".join(f"{n} {status.replace('_', ' ')}" for status, n in counts.items())
