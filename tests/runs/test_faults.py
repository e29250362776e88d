"""Campaigns that are killed at random points, and campaigns with engines that fail in every way there is.

A killed harness is a forked process that ends without a last word: either at its n-th event (Python's audit events:
a file is opened, renamed or removed, a folder made, a process started), so that the kill falls between any two steps
on disk; or at a random moment by a timer, so that it falls inside a write of a library too.
"""

import re
import subprocess
import sys

import pytest

from harness.runs.folder import list_runs
from harness.runs.pool import run_many
from postproc.trajectory import read_trajectory

KILLS = 200

KILLED = """
import os, random, signal, time, json
from harness.runs.folder import list_runs
from harness.runs.pool import run_many
import h5py, postproc.trajectory

kills = int(mode)
engine = fake.FakeEngine(journal)
jobs = [(str(k), engine, fake.flight(vx=float(k))) for k in range(6)]

def campaign(end=lambda: None):
    end()
    run_many(jobs, folder, time_limit=600, workers=2)

def at_event(number):
    seen = [0]
    def count(event, _):
        if event in EVENTS:
            seen[0] += 1
            if seen[0] == number:
                os.kill(os.getpid(), signal.SIGKILL)
    sys.addaudithook(count)
    return seen

EVENTS = {"open", "os.rename", "os.remove", "os.mkdir", "os.rmdir", "subprocess.Popen", "shutil.rmtree", "fcntl.flock"}

def forked(work):
    pid = os.fork()
    if not pid:
        try:
            work()
            os._exit(0)
        except BaseException:
            import traceback
            traceback.print_exc()
            os._exit(1)
    return os.waitstatus_to_exitcode(os.waitpid(pid, 0)[1])

def finished():
    return {p.name: (p / "outcome.json").read_bytes() for p, outcome, _ in list_runs(folder) if outcome}

def measure():
    seen = at_event(0)
    start = time.monotonic()
    campaign()
    (root / "measured.json").write_text(json.dumps([seen[0], time.monotonic() - start]))

root.mkdir()
folder = root / "measured"
assert forked(measure) == 0
events, seconds = json.loads((root / "measured.json").read_text())
draw = random.Random(1)
done = campaigns = 0
while done < kills:
    folder = root / f"campaign{campaigns}"
    campaigns += 1
    before = {}
    while done < kills:
        if draw.random() < 0.5:
            number = draw.randint(1, events)
            status = forked(lambda: campaign(lambda: at_event(number)))
        else:
            delay = draw.uniform(1e-3, seconds)
            status = forked(lambda: campaign(lambda: signal.setitimer(signal.ITIMER_REAL, delay)))
        now = finished()
        assert before.items() <= now.items(), ("lost", set(before) - set(now))
        if status == 0:
            break
        assert status in (-signal.SIGKILL, -signal.SIGALRM), status
        done, before = done + 1, now
    assert forked(campaign) == 0
    assert before.items() <= finished().items() and len(finished()) == len(jobs)
print(json.dumps({"kills": done, "campaigns": campaigns, "events": events}))
"""


def killed(driver, root, journal, kills: int) -> subprocess.CompletedProcess:
    words = [sys.executable, "-c", driver.replace("engine = fake.FakeEngine(journal, mode)\n", "") + KILLED]
    return subprocess.run([*words, root, journal, str(kills)], capture_output=True, text=True, timeout=1200)


@pytest.mark.parametrize("kills", [20, pytest.param(KILLS, marks=pytest.mark.long)])
def test_nothing_finished_is_lost_and_nothing_unfinished_believed(driver, root, journal, kills, engine, make_system):
    said = killed(driver, root, journal, kills)
    assert said.returncode == 0, said.stderr[-2000:]
    assert f'"kills": {kills}' in said.stdout
    whole = [read_trajectory(d.folder / "trajectory.h5") for d in undisturbed(engine, make_system, root)]
    for campaign in root.glob("campaign*"):
        kept = {outcome.system_digest: path for path, outcome, _ in list_runs(campaign)}
        assert len(kept) == len(whole)
        for k, expected in enumerate(whole):
            got = read_trajectory(kept[make_system(vx=float(k)).digest()] / "trajectory.h5")
            assert got.steps == expected.steps
            assert all((a.particles["x"] == b.particles["x"]).all() for a, b in zip(got, expected, strict=True))


def undisturbed(engine, make_system, root):
    jobs = [(str(k), engine, make_system(vx=float(k))) for k in range(6)]
    return run_many(jobs, root / "undisturbed", time_limit=60, workers=2)


FAILS = {
    "exit": ("crashed", "exit status 3"),
    "SIGSEGV": ("crashed", "SIGSEGV"),
    "hang": ("timed_out", "time limit"),
    "full": ("crashed", "exit status 1"),
    "cut": ("crashed", "output cannot be read"),
    "short": ("crashed", ""),
    "nan": ("unstable", ""),
    "lost": ("unstable", ""),
}


def test_engines_that_fail_in_every_way_spoil_no_other_run(in_mode, make_system, root):
    modes = [m for pair in zip(FAILS, ["complete"] * len(FAILS), strict=True) for m in pair]
    jobs = [(f"{m} {k}", in_mode(m, name=f"fake-{m}"), make_system(vx=1.0 + k)) for k, m in enumerate(modes)]
    done = run_many(jobs, root, time_limit=2.0, workers=2)
    for mode, each in zip(modes, done, strict=True):
        status, reason = FAILS.get(mode, ("completed", ""))
        assert each.outcome.status == status, (mode, each.outcome.reason)
        assert re.search(reason, each.outcome.reason), mode
    (full,) = [d.outcome for d in done if d.label.startswith("full")]
    assert any("No space left" in line for line in full.last_lines)
