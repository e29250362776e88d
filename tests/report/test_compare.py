"""The report: one page, JSON and CSV with the same numbers, for both kinds of scene, complete or not."""

import base64
import csv
import io
import json
import re
from dataclasses import replace

import msgspec
import numpy as np
import pytest

from harness.report.biaxial import macro_page_rows, macro_rows
from harness.report.compare import check_rows, run_rows, summary, write_report
from harness.report.figures import png_uri
from harness.report.overview import overview
from harness.report.tables import text
from harness.studies.compare import Comparison, compare
from harness.studies.compare.biaxial import judge_biaxial
from harness.studies.compare.study import Run
from harness.studies.verdict import Rerun

LIMIT = 60.0
HOSTILE = "<script>alert(1)</script>"


@pytest.fixture
def free(flight, obedient, tmp_path):
    """free(**settings of a third engine) is a comparison of a, b, and if asked of a third."""

    def make(**third):
        engines = [obedient("a"), obedient("b", off=1e-6), *([obedient("third", **third)] if third else [])]
        return compare(flight, tuple(engines), tmp_path / "runs of free", time_limit=LIMIT)

    return make


@pytest.fixture
def biaxial(box, finished, free):
    """biaxial(runs by engine and packing, box) is a comparison of hand-made runs."""
    outcome = free().runs[0].outcome

    def make(trajectories: dict, of=box):
        count = 1 + max(k for _, k in trajectories)
        starts = tuple(of.start(k) for k in range(count))
        runs = tuple(
            Run(engine=e, packing=k, outcome=outcome, folder=of.folder, trajectory=t)
            for (e, k), t in trajectories.items()
        )
        engines = list(dict.fromkeys(e for e, _ in trajectories))
        rerun = Rerun(scene_file=of.file, out=of.folder, packings=None)
        checks, result = judge_biaxial(of.scene, starts, runs, engines, rerun)
        return Comparison(
            scene=of.scene, scene_file=of.file, starts=starts, runs=runs, checks=tuple(checks), result=result
        )

    return make


def numbers_of(file):
    return list(csv.DictReader(io.StringIO(file.read_text())))


def same(cell: str, value) -> bool:
    """Is a CSV cell the JSON value? NaN is null in JSON."""
    if value is None:
        return cell in ("", "nan")
    return float(cell) == value if isinstance(value, float) else cell == str(value)


def assert_self_contained(html: str) -> None:
    assert not re.findall(r"(?:https?:)?//\S", re.sub(r'src="data:[^"]*"', "", html))
    assert not re.findall(r"<(?:script|link|iframe|object|embed|base|form)\b", html, flags=re.I)
    assert all(source.startswith("data:image/png;base64,") for source in re.findall(r'src="([^"]*)"', html))
    assert "url(" not in html
    assert "@import" not in html


def pictures(html: str) -> list[np.ndarray]:
    from matplotlib.image import imread

    coded = re.findall(r'src="data:image/png;base64,([^"]*)"', html)
    return [imread(io.BytesIO(base64.b64decode(c, validate=True))) for c in coded]


def assert_same_numbers(comparison, folder) -> None:
    """Every CSV cell is the JSON number to the last bit, and the page shows it with three digits."""
    data, html = json.loads((folder / "report.json").read_text()), (folder / "report.html").read_text()
    tables = data["tables"] | {"checks": data["checks"]}
    for name, rows in tables.items():
        for cells, values in zip(numbers_of(folder / f"{name}.csv"), rows, strict=True):
            assert all(same(cells[key], values[key]) for key in cells), (name, cells, values)
    for row in check_rows(comparison):
        assert all(f">{text(v)}</td>" in html for v in row.values() if isinstance(v, float))
    assert [r["cpu_seconds"] for r in data["runs"]] == [
        float(c["CPU (s)"]) if c["CPU (s)"] else r["cpu_seconds"]
        for c, r in zip(numbers_of(folder / "runs.csv"), data["runs"], strict=True)
    ]
    assert data["exit_status"] == comparison.exit_status


def test_free_report(free, tmp_path):
    comparison = free()
    written = write_report(comparison, tmp_path / "report")
    assert_same_numbers(comparison, tmp_path / "report")
    html = written.page.read_text()
    assert_self_contained(html)
    (growth,) = pictures(html)
    assert growth.std() > 0.01
    assert {p.name for p in written.tables} == {"checks.csv", "runs.csv", "exits.csv", "collisions.csv"}
    exits = numbers_of(tmp_path / "report" / "exits.csv")
    assert [(r["engine"], r["body"], float(r["vx (m/s)"])) for r in exits[:2]] == [("a", "1", 0.3), ("a", "2", -0.2)]


def test_biaxial_report(biaxial, box, mutate, tmp_path, recwarn):
    true = box.trajectory()
    comparison = biaxial({("lammps", 0): mutate.series(true, top_fy=lambda f: 1.5 * f), ("kernel:lammps", 0): true})
    written = write_report(comparison, tmp_path / "report")
    assert_same_numbers(comparison, tmp_path / "report")
    html = written.page.read_text()
    assert_self_contained(html)
    shown = pictures(html)
    assert len(shown) == 6
    assert all(p.std() > 0.01 and min(p.shape[:2]) > 200 for p in shown)
    headings = re.findall(r"<h2>(.*?)</h2>", html)
    assert headings == [
        "Verdicts", "Runs", "Numbers of the whole test", "Stress and volume against strain", "Do the codes agree?",
        "Was it quasi-static?", "Micro-macro averages", "Force chains", "Particle rotations", "Reproduce",
    ]
    curves = numbers_of(tmp_path / "report" / "curves.csv")
    assert len(curves) == 2 * 41
    assert float(curves[40]["stress_zz (N/m)"]) == pytest.approx(450.0)
    assert float(curves[81]["stress_zz (N/m)"]) == pytest.approx(300.0)
    assert [n for n in curves[0] if "(" not in n] == ["engine", "strain", "ratio", "volume_strain", "control_error"]
    assert "sigma_zz from walls (N/m)" in numbers_of(tmp_path / "report" / "states.csv")[0]
    assert "time (s)" in numbers_of(tmp_path / "report" / "growth.csv")[0]
    assert not [w for w in recwarn if issubclass(w.category, UserWarning)]


def test_what_was_not_recorded_is_not_shown(biaxial, box, tmp_path, recwarn):
    bare = box.changed(("contacts = true\nrotations = true", "contacts = false"))
    t = bare.trajectory()
    t = replace(t, frames=tuple(replace(f, contacts=None) for f in t))
    comparison = biaxial({("lammps", 0): t}, bare)
    html = write_report(comparison, tmp_path / "report").page.read_text()
    assert not {"Force chains", "Particle rotations", "Do the codes agree?", "Micro-macro averages"} & set(
        re.findall(r"<h2>(.*?)</h2>", html))
    assert len(pictures(html)) == 2
    assert not [w for w in recwarn if issubclass(w.category, UserWarning)]


def test_the_overview_is_one_picture_of_up_to_three_codes(biaxial, box):
    true = box.trajectory()
    comparison = biaxial({(e, 0): true for e in ("lammps", "liggghts", "kernel:lammps", "kernel:liggghts")})
    titles = [a.get_title().split(",")[0] for a in overview(comparison).axes]
    assert titles == ["", "", "", "lammps", "liggghts", "kernel:lammps"]
    (shown,) = pictures(f'<img src="{png_uri(overview(comparison))}">')
    assert shown.std() > 0.01


def test_numbers_over_packings_have_a_spread(biaxial, box):
    runs = {("lammps", k): box.trajectory(lambda eps, a=a: (1 + 20 * eps) * a) for k, a in enumerate((0.9, 1.0, 1.1))}
    comparison = biaxial(runs)
    row = next(r for r in macro_rows(comparison) if r["quantity"] == "plateau sigma_zz")
    assert (row["engine"], row["unit"], row["packings"]) == ("lammps", "N/m", 3)
    assert (row["mean"], row["standard deviation"]) == (pytest.approx(250.0), pytest.approx(25.0))
    shown = next(r for r in macro_page_rows(comparison) if r["quantity"] == "plateau sigma_zz")
    assert shown["lammps"] == "250 +- 25 (n = 3)"


def test_a_single_packing_has_no_spread(biaxial, box):
    comparison = biaxial({("lammps", 0): box.trajectory()})
    assert {r["standard deviation"] for r in macro_rows(comparison)} == {None}
    assert next(r for r in macro_page_rows(comparison) if r["unit"] == "N/m")["lammps"] == "250"


def test_nothing_completed_still_makes_a_page(flight, obedient, tmp_path):
    comparison = compare(flight, (obedient("a", does="abort"), obedient("b", available=False)), tmp_path / "out",
                         time_limit=LIMIT)
    written = write_report(comparison, tmp_path / "report")
    html = written.page.read_text()
    assert_self_contained(html)
    assert "0 of 2 runs completed, a is crashed, b is unavailable" in html
    assert "get it from nowhere" in html
    assert comparison.exit_status == 1


@pytest.mark.parametrize(("third", "said"), [
    ({"does": "abort"}, "third is crashed"), ({"available": False}, "third is unavailable"),
    ({"level": "unsupported"}, "third is unsupported"),
])
def test_a_run_that_failed_is_in_every_table(free, tmp_path, third, said):
    comparison = free(**third)
    written = write_report(comparison, tmp_path / "report")
    assert f"2 of 3 runs completed, {said}" in summary(comparison)
    assert said in written.page.read_text()
    row = numbers_of(tmp_path / "report" / "runs.csv")[2]
    assert row["outcome"] == said.split()[-1]
    assert row["reason"]
    assert row["CPU (s)"] == row["CPU per step (us)"] == ""
    status = json.loads(written.data.read_text())["runs"][2]["status"]
    assert status == row["outcome"]


def test_cost_is_cpu_time_over_steps(free):
    for row, run in zip(run_rows(free()), free().runs, strict=True):
        assert row["CPU per step (us)"] == pytest.approx(1e6 * run.outcome.cpu_seconds / run.outcome.steps)


def test_hostile_words_of_scene_and_engine_are_escaped(free, tmp_path):
    comparison = free(does="abort")
    broken = comparison.runs[2]
    assert any("<b>neighbour</b>" in line for line in broken.outcome.last_lines)
    outcome = msgspec.structs.replace(broken.outcome, reason=HOSTILE, reproduce=f"cd {HOSTILE}")
    hostile = replace(
        comparison, scene=msgspec.structs.replace(comparison.scene, title=HOSTILE),
        runs=(*comparison.runs[:2], replace(broken, outcome=outcome)),
    )
    html = write_report(hostile, tmp_path / "report").page.read_text()
    assert "<script" not in html
    assert html.count("&lt;script&gt;alert(1)&lt;/script&gt;") == 4
    assert_self_contained(html)
