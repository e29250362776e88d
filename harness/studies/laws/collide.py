"""Run and judge the collisions of all combinations of laws on all engines."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from harness.engines.registry import KERNEL_PREFIX, kernel_of
from harness.runs.folder import runs_root
from harness.runs.pool import run_many
from harness.runs.progress import Silent
from harness.studies.laws.collisions import Exit, collision_system, exit_check, exits, whole_checks, without_kernel
from harness.studies.laws.direct import code_pairs, direct_collisions
from harness.studies.laws.flights import flown
from harness.studies.laws.judge import STEPPED
from harness.studies.laws.matrix import Answered, Cell, make_cell
from harness.studies.verdict import Check

if TYPE_CHECKING:
    from harness.engines.protocol import Engine
    from harness.runs.pool import Done
    from harness.runs.progress import Progress
    from harness.studies.laws.cases import Laws
    from postproc.trajectory import Trajectory


@dataclass(frozen=True, kw_only=True)
class Collided:
    """Cells in order of laws and engines, exit values with a closed form, and all checks."""

    cells: tuple[Cell, ...]
    exits: tuple[Exit, ...]
    checks: tuple[Check, ...]


def distinct(laws: Laws, engines: Sequence[Engine]) -> list[Engine]:
    """Return the engines that compute something of their own.

    Without tangential laws all conventions of the kernel are one: the first kernel stands for all.
    """
    kernels = [e for e in engines if e.name.startswith(KERNEL_PREFIX)]
    same = kernels[1:] if _is_normal_only(laws) else []
    return [e for e in engines if e not in same]


def collide(
    laws: Sequence[Laws], engines: Sequence[Engine], out: Path, *, rerun: Callable[[str, str], str],
    time_limit: float, workers: int | None, progress: Progress | None,
) -> Collided:
    """Run all collisions below ``out/runs``, where finished ones are reused, and judge them."""
    plan = [(each, e) for each in laws for e in distinct(each, engines)]
    jobs = [(f"{each.name}, {e.name}", e, collision_system(each)) for each, e in plan]
    done = run_many(
        jobs, runs_root(out), time_limit=time_limit, workers=workers, native="drop",
        progress=_Folded("collisions", progress or Silent()),
    )
    made = {(each.name, e.name): d for (each, e), d in zip(plan, done, strict=True)}
    results = [_judge(each, e.name, made, rerun(each.name, e.name)) for each in laws for e in engines]
    direct = [c for each in laws for c in _codes_directly(each, engines, made, rerun)]
    return Collided(
        cells=tuple(cell for cell, _, _ in results), exits=tuple(x for _, found, _ in results for x in found),
        checks=(*(c for _, _, checks in results for c in checks), *direct),
    )


Made = Mapping[tuple[str, str], "Done"]
"""Runs by laws and engine."""


def _judge(laws: Laws, engine: str, made: Made, rerun: str) -> tuple[Cell, list[Exit], list[Check]]:
    one = _of(made, laws, engine)
    run, found = _trajectory(one), []
    checks: list[Check] = []
    if run is not None:
        found = exits(laws, engine, run)
        checks = _against_kernel(laws, engine, run, _of(made, laws, kernel_of(engine)), rerun)
        checks += [exit_check(x, rerun) for x in found]
    o = one.outcome
    reason = f"{o.reason}; reproduce: {o.reproduce}" if o.reproduce and o.reason else o.reason
    answered = Answered(part="collisions", status=o.status, reason=reason)
    return make_cell(laws.name, engine, [answered], checks), found, checks


def _against_kernel(laws: Laws, engine: str, run: Trajectory, kernel: Done | None, rerun: str) -> list[Check]:
    """Nothing for the kernel itself; where it lacks a law that is simple enough, bodies are flown without it."""
    if engine.startswith(KERNEL_PREFIX):
        return []
    reference = None if kernel is None else _trajectory(kernel)
    if reference is not None:
        return whole_checks(laws, engine, run, reference, rerun, right=kernel_of(engine))
    alone = flown(laws, collision_system(laws))
    if alone is not None:
        return whole_checks(laws, engine, run, alone, rerun, right=STEPPED)
    why = "the kernel has no such conventions" if kernel is None else kernel.outcome.reason
    return [without_kernel(laws, engine, why)]


def _codes_directly(laws: Laws, engines: Sequence[Engine], made: Made, rerun: Callable[[str, str], str]) -> list[Check]:
    """Return the checks of codes against each other."""
    of = {e.name: _of(made, laws, e.name) for e in engines}
    runs = {name: run for name, done in of.items() if done and (run := _trajectory(done)) is not None}
    return [
        c for pair in code_pairs(e.name for e in engines)
        for c in direct_collisions(laws, runs, pair, rerun(laws.name, ",".join(pair)))
    ]


def _of(made: Made, laws: Laws, engine: str) -> Done | None:
    """Return an engine's run, or that of the kernel which stands for it; None if there is neither."""
    if engine.startswith(KERNEL_PREFIX) and _is_normal_only(laws):
        return next((d for (of, by), d in made.items() if of == laws.name and by.startswith(KERNEL_PREFIX)), None)
    return made.get((laws.name, engine))


def _trajectory(done: Done) -> Trajectory | None:
    from postproc.trajectory import read_trajectory

    return read_trajectory(done.folder / "trajectory.h5") if done.outcome.status == "completed" else None


def _is_normal_only(laws: Laws) -> bool:
    return laws.sliding is laws.rolling is laws.torsion is None


class _Folded:
    """Shows many short runs as one job: their number is what is to be done."""

    def __init__(self, label: str, shown: Progress):
        self._label, self._shown = label, shown
        self._ended = self._count = 0

    def begin(self, labels: list[str], costs: list[float]) -> None:
        self._count = len(labels)
        self._shown.begin([self._label], [sum(costs)])

    def running(self, job: int, fraction: float) -> None:  # noqa: ARG002 (one run is too short to be followed)
        self._shown.running(0, self._ended / self._count)

    def done(self, job: int, line: str) -> None:  # noqa: ARG002
        self._ended += 1
        if self._ended == self._count:
            self._shown.done(0, f"{self._label}: {self._count} runs ended, or were there already")

    def end(self) -> None:
        self._shown.end()
