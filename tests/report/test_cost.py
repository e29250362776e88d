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
    assert (a["CPU per step (us)"], a["elapsed (s)"], a["run (s)"]) == (pytest.approx(3000.0), 4.0, 1.5)
    assert (a["harness (s)"], a["load"]) == (0.5, 1e6)
    assert (b["CPU over the least"], b["harness (s)"]) == (1.0, None)
    assert "setup (s)" not in a
    assert "output (s)" not in a


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
