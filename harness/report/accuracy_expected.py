"""How long an accuracy study is expected to take: rough, said before anything is made."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from harness.engines.protocol import Engine, takes
from harness.report.expected import Expected, likely_system, longest_first, packing_seconds, run_seconds
from harness.runs.outcome import usable_cores
from harness.scene.explain import time_row
from harness.scene.load import load_scene
from harness.scene.model import Free, Scene
from harness.scene.system import System
from harness.studies.accuracy.asked import Asked
from harness.studies.accuracy.bulk import bulk_engines, packing_count
from harness.studies.accuracy.bulk_plan import Setting, bare_settings
from harness.studies.accuracy.steps import ladders
from harness.studies.accuracy.study import checked, chosen_engines, phase_count
from harness.studies.accuracy.turn import stepped_system

OWN = ("own", 0.0)
"""The setting that all knobs share."""


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
        expected = expected_free(scene, scene_file, wanted[0], able, phases=phase_count(phases), workers=workers)
        more = "; oracles and timing come on top"
    else:
        expected = expected_bulk(
            scene, scene_file, wanted, bulk_engines(engines, wanted), packings=packing_count(scene, packings),
            workers=workers,
        )
        more = ""
    row = time_row("accuracy", expected.seconds, expected.says + more)
    return f"expected: about {row.text} for {row.note}"


def expected_free(
    scene: Free, file: Path, wanted: Asked, engines: Sequence[Engine], *, phases: int, workers: int | None = None
) -> Expected:
    """Return what all rungs of a free scene take, phases side by side, without oracles and timing sessions."""
    cases = ladders(scene, file, wanted.values, phases).cases
    able = [e for e in engines if e.probe().available]
    costs = [run_seconds(e, p.system) for c in cases for p in c.phased for e in able if takes(e, p.system)]
    at_once = max(1, min(workers or usable_cores(), len(costs)))
    return Expected(seconds=longest_first(costs, at_once), runs=len(costs), packings=0, at_once=at_once)


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
