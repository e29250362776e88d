"""What engines may do to a prescribed run: every failure is an outcome, and nothing large is left behind."""

import logging
import os
import re
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from harness.engines.child import run_child
from harness.engines.protocol import PATH_FILE, REACTION_FILE, Probe, RunResult, Support
from harness.studies.laws.arrangement import arrangement
from harness.studies.laws.cases import CASES
from harness.studies.laws.drive import Driver, Job

PLACE = arrangement("plane", 2)
ANSWERS = {
    "answers": "force = np.ones_like(p['x'][1:]); torque = np.zeros_like(p['spin'][1:])",
    "too few rows": "force = p['x'][2:]; torque = p['spin'][2:]",
    "no numbers": "force = np.full_like(p['x'][1:], np.nan); torque = p['spin'][1:]",
}


class Scripted:
    """An engine whose child runs one line of Python on the path; `runs` counts."""

    name = "scripted"

    def __init__(self, does: str, level: str = "exact", available: bool = True):
        self.does, self.level, self.available, self.runs = does, level, available, 0

    def probe(self) -> Probe:
        return Probe(available=self.available, version="1", detail="get it from nowhere")

    def supports(self, system):
        return (Support(effect="laws", level=self.level, note="see the manual"),)

    def render_prescribed(self, system):
        lines = ["import numpy as np", f"p = np.load('{PATH_FILE}')", self.does]
        save = f"np.savez('{REACTION_FILE}', force=force, torque=torque)" if "force" in self.does else ""
        return {"deck.py": "\n".join([*lines, save]) + "\n"}

    def run_prescribed(self, folder: Path, *, time_limit: float) -> RunResult:
        self.runs += 1
        child = run_child([sys.executable, "deck.py"], folder=folder, log="log", time_limit=time_limit)
        status = "timed_out" if child.timed_out else "completed" if child.returncode == 0 else "crashed"
        return RunResult(
            status=status, reason="" if status == "completed" else "it said so", last_lines=child.last_lines,
            cpu_seconds=child.cpu_seconds, wall_seconds=child.wall_seconds,
        )


def drive(engine, folder, time_limit=30.0):
    job = Job(laws=CASES["linear"], engine=engine, arrangement=PLACE)
    return Driver(root=folder, time_limit=time_limit, workers=1).drive(job)


def test_an_answer_is_taken_and_kept(tmp_path):
    done = drive(Scripted(ANSWERS["answers"], level="partial"), tmp_path)
    assert (done.status, done.reason) == ("completed", "")
    assert done.reaction.force.shape == PLACE.path.x[1:].shape
    assert done.notes == ("laws: partial: see the manual",)
    left = {p.name for p in done.folder.iterdir()}
    assert left == {"deck.py", "identity.json", "log", PATH_FILE, REACTION_FILE, "outcome.json"}


@pytest.mark.parametrize(("does", "status", "reason"), [
    (ANSWERS["too few rows"], "crashed", "force and torque have the shapes"),
    (ANSWERS["no numbers"], "unstable", "not finite"),
    ("pass", "crashed", "cannot be read"),
    ("raise SystemExit(3)", "crashed", "it said so"),
    (f"open('{REACTION_FILE}', 'w').write('nonsense')", "crashed", "cannot be read"),
    (f"np.savez('{REACTION_FILE}', a=p['x']); import os; os.truncate('{REACTION_FILE}', 900)", "crashed", "be read"),
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
    assert re.fullmatch("linear_x_plane_2d-scripted-[0-9a-f]{12}", done.folder.name)
    assert done.part == "planes in 2D"


# --- what is kept --------------------------------------------------------------------------------


def again(engine, folder, caplog):
    """Drive once more, another day; return what became of it and the lines that were said."""
    caplog.clear()
    with caplog.at_level(logging.WARNING):
        done = drive(engine, folder)
    return done, [r.getMessage() for r in caplog.records]


@pytest.fixture
def engine():
    return Scripted(ANSWERS["answers"])


@pytest.fixture
def first(engine, tmp_path):
    return drive(engine, tmp_path)


def test_a_finished_run_is_never_made_twice(engine, first, tmp_path, caplog):
    done, said = again(engine, tmp_path, caplog)
    assert (engine.runs, said) == (1, [])
    assert (first.kept, done.kept) == (False, True)
    assert done.folder == first.folder
    assert np.array_equal(done.reaction.force, first.reaction.force)


def test_a_failed_run_is_tried_again(tmp_path, caplog):
    engine = Scripted("raise SystemExit(3)")
    drive(engine, tmp_path)
    done, _ = again(engine, tmp_path, caplog)
    assert (engine.runs, done.status, done.kept) == (2, "crashed", False)


def cut(file):
    content = file.read_bytes()
    file.write_bytes(content[: len(content) // 2])


def edited(file):
    with np.load(file) as found:
        numbers = {k: found[k].copy() for k in found}
    next(iter(numbers.values()))[5] += 1e-9
    np.savez(file, **numbers)


@pytest.mark.parametrize("damage", [cut, edited, Path.unlink])
@pytest.mark.parametrize("name", [REACTION_FILE, "deck.py", "identity.json", "outcome.json"])
def test_a_damaged_run_is_made_again_with_one_line(damage, name, engine, first, tmp_path, caplog):
    if damage is edited and name != REACTION_FILE:
        (first.folder / name).write_text((first.folder / name).read_text() + " ")
    else:
        damage(first.folder / name)
    done, said = again(engine, tmp_path, caplog)
    spaces = damage is edited and name == "outcome.json"  # which means the same
    assert engine.runs == (1 if spaces else 2)
    assert len(said) == (0 if spaces else 1)
    assert done.status == "completed"
    assert np.array_equal(done.reaction.force, first.reaction.force)


def shared(folder: Path) -> Path:
    (file,) = (folder / "paths").glob("*.npz")
    return file


def whole(file) -> bool:
    with np.load(file) as path:
        return all(np.array_equal(path[k], getattr(PLACE.path, k)) for k in ("x", "v", "spin"))


@pytest.mark.parametrize("damage", [cut, edited])
def test_a_damaged_path_is_made_anew_with_one_line_and_everywhere(damage, engine, first, tmp_path, caplog):
    """It is linked into every run folder: what damages one damages all."""
    other = Scripted(ANSWERS["answers"])
    other.name = "other"
    drive(other, tmp_path)
    file = shared(tmp_path)
    file.chmod(0o644)
    damage(file)
    assert file.samefile(first.folder / PATH_FILE)
    assert not (damage is edited and whole(file))
    caplog.clear()
    driver = Driver(root=tmp_path, time_limit=30.0, workers=1)
    done = [driver.drive(Job(laws=CASES["linear"], engine=e, arrangement=PLACE)) for e in (engine, other)]
    assert [r.getMessage() for r in caplog.records] == [f"paths/{file.name}: not the path it is named after; made anew"]
    assert all(d.status == "completed" and whole(d.folder / PATH_FILE) for d in done)
    assert whole(file)
    assert (engine.runs, other.runs) == (1, 1)


def test_a_new_run_never_takes_a_damaged_path(engine, first, tmp_path, caplog):
    file = shared(tmp_path)
    file.chmod(0o644)
    cut(file)
    other = Scripted(ANSWERS["answers"])
    other.name = "other"
    done, said = again(other, tmp_path, caplog)
    assert done.status == "completed"
    assert len(said) == 1


def test_a_path_that_is_lost_in_one_folder_is_put_back(engine, first, tmp_path, caplog):
    own = first.folder / PATH_FILE
    own.unlink()
    done, said = again(engine, tmp_path, caplog)
    assert (done.status, said, whole(own)) == ("completed", [], True)
    own.unlink()
    own.write_text("nonsense")
    done, said = again(engine, tmp_path, caplog)
    assert whole(own)
    assert said == [f"{first.folder.name}: {PATH_FILE} is not the path that was run; put back"]
    assert engine.runs == 1


def test_the_path_cannot_be_written_by_accident(first, tmp_path):
    assert not os.stat(first.folder / PATH_FILE).st_mode & 0o222
    assert shared(tmp_path).samefile(first.folder / PATH_FILE)


def test_a_path_changed_during_the_run_is_no_answer(tmp_path):
    spoils = "import os; os.chmod('path.npz', 0o644); open('path.npz', 'ab').write(b' '); "
    done = drive(Scripted(spoils + ANSWERS["answers"]), tmp_path)
    assert (done.status, done.reason) == ("crashed", "the path was changed while the engine ran")


def test_whoever_waits_is_told(tmp_path):
    slow = Scripted("import time; time.sleep(1.5); " + ANSWERS["answers"])
    driver, said = Driver(root=tmp_path, time_limit=30.0, workers=1), []
    list(driver.each([[Job(laws=CASES["linear"], engine=slow, arrangement=PLACE)]], lambda *w: said.append(w)))
    assert said
    assert set(said) == {(0, 0.0)}
    assert driver.making == {"linear"}
