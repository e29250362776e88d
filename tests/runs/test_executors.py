"""executorlib behind run_many: its local mode as it is, Slurm's step launcher as a script that starts what it gets."""

import importlib.util
import os
import re
import shutil
import signal
import subprocess
import sys
import threading
import time
from concurrent.futures import BrokenExecutor, Future, ThreadPoolExecutor
from pathlib import Path
from types import SimpleNamespace

import pytest

from harness.engines.registry import ENGINES, find_engine
from harness.errors import InputError
from harness.runs.executors import CACHE, MARGIN, InTurn, executor, request
from harness.runs.folder import list_runs
from harness.runs.lease import Lease
from harness.runs.pool import run_many

KERNEL = ENGINES["kernel:talk"]
SRUN = """#!/bin/sh
printf '%s\\n' "$*" >> {log}
while [ $# -gt 0 ]; do
  case "$1" in
    -n|-D|-N) shift 2 ;;
    -*) shift ;;
    *) break ;;
  esac
done
exec "$@"
"""


@pytest.fixture(autouse=True)
def _installed():
    pytest.importorskip("executorlib")


def test_a_run_asks_for_its_processes_and_its_time():
    assert request(KERNEL, 100.0) == {"cores": 1, "threads_per_core": 1, "run_time_max": int(100 + MARGIN)}
    assert request(find_engine("lammps:ranks=3"), None) == {"cores": 1, "threads_per_core": 3}


def test_no_name_is_no_executor(tmp_path):
    with executor(None, tmp_path) as none:
        assert none is None
    assert not list(tmp_path.iterdir())


def test_without_executorlib_there_is_one_line(tmp_path, monkeypatch):
    monkeypatch.setitem(sys.modules, "executorlib", None)
    with pytest.raises(InputError, match=r"--executor: expected executorlib, got none installed; pip install"):
        executor("local", tmp_path)


@pytest.mark.parametrize(("inside", "command"), [(False, "sbatch"), (True, "srun")])
def test_without_slurm_there_is_one_line(inside, command, tmp_path, monkeypatch):
    monkeypatch.setenv("PATH", str(tmp_path))
    monkeypatch.delenv("SLURM_JOB_ID", raising=False)
    if inside:
        monkeypatch.setenv("SLURM_JOB_ID", "1")
    with pytest.raises(InputError, match=f"Slurm's {command} on the path"):
        executor("slurm", tmp_path)


def made(jobs, tmp_path, kind):
    with executor(kind, tmp_path) as pool:
        return run_many(jobs, tmp_path / "runs", time_limit=60.0, executor=pool)


def test_local_runs_are_made_kept_and_reused(make_system, tmp_path):
    jobs = [(str(n), KERNEL, make_system(steps=6 * n)) for n in (1, 2)]
    first, again = made(jobs, tmp_path, "local"), made(jobs, tmp_path, "local")
    assert [d.outcome.status for d in first] == ["completed"] * 2
    assert all(d.folder.is_dir() for d in first)
    assert [d.outcome for d in again] == [d.outcome for d in first]
    assert not list((tmp_path / CACHE).iterdir())


def test_only_run_folders_say_what_is_finished(make_system, tmp_path):
    """A run that was deleted is made again, though executorlib may have kept what came of it."""
    jobs = [("one", KERNEL, make_system(steps=6))]
    (tmp_path / CACHE).mkdir()
    (tmp_path / CACHE / "run_one0_o.h5").touch()
    (first,) = made(jobs, tmp_path, "local")
    shutil.rmtree(first.folder)
    (again,) = made(jobs, tmp_path, "local")
    assert again.outcome.status == "completed"
    assert again.folder.is_dir()
    assert again.outcome.started > first.outcome.finished
    assert not list((tmp_path / CACHE).iterdir())


@pytest.fixture
def stand_in(tmp_path, monkeypatch):
    """An allocation of two cores with a step launcher that starts what it gets; returns what it was asked."""
    tools = tmp_path / "tools"
    tools.mkdir()
    srun, log = tools / "srun", tmp_path / "srun.log"
    srun.write_text(SRUN.format(log=log))
    srun.chmod(0o755)
    monkeypatch.setenv("PATH", f"{tools}{os.pathsep}{os.environ['PATH']}")
    monkeypatch.setenv("SLURM_JOB_ID", "1")
    monkeypatch.setenv("SLURM_NTASKS", "2")
    monkeypatch.setenv("SLURM_CPUS_PER_TASK", "1")
    assert shutil.which("srun") == str(srun)
    return log


@pytest.mark.parametrize("ranks", [1, 2])
def test_steps_of_an_allocation_ask_for_what_they_need(ranks, make_system, tmp_path, stand_in):
    engine = KERNEL if ranks == 1 else find_engine("lammps:ranks=2")
    if not engine.probe().available:
        pytest.skip(engine.probe().detail)
    (done,) = made([("one", engine, make_system(steps=6))], tmp_path, "slurm")
    assert done.outcome.status == "completed", done.outcome
    asked = stand_in.read_text()
    assert "-n 1" in asked
    assert f"--cpus-per-task={ranks}" in asked
    assert f"--time={int(60 + MARGIN) // 60 + 1}" in asked


SBATCH = """#!/bin/sh
# takes a job as Slurm does: no empty partition, a time, a folder to be in; then runs it
grep -q '^#SBATCH --partition=$' "$2" && {{ echo 'sbatch: error: invalid partition specified' >&2; exit 1; }}
cat "$2" >> {log}
setsid sh "$2" > /dev/null 2>&1 &
echo 7
"""


def test_jobs_of_a_queue_ask_for_what_they_need(make_system, tmp_path, monkeypatch):
    """Tried on a real Slurm 22.05 of one node, too; this stand-in refuses what that one refused."""
    pytest.importorskip("pysqa", reason="executorlib asks queues through pysqa, which the extra `cluster` installs")
    tools, log = tmp_path / "tools", tmp_path / "sbatch.log"
    tools.mkdir()
    for name, text in {"sbatch": SBATCH.format(log=log), "squeue": "#!/bin/sh\necho '7|me|R|grainproof|/'\n"}.items():
        (tools / name).write_text(text)
        (tools / name).chmod(0o755)
    monkeypatch.setenv("PATH", f"{tools}{os.pathsep}{os.environ['PATH']}")
    monkeypatch.delenv("SLURM_JOB_ID", raising=False)
    (done,) = made([("one", KERNEL, make_system(steps=6))], tmp_path, "slurm")
    assert done.outcome.status == "completed", done.outcome
    asked = log.read_text()
    assert "#SBATCH --ntasks=1\n" in asked
    assert f"#SBATCH --time={int(60 + MARGIN) // 60}\n" in asked


def test_without_pysqa_there_is_one_line(tmp_path, monkeypatch):
    monkeypatch.setattr(shutil, "which", lambda name: f"/usr/bin/{name}")
    monkeypatch.setattr(importlib.util, "find_spec", lambda name: None)
    monkeypatch.delenv("SLURM_JOB_ID", raising=False)
    with pytest.raises(InputError, match=r"--executor: expected pysqa, .*, got none installed; pip install"):
        executor("slurm", tmp_path)


class Losing(ThreadPoolExecutor):
    """An executor whose second worker is killed."""

    def submit(self, fn, /, engine, system, *args, **options):
        if system.steps == 12:
            future = Future()
            future.set_exception(BrokenExecutor("a process was killed"))
            return future
        return super().submit(fn, engine, system, *args, **options)


def test_a_lost_worker_is_the_outcome_of_its_run_only(make_system, tmp_path):
    jobs = [(str(n), KERNEL, make_system(steps=6 * n)) for n in (1, 2, 3)]
    with Losing(1) as pool:
        done = run_many(jobs, tmp_path, time_limit=60.0, executor=pool)
    assert [d.outcome.status for d in done] == ["completed", "crashed", "completed"]
    assert done[1].outcome.reason == "whoever made this run is gone: a process was killed"
    again = run_many(jobs, tmp_path, time_limit=60.0)
    assert [d.outcome.status for d in again] == ["completed"] * 3


RUN_MANY = """
import cloudpickle
from harness.runs.executors import executor
from harness.runs.pool import run_many
cloudpickle.register_pickle_by_value(fake)
jobs = [(str(k), engine, fake.flight(vx=float(k))) for k in range(4)]
with executor(sys.argv[4], root.parent) as pool:
    run_many(jobs, root, time_limit=600, executor=pool)
"""


@pytest.mark.parametrize(("kind", "number", "code"), [
    ("local", signal.SIGINT, -signal.SIGINT), ("local", signal.SIGTERM, 128 + signal.SIGTERM),
    ("local", signal.SIGKILL, -signal.SIGKILL), ("slurm", signal.SIGTERM, 128 + signal.SIGTERM),
])
def test_an_interrupted_or_killed_harness_leaves_nothing_that_runs_and_goes_on_when_called_again(
        driver, engine, make_system, root, journal, begun, stand_in, kind, number, code):
    harness = subprocess.Popen([sys.executable, "-c", driver + RUN_MANY, root, journal, "hang", kind],
                               stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    wait_for(begun)
    engines = [int(pid) for pid in re.findall(r"begin (\d+)", journal.read_text())]
    workers = [parent(pid) for pid in engines]
    os.kill(harness.pid, number)
    _, errors = harness.communicate(timeout=60)
    assert harness.returncode == code, errors
    engines += [int(pid) for pid in re.findall(r"begin (\d+)", journal.read_text())]
    wait_for(lambda: not any(computes(pid) for pid in [*engines, *workers]))
    assert {note for _, _, note in list_runs(root)} == {"unfinished"}
    jobs = [(str(k), engine, make_system(vx=float(k))) for k in range(4)]
    again = run_many(jobs, root, time_limit=60.0)
    assert [d.outcome.status for d in again] == ["completed"] * 4


def parent(pid):
    return int(Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()[1])


def computes(pid):
    """Is the process there, and no zombie that its new parent has yet to bury?"""
    try:
        return Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()[0] != "Z"
    except FileNotFoundError:
        return False


def wait_for(condition):
    deadline = time.monotonic() + 60
    while not condition():
        assert time.monotonic() < deadline, "waited for a minute in vain"
        time.sleep(0.01)


class Plain(ThreadPoolExecutor):
    """An executor of threads that takes a request, and the lease of a run, for granted."""

    def submit(self, while_held, path, fn, /, *args, resource_dict, **options):
        assert while_held.__name__ == "while_held"
        assert path.exists()
        return super().submit(fn, *args, **options)


@pytest.fixture
def in_turn(tmp_path):
    with InTurn(Plain(9), cores=2, lease=Lease(tmp_path)) as pool:
        yield pool


def engine_of(ranks):
    return SimpleNamespace(ranks=ranks)


def test_runs_wait_for_their_cores(in_turn):
    at_work, most, lock = [], [], threading.Lock()

    def work(engine, *, time_limit):
        with lock:
            at_work.append(min(engine.ranks, 2))
            most.append(sum(at_work))
        time.sleep(0.02)
        with lock:
            at_work.remove(min(engine.ranks, 2))
        return engine.ranks

    asked = [1, 1, 2, 1, 7, 1, 1]
    runs = [in_turn.submit(work, engine_of(ranks), time_limit=1.0) for ranks in asked]
    assert [run.result(60) for run in runs] == asked
    assert max(most) == 2


def test_what_is_cancelled_is_never_handed_on(in_turn):
    begun, go = [], threading.Event()

    def work(engine, *, time_limit):
        begun.append(engine)
        go.wait(60)

    runs = [in_turn.submit(work, engine_of(2), time_limit=1.0) for _ in range(3)]
    wait_for(lambda: begun)
    assert [run.cancel() for run in runs] == [False, True, True]
    go.set()
    in_turn.shutdown()
    assert len(begun) == 1


def test_errors_come_back_wherever_they_are_met(in_turn):
    def work(engine, *, time_limit):
        raise ZeroDivisionError

    fails = in_turn.submit(work, engine_of(1), time_limit=1.0)
    assert isinstance(fails.exception(60), ZeroDivisionError)
    in_turn.stop()  # nothing can be begun without the lease
    assert isinstance(in_turn.submit(work, engine_of(1), time_limit=1.0).exception(60), AssertionError)
