"""compare() on engines that complete, crash, hang, are missing or refuse; what is kept and reused."""

import pytest

from harness.errors import InputError
from harness.studies.compare import compare

LIMIT = 60.0


def statuses(comparison):
    return {r.engine: r.outcome.status for r in comparison.runs}


def test_all_complete_and_agree(flight, obedient, tmp_path):
    comparison = compare(flight, (obedient("a"), obedient("b")), tmp_path / "out", time_limit=LIMIT)
    assert statuses(comparison) == {"a": "completed", "b": "completed"}
    assert {c.verdict for c in comparison.checks if c.left != "-"} == {"agrees"}
    assert comparison.exit_status == 0
    assert len(comparison.completed) == 2
    assert all(r.folder.is_relative_to(tmp_path / "out" / "runs") for r in comparison.runs)


def test_a_second_call_runs_nothing(flight, obedient, tmp_path):
    first, second = (
        compare(flight, (obedient("a"), obedient("b")), tmp_path / "out", time_limit=LIMIT) for _ in range(2)
    )
    assert sorted(obedient.begun()) == ["a", "b"]
    assert [r.outcome for r in first.runs] == [r.outcome for r in second.runs]


def test_codes_that_differ_are_an_exit_status_of_one(flight, obedient, tmp_path):
    wrong = obedient("b", off=1e-6)
    comparison = compare(flight, (obedient("a"), wrong), tmp_path, time_limit=LIMIT)
    found = {c.quantity.split(",")[0]: c for c in comparison.checks if c.left == "a"}
    assert found["velocity"].verdict == found["displacement"].verdict == "differs"
    assert found["velocity"].deviation == pytest.approx(1e-6, rel=1e-5)
    assert found["spin"].verdict == "agrees"
    assert comparison.exit_status == 1


@pytest.mark.parametrize(("does", "status", "limit"), [("abort", "crashed", LIMIT), ("hang", "timed_out", 1.5)])
def test_a_run_that_fails_leaves_the_others_and_is_an_exit_status_of_one(
        flight, obedient, tmp_path, does, status, limit):
    engines = obedient("a"), obedient("b"), obedient("broken", does=does)
    comparison = compare(flight, engines, tmp_path, time_limit=limit)
    assert statuses(comparison) == {"a": "completed", "b": "completed", "broken": status}
    assert [c.verdict for c in comparison.checks if {c.left, c.right} == {"a", "b"}] == ["agrees"] * 3
    assert {c.verdict for c in comparison.checks if "broken" in (c.left, c.right)} == {"not_checked"}
    assert comparison.exit_status == 1


@pytest.mark.parametrize(("settings", "status"), [
    ({"available": False}, "unavailable"), ({"level": "unsupported"}, "unsupported"),
    ({"level": "known_wrong"}, "unsupported"),
])
def test_an_engine_that_is_not_there_fails_nothing_as_long_as_something_is_compared(
        flight, obedient, tmp_path, settings, status):
    absent = obedient("absent", **settings)
    three = compare(flight, (obedient("a"), obedient("b"), absent), tmp_path, time_limit=LIMIT)
    assert statuses(three)["absent"] == status
    assert three.exit_status == 0
    two = compare(flight, (obedient("a"), absent), tmp_path, time_limit=LIMIT)
    assert {c.verdict for c in two.checks} == {"not_checked"}
    assert two.exit_status == 1
    assert "absent" not in obedient.begun()


def test_one_engine_compares_nothing(flight, obedient, tmp_path):
    assert compare(flight, (obedient("a"),), tmp_path, time_limit=LIMIT).exit_status == 1


def test_the_kernel_is_judged_as_the_same_conventions(flight, obedient, tmp_path):
    comparison = compare(flight, (obedient("a"), obedient("kernel:a", off=1e-10)), tmp_path, time_limit=LIMIT)
    found = {c.quantity.split(",")[0]: c for c in comparison.checks if c.left == "a"}
    assert found["velocity"].tolerance == 1e-12
    assert found["velocity"].verdict == "differs"


def test_without_friction_the_kernel_is_run_once(flight, obedient, tmp_path):
    from harness.engines.registry import ENGINES

    text = flight.read_text()
    flight.write_text("\n".join(line for line in text.splitlines() if not line.startswith("sliding")))
    kernels = ENGINES["kernel:lammps"], ENGINES["kernel:liggghts"]
    comparison = compare(flight, (obedient("lammps"), *kernels), tmp_path, time_limit=LIMIT)
    assert [r.engine for r in comparison.runs] == ["lammps", "kernel:talk"]
    found = {c.quantity.split(",")[0]: c.verdict for c in comparison.checks if c.right == "kernel:talk"}
    assert found == {"displacement": "agrees", "velocity": "agrees", "spin": "not_checked"}  # nothing turns a disc


def test_a_wrong_scene_writes_nothing(flight, obedient, tmp_path):
    flight.write_text(flight.read_text().replace("radius = 1e-3", "radius = -1e-3", 1))
    with pytest.raises(InputError, match="radius"):
        compare(flight, (obedient("a"),), tmp_path / "out", time_limit=LIMIT)
    assert not (tmp_path / "out").exists()


class Told:
    """A progress display that writes down what it is told."""

    said: list

    def __init__(self, said):
        self.said = said

    def begin(self, labels, costs):
        self.said.append(("begin", tuple(labels), len(costs)))

    def running(self, job, fraction):
        pass

    def done(self, job, line):
        self.said.append(("done", job))

    def end(self):
        self.said.append("end")


def test_progress_hears_of_every_run(flight, obedient, tmp_path):
    said = []
    compare(flight, (obedient("a"), obedient("b")), tmp_path, time_limit=LIMIT, progress=lambda: Told(said))
    assert said[0] == ("begin", ("a", "b"), 2)
    assert said[-1] == "end"
    assert sorted(s for s in said[1:-1]) == [("done", 0), ("done", 1)]
