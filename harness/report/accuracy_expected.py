"""How long an accuracy study is expected to take: rough, said before anything is made."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from harness.engines.protocol import Engine, takes
from harness.engines.registry import find_engine
from harness.report.expected import (
    REPORT_SECONDS,
    Expected,
    likely_system,
    longest_first,
    packing_seconds,
    run_seconds,
)
from harness.runs.outcome import usable_cores
from harness.scene.explain import time_row
from harness.scene.load import load_scene
from harness.scene.model import Free, Scene
from harness.scene.system import System
from harness.studies.accuracy.asked import Asked
from harness.studies.accuracy.bulk import bulk_engines, packing_count
from harness.studies.accuracy.bulk_plan import Setting, bare_settings
from harness.studies.accuracy.cost import REPEATS
from harness.studies.accuracy.oracle import FINER, ROUND_OFF_STEP, solved_by_events
from harness.studies.accuracy.steps import Ladder, Ladders, ladders, oracle_plan, timed_rung
from harness.studies.accuracy.study import checked, chosen_engines, phase_count
from harness.studies.accuracy.turn import stepped_system

OWN = ("own", 0.0)
"""The setting that all knobs share."""

EVENTS_SECONDS = 0.1
"""An oracle that is solved by events (measured: 0.04 to 0.4 s)."""
TEXTBOOK_SECONDS = 3e-4
"""A step of the textbook evaluation, in double or extended precision (measured: 220 to 380 us for 2 to 10 bodies)."""


def announcement(
    scene_file: Path, *, knob: str | None, ladder: Sequence[float] | None, quantity: str | None,
    engines: Sequence[str] | None, packings: int | None, phases: int | None, workers: int | None,
) -> str:
    """Return a line on how long a study takes. Raises InputError."""
    scene = load_scene(scene_file)
    wanted = checked(
        scene, scene_file, knob=knob, ladder=ladder, quantity=quantity, phases=phases, packings=packings
    )
    if isinstance(scene, Free):
        able = chosen_engines(engines, wanted[0])
        cases = ladders(scene, scene_file, wanted[0].values, phase_count(phases))
        expected = expected_climb(cases, able, workers=workers)
    else:
        expected = expected_bulk(
            scene, scene_file, wanted, bulk_engines(engines, wanted), packings=packing_count(scene, packings),
            workers=workers,
        )
    row = time_row("accuracy", expected.seconds, expected.says)
    return f"expected: about {row.text} for {row.note}"


def expected_climb(cases: Ladders, engines: Sequence[Engine], *, workers: int | None = None) -> Expected:
    """Return what oracles, all rungs with their phases side by side, and timing sessions take."""
    able = [e for e in engines if e.probe().available]
    costs = [run_seconds(e, p.system) for c in cases.cases for p in c.phased for e in able if takes(e, p.system)]
    oracles = [oracle_seconds(cases, c) for c, _ in oracle_plan(cases, able)]
    most = workers or usable_cores()
    at_once = max(1, min(most, len(costs)))
    seconds = longest_first(costs, at_once) + longest_first(oracles, max(1, min(most, len(oracles))))
    return Expected(
        seconds=seconds + sum(_session_seconds(e, c) for c in cases.cases for e in able) + REPORT_SECONDS,
        runs=len(costs), packings=0, at_once=at_once,
        beside=f"besides {len(oracles)} oracle{'s' * (len(oracles) != 1)} and timing",
    )


def oracle_seconds(cases: Ladders, of: Ladder) -> float:
    """Return what an oracle of a case takes: solved by events, or steps of the second-order kernel (`oracle`)."""
    if solved_by_events(of.plain):
        return EVENTS_SECONDS
    duration, step = of.plain.dt * of.plain.steps, cases.finest_step(of)
    fine = (1.5 * FINER + 1.0) * duration / step
    precise = 2.0 * duration / (ROUND_OFF_STEP * cases.contact_time)
    return 1e-6 * find_engine("kernel:corrected").microseconds_per_step(of.plain) * fine + TEXTBOOK_SECONDS * precise


def _session_seconds(engine: Engine, of: Ladder) -> float:
    """Return what timing an engine takes, that builds its system and makes all steps of one rung, REPEATS times."""
    system = of.phased[timed_rung(of)].system
    return REPEATS * run_seconds(engine, system) if takes(engine, system) else 0.0


def expected_bulk(
    scene: Scene, file: Path, wanted: Sequence[Asked], engines: Sequence[Engine], *, packings: int,
    workers: int | None = None,
) -> Expected:
    """Return what all settings of all knobs take on the engines that are there, as `run_many` shares runs out."""
    settings = {_name(s): s for s in bare_settings(scene, wanted) if s.width is None}
    systems = {name: _likely(s, file) for name, s in settings.items()}
    own = likely_system(scene, file)
    able = [e for e in engines if e.probe().available and takes(e, own)]
    costs = [run_seconds(e, s) for s in systems.values() for e in able] * packings
    at_once = max(1, min(workers or usable_cores(), len(costs)))
    packed = sum(packing_seconds(s.scene, systems[n]) for n, s in settings.items() if s.knob not in ("dt", "scheme"))
    return Expected(
        seconds=packed * packings / at_once + longest_first(costs, at_once), runs=len(costs),
        packings=packings, at_once=at_once,
    )


def _name(setting: Setting) -> tuple[str, float]:
    return OWN if setting.own else (setting.knob, setting.value)


def _likely(setting: Setting, file: Path) -> System:
    system = likely_system(setting.scene, file)
    if setting.knob in ("dt", "scheme") and not setting.own:
        return stepped_system(setting.scene, system, setting.value)
    return system
