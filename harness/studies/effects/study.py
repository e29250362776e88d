"""Which effects a scene calls for, and what they are worth: one scene, every effect switched alone.

    scene -> variants -> traces (what off leaves behind)
                      -> short runs (off is the coefficient at zero)
                      -> sessions (what a step costs)
                      -> whole runs on several packings (what changes)  -> smallest set, run again
"""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING

from harness.errors import InputError
from harness.runs.folder import runs_root
from harness.runs.outcome import Host, Outcome, host_facts, reason_of
from harness.runs.pool import run_many
from harness.scene.effects import Effect, effects
from harness.scene.grains import grains_of
from harness.scene.load import load_scene
from harness.scene.model import Scene
from harness.scene.system import System
from harness.studies.accuracy.shown import Grouped
from harness.studies.effects.asked import Asked, asked
from harness.studies.effects.changes import Change, changes_of
from harness.studies.effects.cost import StepCost
from harness.studies.effects.footprint import Footprint, footprint, refusal, trace
from harness.studies.effects.pairs import OnOff, on_and_off
from harness.studies.effects.probes import Probed, ZeroCheck, probe
from harness.studies.effects.quantities import VariantRun, measured
from harness.studies.effects.smallest import Smallest, smallest_set
from harness.studies.effects.timing import time_engines
from harness.studies.effects.variants import BASE, Variant, systems_of, variants_of, without
from harness.studies.prepare import Prepared, prepare

if TYPE_CHECKING:
    from harness.engines.protocol import Engine
    from harness.runs.progress import Progress

TIME_LIMIT = 3600.0
REDUCED = "reduced scene"


@dataclass(frozen=True, kw_only=True)
class EffectsStudy:
    """Everything a report needs.

    costs: by engine and variant, the reduced scene among them if there is one. steps: of a whole run, by variant.
    refused: why an engine does not compute a variant, by engine and variant. reduced: the scene of the smallest set.
    own_seconds: CPU time of this process; wall_seconds: of the study this time.
    """

    scene: Scene
    scene_file: Path
    asked: Asked
    effects: tuple[Effect, ...]
    variants: tuple[Variant, ...]
    footprints: tuple[Footprint, ...]
    zeros: tuple[ZeroCheck, ...]
    costs: Mapping[tuple[str, str], StepCost]
    steps: Mapping[str, int]
    refused: Mapping[tuple[str, str], str]
    outcomes: Mapping[str, tuple[Outcome, ...]]
    changes: tuple[Change, ...]
    smallest: Smallest
    reduced: Scene
    host: Host
    wall_seconds: float
    own_seconds: float

    @property
    def chosen(self) -> list[Change]:
        """The changes of the quantities that were asked for."""
        return [c for c in self.changes if c.quantity in self.asked.quantities]

    @property
    def exit_status(self) -> int:
        """1 when something of an effect that is off was found, off was not zero, or a run broke.

        A switched scene may be unstable: that is an answer. The scene as declared may not.
        """
        checks = [*(f.verdict for f in self.footprints), *(z.verdict for z in self.zeros)]
        ran = all(o.status == "completed" for o in self.outcomes.get(BASE, ()))
        broken = any(o.status in ("crashed", "timed_out") for of in self.outcomes.values() for o in of)
        return 0 if ran and not broken and self.chosen and "differs" not in checks else 1

    def whole_ratio(self, engine: str, variant: str) -> float | None:
        """Return the time of a whole run over that of the scene as declared: cost of a step times number of steps."""
        cost = self.costs.get((engine, variant))
        if cost is None or cost.ratio is None:
            return None
        return cost.ratio * self.steps[variant] / self.steps[BASE]

    def faster(self, engine: str, variant: str) -> bool:
        """Whether every stretch of a variant says that a whole run takes less time than as declared."""
        cost = self.costs.get((engine, variant))
        return cost is not None and cost.shorter(self.steps[variant] / self.steps[BASE])


@dataclass(frozen=True, kw_only=True)
class _Frame:
    """What all parts of the study share."""

    scene: Scene
    file: Path
    out: Path
    asked: Asked
    starts: Sequence[Prepared]
    time_limit: float
    workers: int | None
    progress: Callable[[], Progress] | None

    def show(self) -> Progress | None:
        """A new display, if there is one."""
        return self.progress() if self.progress else None


def effects_study(
    scene_file: Path, out: Path, *, quantities: Sequence[str] | None = None, tolerance: float | None = None,
    only: Sequence[str] | None = None, engines: Sequence[str] | None = None, by: str | None = None,
    packings: int | None = None, time_limit: float = TIME_LIMIT, workers: int | None = None,
    progress: Callable[[], Progress] | None = None,
) -> EffectsStudy:
    """Switch every effect; runs and times are kept below `out` and reused.

    Raises InputError for a wrong scene or request before anything is written.
    """
    begun, own = time.monotonic(), time.process_time()
    scene = load_scene(scene_file)
    wanted = asked(scene, scene_file, quantities=quantities, tolerance=tolerance, only=only, engines=engines, by=by,
                   packings=packings)
    starts = prepare(scene, scene_file, packings=wanted.packings, cache=out / "packings", progress=progress)
    frame = _Frame(scene=scene, file=scene_file, out=out, asked=wanted, starts=starts, time_limit=time_limit,
                   workers=workers, progress=progress)
    _require_by(frame)
    variants = variants_of(scene, scene_file, starts, wanted.only)
    pairs = on_and_off(scene, scene_file, starts[0], variants)
    probed = probe(pairs, wanted.engines, out, time_limit=time_limit, workers=workers, progress=frame.show())
    systems = _systems(frame, variants)
    costs = time_engines(
        wanted.engines, {n: s[0] for n, s in systems.items()}, out / "times", progress=frame.show()
    )
    answered = _answers(frame, systems)
    changes = changes_of(measured(scene, answered.runs), list(systems)[1:], wanted.tolerance, answered.failed)
    smallest, reduced = _smallest(frame, variants, changes, costs, systems, answered)
    steps = {n: s[0].steps for n, s in systems.items()}
    if smallest.left_out:
        costs, steps = _with_reduced(frame, reduced, costs, steps, systems)
    return EffectsStudy(
        scene=scene, scene_file=scene_file, asked=wanted, effects=effects(scene, starts[0].system),
        variants=tuple(variants), footprints=tuple(_footprints(pairs, wanted.engines, probed)), zeros=probed.checks,
        costs=costs, steps=steps, refused=_refused(wanted.engines, systems), outcomes=answered.outcomes,
        changes=tuple(changes), smallest=smallest, reduced=reduced, host=host_facts(),
        wall_seconds=time.monotonic() - begun, own_seconds=time.process_time() - own,
    )


def _require_by(frame: _Frame) -> None:
    """Raise InputError where the engine whose answers are wanted does not take the scene."""
    by, system = frame.asked.by, frame.starts[0].system
    probe_, missing = by.probe(), refusal(by, system)
    if missing or not probe_.available:
        raise InputError(
            file="--by", expected="an engine that computes the scene", got=by.name, fix=missing or probe_.detail
        )


def _systems(frame: _Frame, variants: Sequence[Variant]) -> dict[str, list[System]]:
    """Return the systems of the scene and of every variant, one a packing."""
    made = {BASE: [start.system for start in frame.starts]}
    return made | {v.name: systems_of(v.scene, frame.file, frame.starts) for v in variants if v.scene is not None}


# --- traces ------------------------------------------------------------------------------------------


def _footprints(pairs: Sequence[OnOff], engines: Sequence[Engine], probed: Probed) -> list[Footprint]:
    return [_footprint(pair, engine, probed) for pair in pairs for engine in engines]


def _footprint(pair: OnOff, engine: Engine, probed: Probed) -> Footprint:
    missing = refusal(engine, pair.on) or refusal(engine, pair.off)
    if missing:
        return Footprint(effect=pair.effect, engine=engine.name, verdict="not_checked", why=missing)
    on, off = (
        trace(engine, system, probed.columns.get((pair.effect, engine.name, which)))
        for which, system in (("on", pair.on), ("off", pair.off))
    )
    return footprint(pair.effect, engine, on, off, replaced=pair.replaced)


def _refused(engines: Sequence[Engine], systems: Mapping[str, Sequence[System]]) -> dict[tuple[str, str], str]:
    found = {(e.name, name): refusal(e, of[0]) for name, of in systems.items() for e in engines}
    return {key: why for key, why in found.items() if why}


# --- whole runs --------------------------------------------------------------------------------------


@dataclass(frozen=True, kw_only=True)
class _Answered:
    """Completed runs, and what became of all of them by variant."""

    runs: tuple[VariantRun, ...]
    outcomes: Mapping[str, tuple[Outcome, ...]]

    @property
    def failed(self) -> dict[str, str]:
        """What became of the first run that did not complete, by variant."""
        bad = {name: next((o for o in of if o.status != "completed"), None) for name, of in self.outcomes.items()}
        return {name: reason_of(o) for name, o in bad.items() if o is not None}


def _answers(frame: _Frame, systems: Mapping[str, Sequence[System]]) -> _Answered:
    """Run every system on the engine that answers; a system that several variants share is run once."""
    by = frame.asked.by
    plan = [(name, k, system) for name, of in systems.items() for k, system in enumerate(of)]
    jobs = {}
    for name, _, system in plan:
        jobs.setdefault(system.digest(), (name, by, system))
    shown = Grouped([name for name, *_ in jobs.values()], frame.show()) if frame.progress else None
    done = dict(zip(jobs, run_many(
        list(jobs.values()), runs_root(frame.out), time_limit=frame.time_limit, workers=frame.workers,
        progress=shown, native="drop",
    ), strict=True))
    outcomes: dict[str, list[Outcome]] = {}
    runs = []
    for name, k, system in plan:
        one = done[system.digest()]
        outcomes.setdefault(name, []).append(one.outcome)
        if one.outcome.status == "completed":
            runs.append(VariantRun(variant=name, packing=k, system=system, trajectory=one.folder / "trajectory.h5"))
    return _Answered(runs=tuple(runs), outcomes={name: tuple(of) for name, of in outcomes.items()})


# --- the smallest set --------------------------------------------------------------------------------


def _smallest(
    frame: _Frame, variants: Sequence[Variant], changes: Sequence[Change], costs: Mapping,
    systems: Mapping[str, Sequence[System]], answered: _Answered,
) -> tuple[Smallest, Scene]:
    grains = grains_of(frame.scene, frame.starts[0].system.particles)
    base = [r for r in answered.runs if r.variant == BASE]

    def run(names: tuple[str, ...]) -> list[Change]:
        reduced = without(frame.scene, names, grains)
        tried = _answers(frame, {REDUCED: systems_of(reduced, frame.file, frame.starts)})
        found = changes_of(measured(frame.scene, [*base, *tried.runs]), [REDUCED], frame.asked.tolerance, tried.failed)
        return [replace(c, variant=f"without {', '.join(names)}") for c in found]

    saves = {v.effect.name: _saves(v, frame.asked, costs, systems) for v in variants if v.scene is not None}
    smallest = smallest_set(variants, changes, frame.asked.quantities, saves, run)
    return smallest, without(frame.scene, smallest.left_out, grains)


def _saves(variant: Variant, wanted: Asked, costs: Mapping, systems: Mapping[str, Sequence[System]]) -> float | None:
    """Return the part of a run's time that leaving an effect out saves, meaned over engines.

    0 where all engines' stretches scatter about no difference; None if no engine was timed.
    """
    steps = systems[variant.name][0].steps / systems[BASE][0].steps
    timed = [c for e in wanted.engines if (c := costs.get((e.name, variant.name))) is not None and c.ratio is not None]
    if not timed:
        return None
    return sum(1.0 - c.ratio * steps if c.differs(steps) else 0.0 for c in timed) / len(timed)


def _with_reduced(
    frame: _Frame, reduced: Scene, costs: Mapping, steps: Mapping[str, int], systems: Mapping[str, Sequence[System]]
) -> tuple[dict, dict]:
    """Time the reduced scene beside the scene as declared."""
    system = systems_of(reduced, frame.file, frame.starts[:1])[0]
    both = {BASE: systems[BASE][0], REDUCED: system}
    timed = time_engines(frame.asked.engines, both, frame.out / "times", progress=frame.show())
    more = {key: cost for key, cost in timed.items() if key[1] == REDUCED}
    return {**costs, **more}, {**steps, REDUCED: system.steps}
