"""How long switching every effect is expected to take: rough, said before anything is made."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path

from harness.engines.protocol import Engine, takes
from harness.engines.whole import whole
from harness.packing.stand_in import stand_in
from harness.report.expected import (
    REPORT_SECONDS,
    Expected,
    judging_seconds,
    likely_system,
    longest_first,
    packing_seconds,
    run_seconds,
)
from harness.runs.outcome import usable_cores
from harness.scene.explain import time_row
from harness.scene.load import load_scene
from harness.scene.model import Scene
from harness.scene.resolve import needs_packing
from harness.scene.system import System
from harness.studies.effects.asked import asked
from harness.studies.effects.copies import copies
from harness.studies.effects.cost import LEAST, ROUNDS, finer_steps, stretch_steps
from harness.studies.effects.pairs import on_and_off
from harness.studies.effects.probes import short
from harness.studies.effects.variants import BASE, systems_of, variants_of
from harness.studies.prepare import Prepared


def announcement(
    scene_file: Path, *, quantities: Sequence[str] | None, tolerance: float | None, only: Sequence[str] | None,
    engines: Sequence[str] | None, by: str | None, packings: int | None, workers: int | None,
) -> str:
    """Return a line on how long a study takes. Raises InputError."""
    scene = load_scene(scene_file)
    wanted = asked(scene, scene_file, quantities=quantities, tolerance=tolerance, only=only, engines=engines, by=by,
                   packings=packings)
    expected = expected_effects(
        scene, scene_file, wanted.only, wanted.engines, wanted.by, packings=wanted.packings, workers=workers
    )
    row = time_row("effects", expected.seconds, f"{expected.says}; runs of a smaller set, if there is one, come on top")
    return f"expected: about {row.text} for {row.note}"


def expected_effects(
    scene: Scene, file: Path, only: Sequence[str], engines: Sequence[Engine], by: Engine, *, packings: int,
    workers: int | None = None,
) -> Expected:
    """Return what packings, short runs, whole runs and timed stretches of all variants take.

    Which effects may go together is found on the way, so trials are not counted. Raises InputError.
    """
    start = _likely_start(scene, file)
    variants = variants_of(scene, file, [start], only)
    systems = {BASE: start.system} | {v.name: systems_of(v.scene, file, [start])[0] for v in variants if v.scene}
    able = [e for e in engines if e.probe().available]
    probes = _short_seconds(scene, file, start, variants, able)
    answers = {s.digest(): run_seconds(by, s) for s in systems.values() if takes(by, s)}
    costs = [*probes, *(list(answers.values()) * packings)]
    at_once = max(1, min(workers or usable_cores(), len(costs)))
    return Expected(
        seconds=packings * packing_seconds(scene, start.system) + longest_first(costs, at_once)
        + sum(timing_seconds(e, systems) for e in able) + judging_seconds(start.system, len(answers) * packings)
        + REPORT_SECONDS,
        runs=len(costs), packings=packings * needs_packing(scene), at_once=at_once, beside="besides timing",
    )


def timing_seconds(engine: Engine, systems: Mapping[str, System]) -> float:
    """Return what the sessions of an engine take, that are built and run in turn. systems: BASE and its variants."""
    if whole(engine.name) is None or not takes(engine, systems[BASE]):
        return 0.0
    finer = finer_steps(systems[BASE])
    many = {
        name: copies(s.with_(dt=s.dt / finer, steps=s.steps * finer)) for name, s in systems.items() if takes(engine, s)
    }
    step = {name: 1e-6 * engine.microseconds_per_step(s) for name, s in many.items()}
    steps = stretch_steps(many, lambda: list(step.values()))
    return sum(engine.startup_seconds + (LEAST + ROUNDS * steps[name]) * step[name] for name in many)


def _likely_start(scene: Scene, file: Path) -> Prepared:
    packing = stand_in(scene) if needs_packing(scene) else None
    return Prepared(number=0, system=likely_system(scene, file), packing=packing)


def _short_seconds(
    scene: Scene, file: Path, start: Prepared, variants: Sequence, engines: Sequence[Engine]
) -> list[float]:
    """Return the seconds of each short run, every system once an engine."""
    found = [
        short(s) for p in on_and_off(scene, file, start, variants) for s in (p.on, p.off, p.zero) if s is not None
    ]
    each = {s.digest(): s for s in found}
    return [run_seconds(e, s) for s in each.values() for e in engines if takes(e, s)]
