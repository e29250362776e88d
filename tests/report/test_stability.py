"""The report of the gauntlet from results that are known."""

import csv
import json
import math
import warnings
from dataclasses import replace
from pathlib import Path

import pytest

from harness.errors import InputError
from harness.report.figures import png_bytes
from harness.report.stability import NAMES, stability_answer, summary, write_stability
from harness.report.stability_figure import BEYOND, stability_figure
from harness.report.stability_tables import TABLES, note, outcome_table, tables
from harness.runs.outcome import Host
from harness.scene.expect import Expect, Invariant
from harness.studies.stability.cases import Case
from harness.studies.stability.judge import Held, Result
from harness.studies.stability.study import Stability

ENGINES = ("lammps", "kernel:talk")


def case(name, refused=None):
    kept = Invariant(name="energy", tolerance=1e-3, reason="second order")
    expect = Expect(topics=("alone",), why="it is hard", refused=refused, invariants=() if refused else (kept,))
    return Case(name=name, file=Path(f"{name}.toml"), expect=expect, title=f"Case {name}", scene=None, refusal="")


def held(size):
    return Held(invariant="energy", size=size, tolerance=1e-3, ruin=0.1, says="largest change of energy, relative")


def result(name, engine, ended, size=None, expected="stable", reason=""):
    return Result(
        case=name, engine=engine, ended=ended, reason=reason, expected=expected, known="", steps=100, seconds=0.5,
        held=() if size is None else (held(size),), reproduce=f"grainproof stability {name} --engines {engine}",
    )


@pytest.fixture
def made():
    results = (
        result("good", "lammps", "stable", 1e-4), result("good", "kernel:talk", "stable", 2e-4),
        result("bad", "lammps", "failed_silently", 0.5, reason="energy: <much> 0.5 > 0.001"),
        result("bad", "kernel:talk", "failed_loudly", reason="it stops", expected="failed_loudly"),
        *(result("none", engine, "refused", expected="refused") for engine in ENGINES),
    )
    host = Host(cpu_model="x", cores=1, os="x", python="3", numpy="2")
    return Stability(
        cases=(case("good"), case("bad"), case("none", "radius")), engines=ENGINES, results=results, host=host,
        wall_seconds=1.0,
    )


def test_everything_is_written_and_reads_back(made, tmp_path):
    page = write_stability(made, tmp_path)
    text = page.read_text()
    assert f"--out {tmp_path}" in text
    assert "bad on lammps" in text
    assert "&lt;much&gt;" in text
    assert "<much>" not in text
    assert (tmp_path / NAMES.pictures[0]).stat().st_size > 1000
    for name in TABLES:
        rows = list(csv.DictReader((tmp_path / f"{name}.csv").open()))
        assert len(rows) == len(tables(made)[name])
    data = json.loads((tmp_path / NAMES.data).read_text())
    assert data["surprises"] == [["bad", "lammps"]]
    assert data["exit_status"] == 1


def test_the_page_needs_no_other_file(made, tmp_path):
    text = write_stability(made, tmp_path).read_text()
    assert "data:image/png;base64," in text
    assert "src=\"http" not in text
    assert "<link" not in text


def test_what_is_not_as_declared_says_what_was(made):
    rows = outcome_table(made)
    assert rows[1]["lammps"] == "failed silently (declared stable)"
    assert rows[1]["kernel:talk"] == "failed loudly"


def test_beside_the_word_stands_what_broke_or_came_nearest(made):
    assert note(made.of("bad", "lammps")) == "energy 0.5 > 0.001"
    assert note(made.of("good", "lammps")) == "energy 0.0001 of 0.001"
    assert note(made.of("none", "lammps")) == ""


def test_the_line_counts_silent_failures(made):
    assert summary(made) == (
        "3 hard cases on lammps, kernel:talk: 1 ended otherwise than declared; "
        "one run failed without a word of the code"
    )


def test_the_figure_frames_what_is_not_as_declared(made):
    left, right = stability_figure(made).axes
    framed = [p for p in left.patches if p.get_edgecolor()[:3] != (1.0, 1.0, 1.0)]
    assert len(left.patches) == 6
    assert len(framed) == 1
    points = {line.get_label(): line.get_xdata() for line in right.lines}
    assert list(points["lammps"]) == pytest.approx([0.1, 500.0])


@pytest.mark.parametrize(("ended", "broke", "beyond"), [
    ("failed_silently", Held(invariant="order", size=1.0, tolerance=0.0, ruin=0.0, says="passed through"), True),
    ("failed_silently", None, True),
    ("degraded", Held(invariant="order", size=math.nan, tolerance=1e-3, ruin=0.1, says="passed through"), True),
    ("stable", Held(invariant="order", size=0.0, tolerance=0.0, ruin=0.0, says="passed through"), False),
])
def test_a_failed_case_never_has_a_point_that_looks_healthy(made, ended, broke, beyond):
    """Its energy, 3e-5 of the tolerance, is not shown: the order of neighbours broke, or nothing could be read."""
    fine = replace(held(3e-8), size=3e-8)
    bad = replace(
        made.of("good", "lammps"), ended=ended, held=(fine, broke) if broke else (fine,) if ended == "stable" else ()
    )
    changed = replace(made, results=(bad, *made.results[1:]))
    _, right = stability_figure(changed).axes
    lines = {line.get_label(): line for line in right.lines}
    arrows = lines[f"_lammps{BEYOND}"]
    assert len(arrows.get_xdata()) == beyond
    assert (list(lines["lammps"].get_ydata()) == [1]) is beyond, "only the other case has a point"
    assert right.get_xlim()[1] > 1.0
    if not beyond:
        assert lines["lammps"].get_xdata()[0] == pytest.approx(3e-5)


def test_the_time_limit_has_its_own_word_everywhere(made, tmp_path):
    late = replace(made.of("good", "lammps"), ended="timed_out", held=(), reason="no end after 0.01 s")
    found = replace(made, results=(late, *made.results[1:]))
    assert found.exit_status == 1
    assert [r["timed out"] for r in stability_answer(found).tables["Count"]] == [1, 0]
    assert outcome_table(found)[0]["lammps"] == "timed out (declared stable)"
    assert summary(found).endswith("one run met the time limit")
    text = write_stability(found, tmp_path).read_text()
    assert "the harness ended it at the time limit" in text
    assert "no end after 0.01 s" in text


def test_people_get_the_outcomes_and_their_count(made):
    shown = stability_answer(made).tables
    assert [r["stable"] for r in shown["Count"]] == [1, 1]


def test_a_folder_in_the_way_is_told_before_anything_runs(tmp_path):
    (tmp_path / "stability.html").mkdir()
    with pytest.raises(InputError, match="expected a file or nothing"):
        NAMES.check(tmp_path)


def test_the_figure_has_room_for_both_panels(made):
    """Arrows at the edge must not push the panels out of their places."""
    figure = stability_figure(made)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        png_bytes(figure, dpi=50)
    assert all(axes.get_position().width > 0.3 for axes in figure.axes)
