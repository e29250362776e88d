"""What engines may do to a prescribed run: every failure is an outcome, and nothing large is left behind."""

import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from harness.engines.child import run_child
from harness.engines.protocol import PATH_FILE, REACTION_FILE, Probe, RunResult, Support
from harness.studies.laws.arrangement import arrangement
from harness.studies.laws.cases import CASES
from harness.studies.laws.drive import RECORD, Driver, Job

PLACE = arrangement("plane", 2)
ANSWERS = {
    "answers": "force = np.ones_like(p['x'][1:]); torque = np.zeros_like(p['spin'][1:])",
    "too few rows": "force = p['x'][2:]; torque = p['spin'][2:]",
    "no numbers": "force = np.full_like(p['x'][1:], np.nan); torque = p['spin'][1:]",
}


class Scripted:
    """An engine whose child runs one line of Python on the path."""

    name = "scripted"

    def __init__(self, does: str, level: str = "exact", available: bool = True):
        self.does, self.level, self.available = does, level, available

    def probe(self) -> Probe:
        return Probe(available=self.available, version="1", detail="get it from nowhere")

    def supports(self, system):
        return (Support(effect="laws", level=self.level, note="see the manual"),)

    def render_prescribed(self, system):
        lines = ["import numpy as np", f"p = np.load('{PATH_FILE}')", self.does]
        save = f"np.savez('{REACTION_FILE}', force=force, torque=torque)" if "force" in self.does else ""
        return {"deck.py": "\n".join([*lines, save]) + "\n"}

    def run_prescribed(self, folder: Path, *, time_limit: float) -> RunResult:
        child = run_child([sys.executable, "deck.py"], folder=folder, log="log", time_limit=time_limit)
        status = "timed_out" if child.timed_out else "completed" if child.returncode == 0 else "crashed"
        return RunResult(
            status=status, reason="" if status == "completed" else "it said so", last_lines=child.last_lines,
            cpu_seconds=child.cpu_seconds, wall_seconds=child.wall_seconds,
        )


def drive(engine, folder, time_limit=30.0):
    job = Job(laws=CASES["linear"], engine=engine, arrangement=PLACE)
    return Driver(root=folder, time_limit=time_limit, workers=1).drive(job)


def test_an_answer_is_taken_and_its_file_removed(tmp_path):
    done = drive(Scripted(ANSWERS["answers"], level="partial"), tmp_path)
    assert (done.status, done.reason) == ("completed", "")
    assert done.reaction.force.shape == PLACE.path.x[1:].shape
    assert done.notes == ("laws: partial: see the manual",)
    left = {p.name for p in done.folder.iterdir()}
    assert left == {"deck.py", "identity.json", "log", PATH_FILE, RECORD}


@pytest.mark.parametrize(("does", "status", "reason"), [
    (ANSWERS["too few rows"], "crashed", "force and torque have the shapes"),
    (ANSWERS["no numbers"], "unstable", "not finite"),
    ("pass", "crashed", "cannot be read"),
    ("raise SystemExit(3)", "crashed", "it said so"),
    (f"open('{REACTION_FILE}', 'w').write('nonsense')", "crashed", "cannot be read"),
])
def test_anything_else_is_a_failure_with_a_reason(does, status, reason, tmp_path):
    done = drive(Scripted(does), tmp_path)
    assert (done.status, done.reaction) == (status, None)
    assert reason in done.reason


def test_a_hanging_engine_is_ended(tmp_path):
    assert drive(Scripted("import time; time.sleep(60)"), tmp_path, time_limit=1.0).status == "timed_out"


def test_what_is_refused_or_absent_is_not_run(tmp_path):
    assert drive(Scripted("pass", level="known_wrong"), tmp_path).reason == "laws: known wrong: see the manual"
    assert drive(Scripted("pass", available=False), tmp_path).status == "unavailable"
    assert list(tmp_path.iterdir()) == []


def test_groups_come_back_in_order_and_share_one_path(tmp_path):
    good, bad = Scripted(ANSWERS["answers"]), Scripted("raise SystemExit(1)")
    bad.name = "broken"
    jobs = [[Job(laws=CASES[n], engine=e, arrangement=PLACE) for e in (good, bad)] for n in ("linear", "hertz")]
    groups = list(Driver(root=tmp_path, time_limit=30.0, workers=2).each(jobs))
    assert [[(d.job.laws.name, d.status) for d in g] for g in groups] == [
        [("linear", "completed"), ("linear", "crashed")], [("hertz", "completed"), ("hertz", "crashed")],
    ]
    (shared,) = (tmp_path / "paths").glob("*.npz")
    assert all((d.folder / PATH_FILE).samefile(shared) for g in groups for d in g)
    with np.load(shared) as path:
        assert np.array_equal(path["x"], PLACE.path.x)


def test_an_error_of_the_harness_ends_all(tmp_path):
    class Broken(Scripted):
        def render_prescribed(self, system):
            raise ValueError("our own fault")

    jobs = [[Job(laws=CASES["linear"], engine=Broken("pass"), arrangement=PLACE)]]
    with pytest.raises(ValueError, match="our own fault"):
        list(Driver(root=tmp_path, time_limit=30.0, workers=1).each(jobs))


def test_a_run_is_named_by_law_place_and_engine(tmp_path):
    job = Job(laws=replace(CASES["linear"], name="linear+x"), engine=Scripted(ANSWERS["answers"]), arrangement=PLACE)
    done = Driver(root=tmp_path, time_limit=30.0, workers=1).drive(job)
    assert done.folder.name == "linear+x-plane-2d-scripted"
    assert done.part == "planes in 2D"
