"""Comparisons to report on: of engines that do as they are told, of hand-made boxes, and of hand-made checks."""

import importlib.util
from pathlib import Path

import pytest

from harness.report.finished import Finished, FinishedRun
from harness.studies.compare import Comparison, compare
from harness.studies.compare.biaxial import judge_biaxial
from harness.studies.compare.study import Run
from harness.studies.verdict import Check, Rerun

LIMIT = 60.0

TESTS = Path(__file__).resolve().parents[1]
DT_AND_STIFFNESS = {
    "dt": {0.045: (0.01, 0.002, 10.0), 0.03: (0.006, 0.002, 15.0)},
    "stiffness": {0.25: (-0.03, 0.004, 5.0), 1.0: (-0.008, 0.003, 10.0)},
}


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


# --- advice ----------------------------------------------------------------------------------------


@pytest.fixture
def made_up_study(tmp_path):
    """made_up_study(ladders beside dt and stiffness, ...) writes a finished study of biaxial_quick; its folder.

    The study itself is that of tests/studies/advise.
    """
    spec = importlib.util.spec_from_file_location("advise_studies", TESTS / "studies" / "advise" / "conftest.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return lambda more_ladders=(), **more: module.Study(
        tmp_path, DT_AND_STIFFNESS | dict(more_ladders), spread=0.08, **more
    ).write()


@pytest.fixture
def advised(made_up_study):
    """advised(tolerance, ladders beside dt and stiffness, ...) is advice from such a study."""
    from harness.scene.load import load_scene
    from harness.studies.advise import advise, read_evidence

    file = TESTS.parent / "inputs" / "scenes" / "biaxial_quick.toml"

    def make(tolerance, more_ladders=(), **more):
        folder = made_up_study(more_ladders, **more)
        return advise(read_evidence(
            load_scene(file), file, quantity="friction_angle", folder=folder, effects=None, tolerance=tolerance
        ), tolerance)

    return make
