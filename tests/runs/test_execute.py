import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest

from harness.engines.protocol import Support
from harness.runs.execute import each_once, run_one, same_trajectory
from harness.runs.folder import list_runs
from harness.runs.outcome import describe_outcome, read_outcome
from postproc.trajectory import read_trajectory, write_trajectory

LIMIT = 60.0


def test_completed_run_keeps_everything(engine, system, root):
    outcome, folder = run_one(engine, system, root, time_limit=LIMIT)
    assert (outcome.status, outcome.reason) == ("completed", "")
    assert outcome == read_outcome(folder / "outcome.json")
    names = {p.name for p in folder.iterdir()}
    assert names == {"deck.json", "fake.py", "identity.json", "fake.log", "frames.jsonl", "series.txt",
                     "trajectory.h5", "outcome.json"}
    assert (outcome.steps, outcome.steps_done, outcome.particles) == (12, 12, 2)
    assert (outcome.system_digest, outcome.particles_digest) == (system.digest(), system.particles_digest())
    assert {"run", "read", "write"} <= set(outcome.timings)
    assert outcome.cpu_seconds > 0
    assert outcome.started <= outcome.finished
    assert outcome.started.utcoffset().total_seconds() == 0


def test_the_trajectory_is_the_engines(engine, system, root):
    _, folder = run_one(engine, system, root, time_limit=LIMIT)
    trajectory = read_trajectory(folder / "trajectory.h5")
    assert trajectory.steps == (0, 3, 6, 9, 12)
    for step, frame in zip(trajectory.steps, trajectory, strict=True):
        exact = system.particles.x + system.particles.v * (step * system.dt)
        assert np.array_equal(frame.particles.vector("x", "y"), exact)


def test_finished_run_is_reused(engine, system, root, begun):
    first = run_one(engine, system, root, time_limit=LIMIT)
    assert run_one(engine, system, root, time_limit=LIMIT) == first
    assert begun() == 1
    assert run_one(engine, system, root, time_limit=LIMIT, force=True)[1] == first[1]
    assert begun() == 2


@pytest.mark.parametrize(("mode", "status", "reason"), [
    ("exit", "crashed", "exit status 3"),
    ("SIGSEGV", "crashed", "SIGSEGV"),
    ("SIGKILL", "crashed", "SIGKILL"),
    ("hang", "timed_out", "time limit"),
    ("cut", "crashed", "frames.jsonl: line 3"),
    ("short", "crashed", "4 series rows, the last at step 6; expected 7 up to step 12"),
    ("nan", "unstable", "step 6: particles x is nan in row 1"),
    ("lost", "unstable", "step 6: 1 particles of 2, lost: 2"),
    ("escape", "unstable", "step 6: particle 2 is 0.25 m behind wall 'floor'"),
])
def test_every_failure_is_an_outcome_with_logs_and_a_way_to_repeat_it(
        in_mode, system, root, begun, mode, status, reason):
    limit = 0.5 if mode == "hang" else LIMIT
    outcome, folder = run_one(in_mode(mode), system, root, time_limit=limit)
    assert outcome.status == status
    assert reason in outcome.reason
    assert (folder / "fake.log").exists()
    assert not (folder / "trajectory.h5").exists()
    assert outcome.trajectory is None
    assert read_outcome(folder / "outcome.json") == outcome
    assert describe_outcome(outcome).endswith(f"; reproduce: {outcome.reproduce}")
    assert run_one(in_mode(mode), system, root, time_limit=limit)[0].status == status
    assert begun() == 2  # a failure is not final
    assert run_one(in_mode("complete"), system, root, time_limit=LIMIT)[0].status == "completed"


def test_last_words_are_kept_and_the_command_repeats_the_failure(in_mode, system, root):
    outcome, _ = run_one(in_mode("exit"), system, root, time_limit=LIMIT)
    assert outcome.last_lines == ("ERROR: neighbour list overflow",)
    assert outcome.steps_done == 4
    again = subprocess.run(outcome.reproduce, shell=True, capture_output=True, text=True)
    assert (again.returncode, again.stdout) == (3, "ERROR: neighbour list overflow\n")


def test_one_reason_for_several_effects_is_said_once():
    notes = {"adhesion": "no law", "spin": "no", "memory": "no law"}
    supports = [Support(effect=e, level="unsupported", note=n) for e, n in notes.items()]
    assert each_once(supports) == ["adhesion, memory: unsupported: no law", "spin: unsupported: no"]


def test_unavailable_and_refused_run_nothing(in_mode, system, root, begun):
    absent, _ = run_one(in_mode("complete", available=False), system, root, time_limit=LIMIT)
    assert (absent.status, absent.reason) == ("unavailable", "install fake from nowhere")
    for level in ("unsupported", "known_wrong"):
        refused, folder = run_one(in_mode("complete", level=level), system, root, time_limit=LIMIT)
        assert refused.status == "unsupported"
        assert refused.reason == f"normal: {level.replace('_', ' ')}: see the manual"
        assert not folder.exists()
    assert begun() == 0


def test_partial_support_is_said(in_mode, system, root):
    outcome, _ = run_one(in_mode("complete", level="partial"), system, root, time_limit=LIMIT)
    assert outcome.partial == ("normal: partial: see the manual",)


def test_bugs_are_raised_and_leave_the_folder_unfinished(in_mode, system, root, begun):
    with pytest.raises(TypeError, match="a bug of the reader"):
        run_one(in_mode("bug"), system, root, time_limit=LIMIT)
    assert [note for _, _, note in list_runs(root)] == ["unfinished"]
    assert run_one(in_mode("complete"), system, root, time_limit=LIMIT)[0].status == "completed"
    assert begun() == 2


def flip(path):
    data = bytearray(path.read_bytes())
    data[len(data) // 2] ^= 1
    path.write_bytes(data)


def edit(folder, old, new):
    file = folder / "outcome.json"
    assert old in file.read_text()
    file.write_text(file.read_text().replace(old, new, 1))


@pytest.mark.parametrize(("damage", "said"), [
    (lambda f: (f / "trajectory.h5").unlink(), "trajectory.h5 is missing"),
    (lambda f: os.truncate(f / "trajectory.h5", 1000), "trajectory.h5 has 1000 bytes"),
    (lambda f: flip(f / "trajectory.h5"), "SHA-256 differs"),
    (lambda f: (f / "series.txt").unlink(), "series.txt is missing"),
    (lambda f: flip(f / "frames.jsonl"), "frames.jsonl is not what was written (SHA-256"),
    (lambda f: os.truncate(f / "fake.log", 0), "fake.log has 0 bytes"),
    (lambda f: flip(f / "deck.json"), "deck.json is not what was written"),
    (lambda f: os.truncate(f / "outcome.json", 100), "outcome.json is damaged"),
    (lambda f: edit(f, '"cpu_seconds": ', '"cpu_seconds": 1'), "outcome.json is not what was written (SHA-256"),
    (lambda f: edit(f, '"steps_done": 12', '"steps_done": 11'), "outcome.json is not what was written"),
    (lambda f: edit(f, '"sha256"', '"sha512"'), "outcome.json is damaged"),
])
def test_damage_is_reported_in_one_line_and_redone(engine, system, root, begun, caplog, damage, said):
    first, folder = run_one(engine, system, root, time_limit=LIMIT)
    damage(folder)
    assert said in list_runs(root)[0][2]
    outcome, again = run_one(engine, system, root, time_limit=LIMIT)
    assert (outcome.status, again, outcome.trajectory) == ("completed", folder, first.trajectory)
    assert begun() == 2
    assert len(caplog.messages) == 1
    assert said in caplog.messages[0]
    assert list_runs(root) == [(folder, outcome, "")]


@pytest.mark.parametrize(("damage", "said"), [
    (lambda f: flip(f / "deck.json"), "deck.json is not what was written (SHA-256 differs)"),
    (lambda f: (f / "deck.json").unlink(), "deck.json is missing"),
    (lambda f: (f / "identity.json").write_text("{}"), "identity.json has 2 bytes, "),
])
def test_a_deck_that_was_edited_is_not_taken_for_what_was_run(engine, system, root, begun, caplog, damage, said):
    _, folder = run_one(engine, system, root, time_limit=LIMIT)
    damage(folder)
    run_one(engine, system, root, time_limit=LIMIT)
    run_one(engine, system, root, time_limit=LIMIT)
    assert begun() == 2
    (line,) = caplog.messages
    assert line.startswith(f"{folder.name}: {said}")
    assert line.endswith("; run again")


def test_unfinished_folder_is_redone_from_clean(engine, system, root, begun, caplog):
    _, folder = run_one(engine, system, root, time_limit=LIMIT)
    (folder / "outcome.json").unlink()
    (folder / "stale").write_text("")
    run_one(engine, system, root, time_limit=LIMIT)
    assert begun() == 2
    assert not (folder / "stale").exists()
    (line,) = caplog.messages
    assert line == f"{folder.name}: outcome.json is missing, the run was not finished; run again"


def test_a_changed_deck_is_run_again(in_mode, system, root, begun, caplog):
    run_one(in_mode("complete"), system, root, time_limit=LIMIT)
    run_one(in_mode("complete", comment="better"), system, root, time_limit=LIMIT)
    assert begun() == 2
    assert "deck has changed" in caplog.text


@pytest.mark.parametrize(("policy", "left"), [
    ("gzip", {"dump.txt.gz"}), ("plain", {"dump.txt"}), ("drop", set()),
])
def test_large_dumps_follow_the_policy_and_the_run_stays_finished(in_mode, system, root, begun, policy, left):
    outcome, folder = run_one(in_mode("big"), system, root, time_limit=LIMIT, native=policy)
    assert {p.name for p in folder.glob("dump*")} == left
    assert ("dump.txt" in outcome.native) == (policy != "plain")
    run_one(in_mode("big"), system, root, time_limit=LIMIT)
    assert begun() == 1


def test_a_trajectory_that_does_not_read_back_is_never_kept(engine, system, root, monkeypatch):
    def lossy(path, trajectory):
        write_trajectory(path, type(trajectory)(frames=trajectory.frames[:-1], steps=trajectory.steps[:-1],
                                                series=trajectory.series))

    monkeypatch.setattr("harness.runs.execute.write_trajectory", lossy)
    with pytest.raises(RuntimeError, match="does not read back"):
        run_one(engine, system, root, time_limit=LIMIT)
    assert [note for _, _, note in list_runs(root)] == ["unfinished"]


def test_same_trajectory_sees_the_last_bit(engine, system, make_system, root):
    read = [read_trajectory(run_one(engine, s, root, time_limit=LIMIT)[1] / "trajectory.h5")
            for s in (system, make_system(vx=np.nextafter(1.5, 2)))]
    assert same_trajectory(read[0], read[0])
    assert not same_trajectory(*read)


RUN_ONE = """
from harness.runs.execute import run_one
print(run_one(engine, fake.flight(), root, time_limit=60)[0].status)
"""


def start(driver, root, journal, mode):
    return subprocess.Popen([sys.executable, "-c", driver + RUN_ONE, root, journal, mode],
                            stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)


def test_two_processes_on_one_cache_run_it_once(driver, root, journal, begun):
    both = [start(driver, root, journal, "slow") for _ in range(2)]
    said = [p.communicate(timeout=60) for p in both]
    assert [out for out, _ in said] == ["completed\n"] * 2
    assert begun() == 1
    assert [p.name for p in root.iterdir() if not p.name.startswith(".")] == [list_runs(root)[0][0].name]


def test_a_killed_harness_leaves_no_engine_behind_and_a_folder_that_is_redone(
        driver, engine, system, root, journal, begun):
    harness = start(driver, root, journal, "hang")
    wait_for(begun)
    orphan = int(journal.read_text().split()[1])
    os.kill(harness.pid, signal.SIGKILL)
    harness.communicate(timeout=60)
    wait_for(lambda: not computes(orphan))
    assert [note for _, _, note in list_runs(root)] == ["unfinished"]
    assert run_one(engine, system, root, time_limit=LIMIT)[0].status == "completed"
    assert begun() == 2


def test_an_engine_that_outlives_its_harness_writes_into_no_run_of_others(engine, system, root):
    """Where no guardian is, its open files go away with the old folder."""
    _, folder = run_one(engine, system, root, time_limit=LIMIT)
    with open(folder / "series.txt", "a") as orphans:
        (folder / "outcome.json").unlink()
        outcome, _ = run_one(engine, system, root, time_limit=LIMIT)
        orphans.write("13 nonsense\n")
    assert outcome.status == "completed"
    assert "nonsense" not in (folder / "series.txt").read_text()


def wait_for(condition):
    deadline = time.monotonic() + 60
    while not condition():
        assert time.monotonic() < deadline, "waited for a minute in vain"
        time.sleep(0.01)


def computes(pid):
    """Is the process there, and no zombie that its new parent has yet to bury?"""
    stat = Path(f"/proc/{pid}/stat")
    try:
        return stat.read_text().rpartition(")")[2].split()[0] != "Z"
    except FileNotFoundError:
        return False
