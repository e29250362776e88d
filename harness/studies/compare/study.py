"""The main job: one scene, one packing (or several), every engine, checks, one result.

    scene -> packings -> systems -> runs -> trajectories -> curves, growth, averages -> checks
"""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping
from concurrent.futures import Executor
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING

from msgspec.structs import replace

from harness.runs.folder import runs_root
from harness.runs.native import NativePolicy
from harness.runs.outcome import Outcome
from harness.scene.laws import turning
from harness.scene.load import load_scene
from harness.scene.model import Biaxial, Couette, Free, Scene
from harness.studies.compare.biaxial import BiaxialResult, judge_biaxial
from harness.studies.compare.couette import CouetteResult, judge_couette
from harness.studies.compare.free import FreeResult, judge_free
from harness.studies.compare.replicates import Planned, make_starts, planned_runs, replicate_count
from harness.studies.compare.versions import by_records, explained, known_changes, known_records
from harness.studies.prepare import Prepared
from harness.studies.statistics.looks import level_of, which_look
from harness.studies.verdict import Check, Rerun, failed

if TYPE_CHECKING:
    from harness.engines.protocol import Engine
    from harness.runs.progress import Progress
    from harness.studies.watch import Watch
    from postproc.trajectory import Trajectory

JUDGES = {Biaxial: judge_biaxial, Couette: judge_couette, Free: judge_free}
"""What judges the runs of a scene, by its kind."""

TIME_LIMIT = 3600.0
"""Seconds after which an engine's run is ended, unless the user says otherwise."""


@dataclass(frozen=True, kw_only=True)
class Run:
    """One engine on one packing: its outcome, its folder, and its trajectory if it completed.

    of: "", or of the response to a kick the engine as such, as `engine` names it apart from the engine's other runs.
    watch: of watched runs, see `harness.studies.watch`.
    """

    engine: str
    packing: int
    outcome: Outcome
    folder: Path
    trajectory: Trajectory | None
    of: str = ""
    watch: Watch | None = None


@dataclass(frozen=True, kw_only=True)
class Comparison:
    """Everything a report needs. `result` is that of the scene's kind.

    words: what a user types for each engine, by its name in tables. response: see `harness.studies.compare.chaos`.
    packing_seconds: CPU time of this process in which packings were made; 0 if all were there.
    looks: numbers of replicates that it was judged with, this one last; see `harness.studies.statistics.looks`.
    command: that makes it again.
    """

    scene: Scene
    scene_file: Path
    starts: tuple[Prepared, ...]
    runs: tuple[Run, ...]
    checks: tuple[Check, ...]
    result: BiaxialResult | CouetteResult | FreeResult
    words: Mapping[str, str] = field(default_factory=dict)
    response: Run | None = None
    packing_seconds: float = 0.0
    looks: tuple[int, ...] = ()
    command: str = ""

    @property
    def all_runs(self) -> tuple[Run, ...]:
        """The runs that are compared, and the response to a kick."""
        return self.runs if self.response is None else (*self.runs, self.response)

    @property
    def completed(self) -> tuple[Run, ...]:
        """The runs to be compared that completed."""
        return tuple(r for r in self.runs if r.trajectory is not None)

    @property
    def exit_status(self) -> int:
        """1 when a check differs, nothing was compared, or a run failed; else 0.

        An engine that is not installed, or says that it cannot compute the scene, is reported and
        does not fail the comparison as long as something was compared.
        """
        broken = any(r.outcome.status in ("crashed", "unstable", "timed_out") for r in self.all_runs)
        return 1 if broken or failed(self.checks) else 0


def compare(
    scene_file: Path, engines: tuple[Engine, ...], out: Path, *, packings: int | None = None,
    time_limit: float = TIME_LIMIT, workers: int | None = None, progress: Callable[[], Progress] | None = None,
    native: NativePolicy = "gzip", executor: Executor | None = None, replicates: int | None = None,
    watched: bool = False,
) -> Comparison:
    """Run `scene_file` on `engines` and judge; runs are kept and reused below ``out/runs``.

    packings, workers: how many, as many as the scene says and as there are cores unless given. replicates: how many,
    AS_DECLARED for as many as the scene says; see `harness.studies.compare.replicates`.
    progress: makes what shows packings and runs being made; nothing is shown without.
    native: see `harness.runs.native`. executor: makes the runs in place of this process' threads.
    watched: every run is watched, see `harness.studies.watch`.
    Raises InputError for a scene that is wrong, before anything is written.
    """
    from harness.engines.registry import word_of
    from harness.runs.pool import run_many

    scene = load_scene(scene_file)
    replicates = replicate_count(scene, replicates)
    begun = time.process_time()
    starts = make_starts(
        scene, scene_file, packings=packings, replicates=replicates, cache=out / "packings", progress=progress
    )
    packed = time.process_time() - begun
    engines = distinct_engines(engines, scene)
    plan = planned_runs(scene, starts, engines, replicated=replicates is not None)
    done = run_many(
        [(p.label, p.engine, p.system) for p in plan], runs_root(out), time_limit=time_limit, workers=workers,
        progress=progress and progress(), native=native, executor=executor,
    )
    made = [_run(p, d, watched=watched) for p, d in zip(plan, done, strict=True)]
    runs, response = tuple(r for r in made if not r.of), next((r for r in made if r.of), None)
    words = {e.name: word_of(e) for e in engines}
    rerun = Rerun(scene_file=scene_file, out=out, packings=packings, words=words, replicates=replicates)
    more = {"response": response} if response else {}
    looks = which_look(out, starts[0].system.digest(), [e.name for e in engines], len(starts))
    strict = at_look(scene, looks)
    found, result = JUDGES[type(scene)](strict, starts, runs, [e.name for e in engines], rerun, **more)
    changes = known_changes(engines, [s.system for s in starts])
    records = known_records(engines, [s.system for s in starts])
    checks = tuple(by_records(explained(c, changes), records) for c in found)
    return Comparison(
        scene=scene, scene_file=scene_file, starts=tuple(starts), runs=runs, checks=checks, result=result,
        words=words, response=response, packing_seconds=packed, looks=looks,
        command=rerun(*words) + " --watch" * watched,
    )


def at_look(scene: Scene, looks: tuple[int, ...]) -> Scene:
    """Return the scene with the rate of false alarms of the last look; that of the first is the declared one."""
    if len(looks) < 2:
        return scene
    rate = level_of(scene.compare.false_alarms, looks)
    return replace(scene, compare=replace(scene.compare, false_alarms=rate))


def distinct_engines(engines: tuple[Engine, ...], scene: Scene) -> tuple[Engine, ...]:
    """Without tangential laws all conventions of the kernel are one: run it once, as `kernel:talk`."""
    from harness.engines.registry import ENGINES, KERNEL_PREFIX

    if turning(scene.contact):
        return engines
    single = (ENGINES[KERNEL_PREFIX + "talk"] if e.name.startswith(KERNEL_PREFIX) else e for e in engines)
    return tuple(dict.fromkeys(single))


def _run(planned: Planned, done, *, watched: bool) -> Run:
    from postproc.trajectory import read_trajectory

    seen, outcome = _watched(planned, done) if watched else (None, done.outcome)
    completed = outcome.status == "completed"
    trajectory = read_trajectory(done.folder / "trajectory.h5") if completed else None
    return Run(
        engine=planned.name, packing=planned.number, outcome=outcome, folder=done.folder, trajectory=trajectory,
        of=planned.of, watch=seen,
    )


def _watched(planned: Planned, done) -> tuple[Watch, Outcome]:
    from harness.studies.watch import watched

    return watched(planned.engine, planned.system, done.folder, done.outcome)
