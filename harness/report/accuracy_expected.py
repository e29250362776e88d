"""How long a bulk accuracy study is expected to take: rough, said before anything is made."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from harness.engines.protocol import Engine, takes
from harness.report.expected import Expected, likely_system, longest_first, packing_seconds, run_seconds
from harness.runs.outcome import usable_cores
from harness.scene.model import Scene
from harness.studies.accuracy.asked import Asked
from harness.studies.accuracy.bulk_plan import bare_settings
from harness.studies.accuracy.turn import stepped_system


def expected_bulk(
    scene: Scene, file: Path, wanted: Sequence[Asked], engines: Sequence[Engine], *, packings: int,
    workers: int | None = None,
) -> Expected:
    """Return what all settings of all knobs take on the engines that are there, as `run_many` shares runs out."""
    settings = [s for s in bare_settings(scene, wanted) if s.width is None]
    systems = {}
    for setting in settings:
        system = likely_system(setting.scene, file)
        stepped = setting.knob in ("dt", "scheme") and not setting.own
        systems["own" if setting.own else (setting.knob, setting.value)] = (
            stepped_system(setting.scene, system, setting.value) if stepped else system
        )
    able = [e for e in engines if e.probe().available and takes(e, likely_system(scene, file))]
    costs = [run_seconds(e, s) for s in systems.values() for e in able] * packings
    workers = max(1, min(workers or usable_cores(), len(costs)))
    packed = sum(packing_seconds(s.scene, likely_system(s.scene, file)) for s in settings if s.knob not in ("dt", "scheme"))
    return Expected(
        seconds=packed * packings / workers + longest_first(costs, workers), runs=len(costs), packings=packings,
        at_once=workers,
    )
