"""Cost, versions and machines: means of what was measured, and no column that nobody measured."""

import msgspec
import pytest

from harness.report.cost import cost_rows, host_rows, version_rows


def test_cost_is_a_mean_over_the_completed_runs(ran):
    runs = [
        ran("a", 0, cpu_seconds=2.0, steps=1000, wall_seconds=3.0, timings={"run": 1.0, "read": 0.25, "write": 0.25}),
        ran("a", 1, cpu_seconds=4.0, steps=1000, wall_seconds=5.0, timings={"run": 2.0, "read": 0.5}, load_average=1e6),
        ran("a", 2, status="crashed", cpu_seconds=100.0), ran("b", cpu_seconds=1.5, steps=1000, timings={"run": 1.5}),
        ran("c", status="unavailable"),
    ]
    a, b = cost_rows(runs)
    assert (a["engine"], a["runs"], a["CPU (s)"], a["CPU over the least"]) == ("a", 2, 3.0, 2.0)
    assert (a["clock (s)"], a["steps, CPU (s)"]) == (4.0, 1.5)
    assert (a["harness, clock (s)"], a["load"]) == (0.5, 1e6)
    assert (b["CPU over the least"], b["harness, clock (s)"]) == (1.0, None)
    for untold in ("before the steps, CPU (s)", "output, CPU (s)", "CPU per step (us)"):
        assert untold not in a, "nobody told the start apart from the steps"


def test_a_step_is_told_without_the_start_and_in_processor_time(ran):
    """A clock of the processor, one of the wall on a machine that was half as fast, and a run that is all start."""
    clock, wall, start = cost_rows([
        ran("a", cpu_seconds=2.0, steps=1000, wall_seconds=3.0, timings={"setup": 0.3, "run": 1.0, "output": 0.2}),
        ran("b", cpu_seconds=2.0, steps=1000, wall_seconds=4.0, timings={"setup": 1.0, "run": 3.0}),
        ran("c", cpu_seconds=2.0, steps=1000, wall_seconds=2.0, timings={"setup": 1.95, "run": 0.05}),
    ])
    assert [r["CPU per step (us)"] for r in (clock, wall, start)] == [pytest.approx(1e3), pytest.approx(1.5e3), None]
    assert clock["before the steps, CPU (s)"] == pytest.approx(0.8), "what is neither steps nor output"
    assert (wall["before the steps, CPU (s)"], wall["steps, CPU (s)"]) == (pytest.approx(0.5), pytest.approx(1.5))
    assert (clock["output, CPU (s)"], wall["output, CPU (s)"]) == (pytest.approx(0.2), None)
    for row in (clock, wall):
        parts = [row[f"{p}, CPU (s)"] or 0.0 for p in ("before the steps", "steps", "output")]
        assert sum(parts) == pytest.approx(row["CPU (s)"])


def test_nothing_completed_costs_nothing_that_is_known(ran):
    assert cost_rows([ran("a", status="crashed")]) == []


def test_versions_are_one_row_each_with_what_is_partial(ran):
    a, again = ran("a", partial=("rolling",)), ran("a", 1, partial=("torsion",))
    rows = version_rows([a, again, ran("b", engine_version="")])
    assert [(r["engine"], r["version"], r["computed in part"]) for r in rows] == [
        ("a", "1.0", "rolling, torsion"), ("b", None, None)]


def test_machines_are_counted(ran):
    here = ran("a")
    there = msgspec.structs.replace(here.outcome.host, cpu_model="other")
    rows = host_rows([here, ran("b"), ran("b", 1, host=there)])
    assert [(r["CPU"] == "other", r["runs"]) for r in rows] == [(False, 2), (True, 1)]
