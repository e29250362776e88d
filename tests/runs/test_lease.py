"""Runs in other processes and the harness that they are made for: whether it still wants them."""

import os
import subprocess
import sys
import time

import pytest

from harness.runs.lease import GONE, Lease, Watch

HOLD = """
import sys, time
from pathlib import Path
from harness.runs.lease import Lease
held = Lease(Path(sys.argv[1]))
print(held.path, flush=True)
time.sleep(600)
"""
RETURN = """
import sys
from pathlib import Path
from harness.runs.lease import while_held
print(while_held(Path(sys.argv[1]), lambda a, b: a - b, 5, b=2))
"""
WORK = """
import sys, threading
from pathlib import Path
from harness.engines.child import run_child
from harness.runs.lease import while_held

def engine(folder):
    return run_child(["sh", "-c", "echo begun > ../begun; sleep 600"], folder=folder, log="log", time_limit=600)

def reader(folder):
    (folder / "../begun").touch()
    threading.Event().wait(1.0)
    (folder / "kept").touch()

def nothing(folder):
    pass

folder = Path(sys.argv[1]).parent / "run"
folder.mkdir()
while_held(Path(sys.argv[1]), globals()[sys.argv[2]], folder)
(folder / "../begun").touch()
threading.Event().wait()  # for the next task
"""


@pytest.fixture
def lease(tmp_path):
    held = Lease(tmp_path)
    yield held
    held.release()


def started(script, *arguments):
    return subprocess.Popen([sys.executable, "-c", script, *arguments], stdout=subprocess.PIPE, text=True)


def test_a_lease_is_seen_until_it_is_released(lease):
    watch = Watch(lease.path)
    assert not watch.gone()
    assert not Watch(lease.path).gone()
    lease.release()
    assert watch.gone()
    lease.release()


def test_a_killed_harness_holds_nothing(tmp_path):
    harness = started(HOLD, tmp_path)
    path = tmp_path / harness.stdout.readline().strip()
    watch = Watch(path)
    assert not watch.gone()
    harness.kill()
    harness.communicate(timeout=60)
    assert path.exists()
    assert watch.gone()


def test_what_a_killed_harness_left_goes_with_the_next(lease, tmp_path):
    names = (f"{lease.path.stem}-new.lock", f"{lease.path.stem}-old.lock", "harness@some-other-node@old.lock")
    new, old, elsewhere = (tmp_path / name for name in names)
    for path in (new, old, elsewhere):
        path.touch()
    for path in (old, elsewhere, lease.path):
        os.utime(path, (0.0, 0.0))
    Lease(tmp_path).release()
    assert not old.exists()
    assert all(path.exists() for path in (new, elsewhere, lease.path))


def test_of_another_machine_a_free_lock_tells_something_only_after_it_was_seen_held(lease, tmp_path):
    _, _, unique = lease.path.name.split("@")
    elsewhere = tmp_path / f"harness@some-other-node@{unique}"
    elsewhere.hardlink_to(lease.path)
    watch = Watch(elsewhere)
    assert not watch.gone()
    lease.release()
    assert watch.gone()
    never_seen_held = Watch(elsewhere)
    assert not never_seen_held.gone()
    elsewhere.unlink()
    assert never_seen_held.gone()


def test_what_is_done_while_it_is_held_comes_back(lease):
    worker = started(RETURN, lease.path)
    assert worker.communicate(timeout=60) == ("3\n", None)
    assert worker.returncode == 0


@pytest.mark.parametrize(("task", "kept"), [("engine", False), ("reader", True), ("nothing", False)])
def test_a_worker_ends_with_its_engine_keeps_what_it_reads_and_waits_for_no_other_task(task, kept, lease, tmp_path):
    worker = started(WORK, lease.path, task)
    while not (tmp_path / "begun").exists():
        assert worker.poll() is None
        time.sleep(0.01)
    lease.release()
    worker.communicate(timeout=60)
    assert worker.returncode == GONE
    assert (tmp_path / "run" / "kept").exists() == kept
