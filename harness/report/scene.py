"""What a scene file means, as tables for the terminal."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from harness.engines.protocol import takes
from harness.engines.registry import ENGINES
from harness.packing.insertion import insert_loose
from harness.packing.make import Packing
from harness.report.tables import Answer
from harness.scene.explain import as_json, explain
from harness.scene.load import load_scene
from harness.scene.model import Scene
from harness.scene.resolve import known_system, resolve
from harness.scene.system import System


def scene_answer(path: Path) -> Answer:
    """Return what a scene file means, by section; nothing is run and nothing is written. Raises InputError."""
    scene = load_scene(path)
    system = known_system(scene, path)
    sections = explain(scene, system, expected_seconds(scene, path, system))
    tables = {
        title.capitalize(): [{"name": r.name, "value": r.text, "note": r.note} for r in rows]
        for title, rows in sections
    }
    return Answer(tables=tables, data=as_json(sections))


def expected_seconds(scene: Scene, path: Path, system: System | None) -> dict[str, float]:
    """Return the seconds a run is expected to take, by engine that can run it; rough, see each engine."""
    system = system or resolve(scene, path, _stand_in(scene))
    able = {n: e for n, e in ENGINES.items() if takes(e, system)}
    return {n: e.startup_seconds + 1e-6 * e.microseconds_per_step(system) * system.steps for n, e in able.items()}


def _stand_in(scene: Scene) -> Packing:
    """A loose, unrelaxed packing: costs nothing, and has as many discs as the real one."""
    rng = np.random.default_rng(0)
    radius = rng.uniform(scene.particles.radius.min, scene.particles.radius.max, scene.particles.count)
    x, side = insert_loose(radius, rng)
    return Packing(x=x.T, radius=radius, box=(side, side), residual=float("nan"), contacts=0, path=Path())
