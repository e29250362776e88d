"""One run of one scene on one engine."""

from __future__ import annotations

from collections.abc import Callable
from concurrent.futures import Executor
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from harness.runs.folder import runs_root
from harness.runs.outcome import Outcome
from harness.runs.pool import run_many
from harness.scene.load import load_scene
from harness.scene.model import Scene
from harness.scene.system import System
from harness.studies.prepare import prepare

if TYPE_CHECKING:
    from harness.engines.protocol import Engine
    from harness.runs.pool import Done
    from harness.runs.progress import Progress
    from harness.studies.watch import Watch
    from postproc.trajectory import Trajectory


@dataclass(frozen=True, kw_only=True)
class SingleRun:
    """What came of it; the trajectory only if it completed, the watch only if it was asked for."""

    scene: Scene
    system: System
    engine: str
    outcome: Outcome
    folder: Path
    trajectory: Trajectory | None
    watch: Watch | None = None

    @property
    def exit_status(self) -> int:
        """1 when it did not complete, or was watched and is not to be trusted."""
        remarked = self.watch is not None and bool(self.watch.remarks)
        return 0 if self.outcome.status == "completed" and not remarked else 1


def single_run(
    scene_file: Path, engine: Engine, out: Path, *, time_limit: float, progress: Callable[[], Progress] | None = None,
    executor: Executor | None = None, watched: bool = False,
) -> SingleRun:
    """Run a scene's first packing on one engine below ``out/runs``; watched: see `harness.studies.watch`.

    Raises InputError for a scene that is wrong, before anything is written.
    """
    from postproc.trajectory import read_trajectory

    scene = load_scene(scene_file)
    system = prepare(scene, scene_file, packings=1, cache=out / "packings", progress=progress)[0].system
    (done,) = run_many(
        [(engine.name, engine, system)], runs_root(out), time_limit=time_limit, progress=progress and progress(),
        executor=executor,
    )
    completed = done.outcome.status == "completed"
    seen, outcome = _watched(engine, system, done) if watched else (None, done.outcome)
    return SingleRun(
        scene=scene, system=system, engine=engine.name, outcome=outcome, folder=done.folder, watch=seen,
        trajectory=read_trajectory(done.folder / "trajectory.h5") if completed else None,
    )


def _watched(engine: Engine, system: System, done: Done) -> tuple[Watch, Outcome]:
    from harness.studies.watch import watched

    return watched(engine, system, done.folder, done.outcome)
