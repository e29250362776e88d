"""Comparisons to report on: of engines that do as they are told, of hand-made boxes, and of hand-made checks."""

import pytest

from harness.report.finished import Finished, FinishedRun
from harness.studies.compare import Comparison, compare
from harness.studies.compare.biaxial import judge_biaxial
from harness.studies.compare.study import Run
from harness.studies.verdict import Check, Rerun

LIMIT = 60.0


@pytest.fixture
def free(flight, obedient, tmp_path):
    """free(**settings of a third engine) is a comparison of a, b, and if asked of a third."""

    def make(**third):
        engines = [obedient("a"), obedient("b", off=1e-6), *([obedient("third", **third)] if third else [])]
        return compare(flight, tuple(engines), tmp_path / "runs of free", time_limit=LIMIT)

    return make


@pytest.fixture
def biaxial(box, finished, free):
    """biaxial(runs by engine and packing, box) is a comparison of hand-made runs."""
    outcome = free().runs[0].outcome

    def make(trajectories: dict, of=box):
        count = 1 + max(k for _, k in trajectories)
        starts = tuple(of.start(k) for k in range(count))
        runs = tuple(
            Run(engine=e, packing=k, outcome=outcome, folder=of.folder, trajectory=t)
            for (e, k), t in trajectories.items()
        )
        engines = list(dict.fromkeys(e for e, _ in trajectories))
        rerun = Rerun(scene_file=of.file, out=of.folder, packings=None)
        checks, result = judge_biaxial(of.scene, starts, runs, engines, rerun)
        return Comparison(
            scene=of.scene, scene_file=of.file, starts=starts, runs=runs, checks=tuple(checks), result=result
        )

    return make


@pytest.fixture
def check():
    """check("differs", left="a", ...) is a check; what is not said is some default."""

    def make(verdict="agrees", **facts) -> Check:
        usual = {
            "level": "L2", "quantity": "force", "left": "a", "right": "b", "deviation": 1e-3, "tolerance": 1e-2,
            "why": "largest of 3 samples; rerun: grainproof compare s.toml" if verdict == "differs" else "largest",
        }
        return Check(verdict=verdict, **(usual | facts))

    return make


@pytest.fixture
def outcome(free):
    """outcome(status="crashed", ...) is an outcome of a run that was really made, changed as told."""
    import msgspec

    made = free().runs[0].outcome

    def make(**facts):
        if facts.get("status", "completed") != "completed":
            facts = {"trajectory": None, "reason": "signal 6", "steps_done": 3, **facts}
        return msgspec.structs.replace(made, **facts)

    return make


@pytest.fixture
def ran(outcome):
    """ran("lammps", packing=0, ...) is a run with such an outcome."""

    def make(engine: str, packing: int = 0, **facts) -> FinishedRun:
        return FinishedRun(engine=engine, packing=packing, outcome=outcome(engine=engine, **facts))

    return make


@pytest.fixture
def finished_report(ran, tmp_path):
    """finished_report(checks, runs=..., tables=..., scene=...) is a report as it is read."""

    def make(checks, *, runs=None, tables=None, scene=None, name="new") -> Finished:
        return Finished(
            file=tmp_path / name / "report.json", scene_file="s.toml", scene=scene or {"title": "T"}, exit_status=0,
            summary="so and so", checks=tuple(checks), runs=tuple(runs or (ran("a"), ran("b"))), tables=tables or {},
        )

    return make
