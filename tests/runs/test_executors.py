"""executorlib behind run_many: its local mode as it is, Slurm's step launcher as a script that starts what it gets."""

import os
import shutil
import sys

import pytest

from harness.engines.registry import ENGINES, find_engine
from harness.errors import InputError
from harness.runs.executors import MARGIN, executor, request
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


@pytest.mark.parametrize("ranks", [1, 2])
def test_steps_of_an_allocation_ask_for_what_they_need(ranks, make_system, tmp_path, monkeypatch):
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
    engine = KERNEL if ranks == 1 else find_engine("lammps:ranks=2")
    if not engine.probe().available:
        pytest.skip(engine.probe().detail)
    (done,) = made([("one", engine, make_system(steps=6))], tmp_path, "slurm")
    assert done.outcome.status == "completed", done.outcome
    asked = log.read_text()
    assert "-n 1" in asked
    assert f"--cpus-per-task={ranks}" in asked
    assert f"--time={int(60 + MARGIN) // 60 + 1}" in asked
