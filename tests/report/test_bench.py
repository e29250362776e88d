"""The bench report from times that are known."""

import csv
import json

import numpy as np
import pytest

from harness.report.bench import bench_answer, bench_data, exact_tables, shown_tables, write_bench
from harness.runs.outcome import Host
from harness.studies.bench.cases import find_case
from harness.studies.bench.measure import Effort, Track
from harness.studies.bench.packing import BenchPacking
from harness.studies.bench.study import Bench, Cell

SIZES = (1000, 4000, 16_000)
LOUD = np.array([1.0, 3.0, 2.0])
"""How busy the machine was in each round."""


def track(seconds: float, **facts) -> Track:
    return Track(status="timed", seconds=seconds * LOUD, steps=40, off=1e-12, facts=facts)


def cell(case: str, count: int, **tracks) -> Cell:
    """A kernel that needs 50 ns a particle, LAMMPS 100 ns; both have libraries of 30 MB."""
    packing = BenchPacking(x=np.zeros((4, 2)), radius=np.ones(4), box=np.array([4.0, 4.0]), contacts=2.0,
                           unbalanced=1e-3)
    kernel = track(5e-8 * count, held=700 * count, peak=800 * count, resident=30_000_000 + 900 * count, rebuilds=4)
    lammps = track(1e-7 * count, resident=30_000_000 + 300 * count)
    return Cell(case=find_case(case), count=count, packing=packing, load=1.5, steps_made=200, seconds=3.0,
                tracks={"kernel": kernel, "lammps": lammps, **tracks})


@pytest.fixture
def made():
    def made(*cells, **changes):
        host = Host(cpu_model="CPU <1>", cores=2, os="os", python="3", numpy="2")
        fields = {
            "quick": True, "cells": cells, "skipped": {"2D friction, rolling": "no operations"}, "kernel": "kernel",
            "left_out": (("2D friction", 20_000), ("2D friction", 50_000)),
            "others": ("textbook", "lammps"), "notes": {"kernel": "program", "textbook": "plain", "lammps": "pair"},
            "versions": {"kernel": "1", "lammps": "2"}, "host": host, "core": 1,
            "effort": Effort(rounds=3, seconds=0.1),
        }
        return Bench(**(fields | changes))

    return made


@pytest.fixture
def whole(made):
    """Three sizes, the base beside each, and a textbook that fails at one of them."""
    lost = Track(status="lost", reason="ended by SIGKILL")
    extra = {"kernel, 2D elastic": track(2e-5)}
    return made(*(cell("2D dashpot", n, **extra, textbook=lost if n == 4000 else track(1e-7 * n)) for n in SIZES))


def test_ratios_are_free_of_the_machines_moods(whole):
    rows = [r for r in exact_tables(whole)["ratios"] if r["over"] == "lammps"]
    assert [r["N"] for r in rows] == list(SIZES)
    assert all(r[k] == pytest.approx(0.5) for r in rows for k in ("median", "low", "high"))


def test_an_effect_is_the_kernel_over_the_kernel_in_the_base(whole):
    rows = exact_tables(whole)["effects"]
    assert [(r["case"], r["over"]) for r in rows] == [("2D dashpot", "2D elastic")] * 3
    assert [r["median"] for r in rows] == pytest.approx([2.5, 10.0, 40.0])


def test_cost_and_memory_grow_as_they_were_made_to(whole):
    tables = exact_tables(whole)
    assert {r["code"]: r["p"] for r in tables["exponents"]} == pytest.approx({"kernel": 1.0, "lammps": 1.0})
    memory = {r["code"]: r for r in tables["memory"]}
    assert memory["kernel"]["held"] == pytest.approx(700.0)
    assert memory["kernel"]["peak"] == pytest.approx(800.0)
    assert memory["kernel"]["resident"] == pytest.approx(900.0)
    assert memory["lammps"]["resident"] == pytest.approx(300.0)
    assert memory["lammps"]["held"] is None


def test_what_was_not_timed_is_named_and_has_no_number(whole):
    rows = exact_tables(whole)["not_timed"]
    assert {(r["case"], r["code"], r["status"], r["N"], r["reason"]) for r in rows} == {
        ("2D friction, rolling", "all", "skipped", None, "no operations"),
        ("2D friction", "all", "left out", "20000, 50000", "the time was up"),
        ("2D dashpot", "textbook", "lost", "4000", "ended by SIGKILL"),
    }
    assert [r["textbook"] for r in shown_tables(whole)["ratios"]] == ["0.50 (0.50-0.50)", None, "0.50 (0.50-0.50)"]
    assert [r["textbook"] for r in shown_tables(whole)["times"]] == pytest.approx([200.0, None, 3200.0])


def test_tables_have_the_same_columns_in_every_row(whole):
    for tables in (shown_tables(whole), exact_tables(whole)):
        for name, rows in tables.items():
            assert all(r.keys() == rows[0].keys() for r in rows), name


def test_the_files_hold_the_same_numbers(whole, tmp_path):
    page = write_bench(whole, tmp_path)
    data = json.loads((tmp_path / "bench.json").read_text())
    with open(tmp_path / "ratios.csv") as file:
        rows = list(csv.DictReader(file))
    assert [float(r["median"]) for r in rows] == [r["median"] for r in data["tables"]["ratios"]]
    assert len(data["tables"]["rounds"]) == 3 * (3 * 4 - 1)
    html = page.read_text()
    assert f"--out {tmp_path}" in html
    assert "CPU &lt;1&gt;" in html
    assert "0.50 (0.50-0.50)" in html
    assert html.count("<img ") == 1
    assert (tmp_path / "bench.png").read_bytes().startswith(b"\x89PNG")


def test_one_size_is_no_curve(made, tmp_path):
    write_bench(made(cell("2D elastic", 100)), tmp_path)
    assert not (tmp_path / "bench.png").exists()
    assert "<img " not in (tmp_path / "bench.html").read_text()


def test_a_kernel_that_was_lost_leaves_no_ratio(made, tmp_path):
    lost = Track(status="lost", reason="gone")
    bench = made(*(cell("2D elastic", n, kernel=lost) for n in SIZES))
    write_bench(bench, tmp_path)
    assert exact_tables(bench)["ratios"] == []
    assert bench_data(bench)["exit_status"] == 1


def test_times_of_a_thousand_and_more_are_whole_numbers(whole):
    assert [r["kernel"] for r in shown_tables(whole)["times"]] == pytest.approx([100.0, 400.0, 1600])
    assert isinstance(shown_tables(whole)["times"][2]["kernel"], int)


def test_the_command_prints_writes_and_exits_as_the_study_says(whole, tmp_path, monkeypatch, capsys):
    from harness.cli import main

    asked = {}
    monkeypatch.setattr("harness.studies.bench.bench", lambda **options: asked.update(options) or whole)
    assert main(["bench", "--quick", "--out", str(tmp_path / "b"), "--json", str(tmp_path / "b.json")]) == 1
    assert asked["quick"] is True
    printed = capsys.readouterr().out
    for title in bench_answer(whole).tables:
        assert title in printed
    assert "bench.html" in printed
    assert json.loads((tmp_path / "b.json").read_text())["tables"]["ratios"]
    assert main(["bench", "--json", "-", "--out", str(tmp_path / "b")]) == 1
    assert json.loads(capsys.readouterr().out)["quick"] is True
