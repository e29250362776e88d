"""What a scene file means, as tables for the terminal."""

from __future__ import annotations

from itertools import chain
from pathlib import Path

from harness.engines.registry import ENGINES, USUAL, choose_engines
from harness.report.expected import expected_comparison, likely_system, refusals, run_seconds
from harness.report.tables import Answer
from harness.scene.derived import derive
from harness.scene.energy import energy_warnings
from harness.scene.explain import Row, Section, as_json, explain, time_row
from harness.scene.frontier import step_warnings
from harness.scene.load import load_scene
from harness.scene.model import Scene
from harness.scene.resolve import known_system
from harness.scene.system import System


def scene_answer(path: Path) -> Answer:
    """Return what a scene file means, by section; nothing is run and nothing is written. Raises InputError."""
    scene = load_scene(path)
    system = likely_system(scene, path)
    known = known_system(scene, path)
    sections = [*explain(scene, known, expected_seconds(system)), *_warnings(scene, known), *_outlook(scene, system)]
    tables = {
        title.capitalize(): [{"name": r.name, "value": r.text, "note": r.note} for r in rows]
        for title, rows in sections
    }
    return Answer(tables=tables, data=as_json(sections))


def expected_seconds(system: System) -> dict[str, float]:
    """Return the seconds a run is expected to take, by engine that can run it; rough, see each engine."""
    return {name: run_seconds(engine, system) for name, engine in ENGINES.items() if not refusals(engine, system)}


def _warnings(scene: Scene, system: System | None) -> list[Section]:
    """Return what is known of such time steps and laws; nothing is run for it."""
    warnings = chain(step_warnings(scene, derive(scene, system)), energy_warnings(scene))
    rows = [Row(name=what, value="warning", note=why) for what, why in warnings]
    return [("warnings", rows)] if rows else []


def _outlook(scene: Scene, system: System) -> list[Section]:
    """Return which engines will not run the scene, and why; and how long the others take to be compared."""
    from harness.studies.prepare import start_count

    refused = [
        Row(name=name, value="will not run it", note=reason)
        for name, engine in ENGINES.items() for reason in refusals(engine, system)
    ]
    expected = expected_comparison(scene, system, choose_engines(list(USUAL)), starts=start_count(scene, None))
    whole = time_row("grainproof compare", expected.seconds, expected.says)
    sections = [("engines that refuse it", refused), ("expected time of a comparison", [whole])]
    return [(title, rows) for title, rows in sections if rows]
