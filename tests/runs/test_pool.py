import io
import multiprocessing
import os
import re
import signal
import subprocess
import sys
import threading
import time
from concurrent.futures import ProcessPoolExecutor, ThreadPoolExecutor

import pytest

from harness.engines.child import Stopped, children_stopped, run_child
from harness.runs.execute import run_one
from harness.runs.folder import RunFolder, list_runs
from harness.runs.pool import run_many
from harness.runs.progress import Lines

LIMIT = 60.0


def test_results_come_in_the_order_given_and_failures_end_nothing(in_mode, system, make_system, root):
    modes = ["exit", "complete", "nan", "complete"]
    jobs = [(f"job {k}", in_mode(m), make_system(vx=1.0 + k)) for k, m in enumerate(modes)]
    done = run_many(jobs, root, time_limit=LIMIT, workers=2)
    assert [d.label for d in done] == ["job 0", "job 1", "job 2", "job 3"]
    assert [d.outcome.status for d in done] == ["crashed", "completed", "unstable", "completed"]
    assert [d.outcome.system_digest for d in done] == [s.digest() for _, _, s in jobs]
    assert all((d.folder / "outcome.json").exists() for d in done)


def test_longest_first(in_mode, make_system, root):
    costs = [2.0, 9.0, 5.0]
    jobs = [(f"{c}", in_mode("complete", cost=c), make_system(vx=c)) for c in costs]
    done = run_many(jobs, root, time_limit=LIMIT, workers=1)
    assert sorted(costs, key=lambda c: done[costs.index(c)].outcome.started) == [9.0, 5.0, 2.0]


def test_no_name_comes_twice_in_the_line_that_says_how_a_run_ended(engine, system, root):
    """The line names scene and engine itself; another label stands before it."""
    own, stream = f"{system.scene_name}, {engine.name}", io.StringIO()
    run_many([(own, engine, system)], root, time_limit=LIMIT, progress=Lines(stream))
    run_many([("seventh try", engine, system)], root, time_limit=LIMIT, progress=Lines(stream))
    first, second = (line for line in stream.getvalue().splitlines() if line.startswith("[1/1]"))
    assert first.startswith(f"[1/1] {own} ")
    assert first.count(system.scene_name) == 1
    assert second.startswith("[1/1] seventh try: kept, made ")


def test_one_run_asked_for_twice_is_made_once(engine, system, root, begun):
    done = run_many([("a", engine, system), ("b", engine, system)], root, time_limit=LIMIT, workers=2)
    assert done[0].outcome == done[1].outcome
    assert begun() == 1


def test_bugs_are_raised_after_all_others_are_done(in_mode, make_system, root):
    jobs = [(m, in_mode(m), make_system(vx=float(k))) for k, m in enumerate(["bug", "complete", "complete"])]
    with pytest.raises(ExceptionGroup, match="1 of 3 jobs") as caught:
        run_many(jobs, root, time_limit=LIMIT, workers=1)
    (error,) = caught.value.exceptions
    assert isinstance(error, TypeError)
    assert "in job 'bug', folder" in error.__notes__[0]
    assert [o.status for _, o, _ in list_runs(root) if o] == ["completed"] * 2


def test_no_jobs(root):
    assert run_many([], root, time_limit=LIMIT) == []


@pytest.mark.parametrize("make", [
    lambda: ThreadPoolExecutor(1),
    lambda: ProcessPoolExecutor(1, mp_context=multiprocessing.get_context("fork")),
])
def test_any_executor_will_do(in_mode, make_system, root, make):
    jobs = [(m, in_mode(m), make_system(vx=float(k))) for k, m in enumerate(["complete", "SIGSEGV"])]
    with make() as executor:
        done = run_many(jobs, root, time_limit=LIMIT, executor=executor)
    assert [d.outcome.status for d in done] == ["completed", "crashed"]


def test_progress_follows_the_engine(in_mode, make_system, root, monkeypatch):
    monkeypatch.setattr("harness.runs.pool.POLL", 0.02)
    seen = []

    class Watch(Lines):
        def running(self, job, fraction):
            seen.append(fraction)
            super().running(job, fraction)

    out = io.StringIO()
    run_many([("slow one", in_mode("slow"), make_system(steps=24))], root, time_limit=LIMIT, progress=Watch(out))
    assert seen == sorted(seen)
    assert any(0 < f < 1 for f in seen)
    lines = out.getvalue().splitlines()
    assert lines[0] == "slow one: started"
    assert lines[-1].startswith("[1/1] slow one: flight, fake 1.0: completed, 24 steps")


def test_a_run_that_is_kept_is_not_said_to_be_started(in_mode, system, make_system, root, monkeypatch):
    """However long it takes to see that it is undamaged; another that is made beside it is."""
    monkeypatch.setattr("harness.runs.pool.POLL", 0.01)
    run_many([("old", in_mode("complete"), system)], root, time_limit=LIMIT)
    true = RunFolder.completed
    monkeypatch.setattr(RunFolder, "completed", lambda self, deck: time.sleep(0.2) or true(self, deck))
    out, jobs = io.StringIO(), [("old", in_mode("complete"), system), ("new", in_mode("slow"), make_system(vx=9.0))]
    run_many(jobs, root, time_limit=LIMIT, progress=Lines(out))
    lines = out.getvalue().splitlines()
    assert not [line for line in lines if line.startswith("old: ")]
    assert "new: started" in lines
    (kept,) = [line for line in lines if "] old: " in line]
    assert re.match(r"\[1/2\] old: kept, made \d{4}-\d\d-\d\d \d\d:\d\d UTC: flight, fake 1.0: completed", kept)
    assert [line for line in lines if "] new: flight, fake 1.0: completed" in line]


RUN_MANY = """
from harness.runs.pool import run_many
jobs = [(str(k), engine, fake.flight(vx=float(k))) for k in range(4)]
print("start", flush=True)
run_many(jobs, root, time_limit=600, workers=2)
"""


@pytest.mark.parametrize(("number", "code"), [
    (signal.SIGINT, -signal.SIGINT), (signal.SIGTERM, 128 + signal.SIGTERM), (signal.SIGHUP, 128 + signal.SIGHUP),
])
def test_an_interrupt_ends_the_engines_and_leaves_folders_unfinished(driver, root, journal, begun, number, code):
    harness = subprocess.Popen([sys.executable, "-c", driver + RUN_MANY, root, journal, "hang"],
                               stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    wait_for(lambda: begun() == 2)
    os.kill(harness.pid, number)
    _, errors = harness.communicate(timeout=60)
    assert harness.returncode == code, errors
    assert begun() == 2  # the other two were never started
    pids = [int(pid) for pid in re.findall(r"begin (\d+)", journal.read_text())]
    assert not [pid for pid in pids if is_running(pid)]
    assert [note for _, _, note in list_runs(root)] == ["unfinished"] * 2


def test_runs_work_again_after_an_interrupt(in_mode, system, root, begun):
    caught = []

    def target():
        try:
            run_one(in_mode("hang"), system, root, time_limit=LIMIT)
        except Stopped as error:
            caught.append(error)

    thread = threading.Thread(target=target)
    thread.start()
    wait_for(lambda: begun() == 1)
    with children_stopped():
        thread.join(60)
        with pytest.raises(Stopped):
            run_child(["true"], folder=root, log="log", time_limit=LIMIT)
    assert len(caught) == 1
    assert run_one(in_mode("complete"), system, root, time_limit=LIMIT)[0].status == "completed"


def test_waiting_for_a_lock_can_be_interrupted(engine, system, root, caplog):
    _, path = run_one(engine, system, root, time_limit=LIMIT)
    caught = []

    def target():
        try:
            run_one(engine, system, root, time_limit=LIMIT)
        except Stopped as error:
            caught.append(error)

    with RunFolder(root=root, name=path.name, identity={}).lock():
        thread = threading.Thread(target=target)
        thread.start()
        wait_for(lambda: "waiting for it" in caplog.text)
        with children_stopped():
            thread.join(60)
    assert len(caught) == 1


def wait_for(condition):
    deadline = time.monotonic() + 60
    while not condition():
        assert time.monotonic() < deadline, "waited for a minute in vain"
        time.sleep(0.01)


def is_running(pid):
    try:
        os.kill(pid, 0)
    except ProcessLookupError:
        return False
    return True
