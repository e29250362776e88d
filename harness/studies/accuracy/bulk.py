"""What accuracy costs in bulk: knobs of a box or a ring, a ladder each, on several packings and engines.

    scene -> settings (knob, value) -> packings -> runs -> quantities -> limits -> errors against CPU time

The scene as declared is a rung of every ladder and is run once. Runs are kept below ``out/runs`` by their content, so
that an interrupted study goes on where it was.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from datetime import UTC, datetime
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from harness.engines.registry import ENGINES, KERNEL_PREFIX, choose_engines
from harness.errors import InputError
from harness.runs.folder import runs_root
from harness.runs.outcome import Host, host_facts
from harness.runs.pool import Done, run_many
from harness.scene.judged import MOST_PACKINGS
from harness.scene.model import Biaxial, Couette
from harness.studies.accuracy.asked import Asked
from harness.studies.accuracy.bulk_plan import Packed, Setting, plan
from harness.studies.accuracy.bulk_quantities import BULK, bulk_values
from harness.studies.accuracy.bulk_result import Floor, Ladder, floor_of, scale_of
from harness.studies.accuracy.bulk_rungs import OWN_WIDTH, Key, Measured, rungs_of
from harness.studies.accuracy.limit import Order, find_limit, order_or_why
from harness.studies.accuracy.shaken import shaking_of
from harness.studies.accuracy.shown import Grouped
from harness.studies.prepare import draws_packings

if TYPE_CHECKING:
    from harness.engines.protocol import Engine
    from harness.runs.progress import Progress

USUAL_ENGINES = ("lammps", "liggghts", "kernel:talk")
"""Of the kernel one convention: after chaos all give the same statistics."""

PACKINGS: dict[type, int] = {Biaxial: 8, Couette: 2}
"""Usual number of packings: of boxes as many as show a friction angle's spread, of rings what takes minutes."""


@dataclass(frozen=True, kw_only=True, eq=False)
class BulkAccuracy:
    """Everything a report needs, and everything advice is made of: see `harness.report.accuracy_bulk` for the JSON.

    asked: by knob. floors: by engine and quantity. wall_seconds: of the whole study this time. own_seconds: CPU time of
    everything but engines and packings; packing_seconds, engine_seconds: CPU time of those, of this time; kept: how
    many runs were there already, of `runs`. load: largest load average of the machine at the start of a run.
    """

    scene: Biaxial | Couette
    scene_file: Path
    asked: tuple[Asked, ...]
    packings: int
    ladders: tuple[Ladder, ...]
    floors: Mapping[tuple[str, str], Floor]
    host: Host
    wall_seconds: float
    own_seconds: float
    packing_seconds: float
    engine_seconds: float
    runs: int
    kept: int
    load: float

    @property
    def quantity(self) -> str:
        """What errors are told of."""
        return self.asked[0].quantity

    @property
    def engines(self) -> list[str]:
        """Names, in order."""
        return list(dict.fromkeys(ladder.engine for ladder in self.ladders))

    @property
    def knobs(self) -> list[str]:
        """Names, in order."""
        return [a.knob.name for a in self.asked]

    @property
    def own_share(self) -> float | None:
        """CPU time of the study itself over all CPU time, None if nothing was run."""
        whole = self.own_seconds + self.packing_seconds + self.engine_seconds
        return self.own_seconds / whole if self.kept < self.runs else None

    @property
    def exit_status(self) -> int:
        """1 when an engine that takes the scene has no error at all; unstable rungs are what is looked for."""
        taken = [la for la in self.ladders if any(r.status not in ("unsupported", "unavailable") for r in la.rungs)]
        return 0 if taken and all(any(la.known(q) for q in la.scales) for la in taken) else 1


def bulk_accuracy(
    scene: Biaxial | Couette, scene_file: Path, wanted: tuple[Asked, ...], out: Path, *,
    engines: Sequence[str] | None, packings: int | None, time_limit: float, workers: int | None,
    progress: Callable[[], Progress] | None,
) -> BulkAccuracy:
    """Climb all ladders. Raises InputError for what cannot be, before anything is written."""
    begun, own, since = time.monotonic(), time.process_time(), datetime.now(UTC)
    chosen = bulk_engines(engines, wanted)
    count = packing_count(scene, packings)
    planned = plan(scene, scene_file, wanted, count, out / "packings", workers=workers, progress=progress)
    done = run_settings(planned, chosen, out, time_limit=time_limit, workers=workers, progress=progress)
    measured = measure_settings(planned, done)
    ladders = tuple(
        _ladder(scene, a, e, [s for s in planned.settings if s.knob == a.knob.name], done, measured)
        for a in wanted for e in chosen
    )
    outcomes = list({d.folder: d.outcome for d in done.values()}.values())
    fresh = [o for o in outcomes if o.started >= since]
    return BulkAccuracy(
        scene=scene, scene_file=scene_file, asked=wanted, packings=count, ladders=ladders,
        floors=_floors(scene, ladders), host=host_facts(), wall_seconds=time.monotonic() - begun,
        own_seconds=time.process_time() - own, packing_seconds=planned.seconds,
        engine_seconds=sum(o.cpu_seconds or 0.0 for o in fresh), runs=len(outcomes), kept=len(outcomes) - len(fresh),
        load=max((o.load_average for o in outcomes), default=0.0),
    )


def bulk_engines(words: Sequence[str] | None, wanted: Sequence[Asked]) -> tuple[Engine, ...]:
    """Return the engines: the usual ones unless named; of the knob `scheme` the kernel in all its conventions."""
    if words:
        return choose_engines(list(words))
    if [a.knob.name for a in wanted] == ["scheme"]:
        return tuple(e for name, e in ENGINES.items() if name.startswith(KERNEL_PREFIX))
    return choose_engines(list(USUAL_ENGINES))


def packing_count(scene: Biaxial | Couette, packings: int | None) -> int:
    """Return how many packings are made. Raises InputError for what gives no spread."""
    if not draws_packings(scene):
        raise InputError(
            file="--packings", expected="a scene whose particles are drawn at random", got="particles from a file",
            fix="without a spread over packings no error bar can be told",
        )
    count = PACKINGS[type(scene)] if packings is None else packings
    if not 2 <= count <= MOST_PACKINGS:
        raise InputError(
            file="--packings", expected=f"a number from 2 to {MOST_PACKINGS}", got=count,
            fix="the spread over packings is the error bar",
        )
    return count


# --- runs --------------------------------------------------------------------------------------------


def run_settings(
    planned: Packed, engines: Sequence[Engine], out: Path, *, progress: Callable[[], Progress] | None, **options
) -> dict[Key, Done]:
    """Make every run once, the longest first; return them by engine and system."""
    jobs, groups = {}, {}
    for setting in planned.settings:
        for number, system in enumerate(setting.systems):
            for engine in engines:
                key = Key(engine.name, system.digest())
                jobs.setdefault(key, (f"{setting.name}, {engine.name} #{number + 1}", engine, system))
                groups.setdefault(key, f"{setting.name}, {engine.name}")
    shown = Grouped(list(groups.values()), progress()) if progress else None
    done = run_many(list(jobs.values()), runs_root(out), native="drop", progress=shown, **options)
    return dict(zip(jobs, done, strict=True))


def measure_settings(planned: Packed, done: Mapping[Key, Done]) -> dict[Key, Measured]:
    """Read every completed run once and return its quantities in all widths, and how it is shaken."""
    from postproc.trajectory import read_trajectory

    widths = {OWN_WIDTH: None} | {s.width: s.width for s in planned.settings if s.width is not None}
    wide = {s.systems[k].digest() for s in planned.settings if s.width is not None for k in range(len(s.systems))}
    of = {system.digest(): (s.scene, system) for s in planned.settings for system in s.systems}
    found = {}
    for key, d in done.items():
        if d.outcome.status == "completed":
            scene, system = of[key.system]
            wanted = widths if key.system in wide else {OWN_WIDTH: None}
            trajectory = read_trajectory(d.folder / "trajectory.h5")
            found[key] = Measured(
                values=bulk_values(scene, system, trajectory, wanted), shaking=shaking_of(scene, system, trajectory)
            )
    return found


# --- judging -----------------------------------------------------------------------------------------


def _ladder(
    scene: Biaxial | Couette, wanted: Asked, engine: Engine, settings: Sequence[Setting], done: Mapping[Key, Done],
    measured: Mapping[Key, Measured],
) -> Ladder:
    rungs = rungs_of(settings, engine.name, done, measured)
    good = [r for r in rungs if r.good]
    limits, orders, orderless, scales = {}, {}, {}, {}
    for bulk in BULK[type(scene)]:
        have = [r for r in good if bulk.name in r.values]
        if not have:
            continue
        if not wanted.knob.words:
            x, values = [r.x for r in have], np.array([r.values[bulk.name] for r in have])
            limits[bulk.name] = find_limit(x, values, wanted.knob.expected)
            found = order_or_why(x, values)
            orders[bulk.name] = found if isinstance(found, Order) else None
            orderless[bulk.name] = "" if isinstance(found, Order) else found
        own = next((r.values[bulk.name] for r in have if r.own), None)
        scale = scale_of(limits.get(bulk.name), own, bulk.scale(scene) if bulk.scale else None)
        if scale is not None:
            scales[bulk.name] = scale
    return Ladder(
        knob=wanted.knob, engine=engine.name, rungs=rungs, limits=limits, orders=orders, scales=scales,
        orderless=orderless,
    )


def _floors(scene: Biaxial | Couette, ladders: Sequence[Ladder]) -> dict[tuple[str, str], Floor]:
    """Return the scatter over packings of every engine and quantity, from the rung that is the scene as declared."""
    found = {}
    for ladder in ladders:
        for bulk in BULK[type(scene)]:
            floor = floor_of(ladder.own, bulk.name, ladder.scales.get(bulk.name), bulk.unit)
            if floor is not None:
                found.setdefault((ladder.engine, bulk.name), floor)
    return found
