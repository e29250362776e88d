"""One frontier measured on the kernel, verdicts, the report and the table that scenes are warned with."""

import json
import math
import tomllib
from dataclasses import replace

import pytest

from harness.engines.registry import find_engine
from harness.report.frontier import frontier_answer, write_frontier, write_scene_table
from harness.report.frontier_tables import summary
from harness.runs.outcome import host_facts
from harness.studies.frontier import laws, packings
from harness.studies.frontier.packings import resting_system
from harness.studies.frontier.probe import growth
from harness.studies.frontier.study import Frontiers, measured_frontier
from harness.studies.frontier.summary import scene_rows
from postproc.snapshot import Columns, Snapshot
from postproc.trajectory import Trajectory


@pytest.fixture(scope="session")
def measured(tmp_path_factory):
    """The triangular lattice with dashpots, on the kernel."""
    folder = tmp_path_factory.mktemp("frontier")
    rest = resting_system(packings.TRIANGULAR, packings.TRIANGULAR.make(folder), laws.DASHPOT)
    return measured_frontier(
        find_engine("kernel:talk"), rest, folder / "runs", law=laws.DASHPOT.name, packing=packings.TRIANGULAR.name
    )


def test_measured_limit_is_the_exact_one(measured):
    assert measured.verdict == "agrees"
    assert abs(measured.deviation) < 0.01
    assert measured.stable < measured.exact < measured.unstable


def test_verdicts(measured):
    assert replace(measured, exact=1.06 * measured.measured).verdict == "differs"
    assert replace(measured, exact=None).verdict == "not_checked"
    assert replace(measured, linear=False).verdict == "not_checked"
    never = replace(measured, stable=None, exact=0.0)
    assert (never.measured, never.verdict) == (0.0, "agrees")
    assert replace(never, exact=1e-5).verdict == "differs"
    assert replace(measured, exact=0.0).verdict == "differs"


def whole(*found):
    return Frontiers(
        size="quick", found=found, skipped=(("lammps", "jkr", "random", "no"),), versions={"kernel:talk": "1"},
        host=host_facts(), wall_seconds=1.0,
    )


def test_exit_status(measured):
    assert whole(measured).exit_status == 0
    assert whole(measured, replace(measured, stable=None, unstable=None)).exit_status == 1
    assert whole(replace(measured, exact=None)).exit_status == 1
    assert whole(measured, replace(measured, exact=2 * measured.exact)).exit_status == 1


def test_report(measured, tmp_path):
    along = [replace(measured, axis="k_t/k_n", value=v) for v in (0.1, 1.0)]
    done = whole(measured, *along)
    page = write_frontier(done, tmp_path)
    assert "triangular lattice" in page.read_text()
    assert json.loads((tmp_path / "frontier.json").read_text())["words"] == summary(done)
    assert len((tmp_path / "frontier_map.csv").read_text().splitlines()) == 3
    assert frontier_answer(done).tables["Map"][0]["varied"] == "k_t/k_n"


def test_table_of_scenes_takes_the_worst_of_a_kind(measured, tmp_path):
    worse = replace(measured, stable=0.9 * measured.stable, unstable=0.9 * measured.unstable, packing="worse")
    done = whole(measured, worse)
    (row,) = scene_rows(done)
    assert (row["count"], row["normal"], row["sliding"]) == (2, "linear", "")
    assert row["of_formula"] == pytest.approx(worse.measured / worse.formula)
    assert "worse" in row["where"]
    write_scene_table(done, tmp_path / "t.toml", day="2026-01-02")
    table = tomllib.loads((tmp_path / "t.toml").read_text())
    assert table["date"] == "2026-01-02"
    assert table["measured"][0]["of_formula"] == pytest.approx(row["of_formula"], rel=1e-3)
    assert "--table" in table["command"]


def test_growth_of_the_kinetic_energy():
    def frame(speed, spin):
        columns = {"vx": [speed], "vy": [0.0], "wz": [spin], "mass": [2.0], "inertia": [8.0]}
        return Snapshot(time=0.0, dimension=2, particles=Columns(columns, "particles"), walls=None, contacts=None)

    def of(*frames):
        return growth(Trajectory(frames=frames, steps=tuple(range(len(frames))), series=None))

    assert of(frame(1.0, 0.0), frame(3.0, 0.0), frame(2.0, 0.0)) == 9.0
    assert of(frame(1.0, 0.0), frame(0.0, 1.0)) == 4.0
    assert of(frame(1.0, 0.0), frame(math.nan, 0.0)) == math.inf
