"""The cores that runs share: as many at a time as there are, and each run on its own."""

import os
import threading
from concurrent.futures import ThreadPoolExecutor

import pytest

from harness.runs import cores as module
from harness.runs.cores import Cores, cores_for

linux = pytest.mark.skipif(not hasattr(os, "sched_setaffinity"), reason="no affinities here")


def crowd(cores: Cores, counts, workers=6):
    """Let runs of so many processes take their cores; return those in use at every taking."""
    used, seen, lock = set(), [], threading.Lock()

    def run(count):
        with cores.taken(count) as ours:
            with lock:
                assert not used & set(ours)
                used.update(ours)
                seen.append(len(used))
            threading.Event().wait(0.01)
            with lock:
                used.difference_update(ours)
        return len(ours)

    with ThreadPoolExecutor(workers) as pool:
        return list(pool.map(run, counts)), seen


def test_no_core_has_two_runs_and_all_are_used():
    got, seen = crowd(Cores(range(3), pin=False), [1, 2, 1, 3, 2, 1, 1, 2] * 3)
    assert got == [1, 2, 1, 3, 2, 1, 1, 2] * 3
    assert max(seen) == 3


def test_a_run_of_more_processes_than_cores_gets_all():
    assert crowd(Cores(range(2), pin=False), [5, 1])[0] == [2, 1]


def test_cores_come_back_after_an_error():
    cores = Cores(range(2), pin=False)
    with pytest.raises(ZeroDivisionError), cores.taken(2):
        raise ZeroDivisionError
    with cores.taken(2) as again:
        assert again == (0, 1)


@linux
def test_a_pinned_run_and_its_children_stay_on_their_core():
    import subprocess
    import sys

    before = os.sched_getaffinity(0)
    core = max(before)
    with Cores([core], pin=True).taken(1):
        assert os.sched_getaffinity(0) == {core}
        told = subprocess.run(
            [sys.executable, "-c", "import os; print(sorted(os.sched_getaffinity(0)))"], capture_output=True, text=True
        )
        assert told.stdout.strip() == f"[{core}]"
    assert os.sched_getaffinity(0) == before


@linux
@pytest.mark.parametrize(("load", "usable", "workers", "pinned"), [
    (0.1, 2, 2, True),      # the machine is ours and full
    (0.1, 4, 2, False),     # cores to spare
    (3.0, 2, 2, False),     # others are at work
    (0.1, 2, 4, False),     # more runs than cores
    (0.1, 1, 1, False),     # nothing to choose
])
def test_runs_are_pinned_when_they_fill_a_quiet_machine(load, usable, workers, pinned, monkeypatch):
    monkeypatch.setattr(module.os, "getloadavg", lambda: (load, 0.0, 0.0))
    monkeypatch.setattr(module, "_usable", lambda: list(range(usable)))
    assert cores_for(workers)._pin == pinned
