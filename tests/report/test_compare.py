"""The report: one page, JSON and CSV with the same numbers, for both kinds of scene, complete or not."""

import base64
import csv
import io
import json
import re
from dataclasses import replace
from typing import get_args

import msgspec
import numpy as np
import pytest

from harness.report.biaxial import average_rows, macro_page_rows, macro_rows, phase_page_rows
from harness.report.biaxial_panels import average_panels
from harness.report.compare import FAILED, check_rows, run_rows, summary, write_report
from harness.report.figures import new_figure, png_uri
from harness.report.overview import overview
from harness.report.tables import text
from harness.runs.outcome import Status
from harness.studies.compare import compare
from postproc.snapshot import Columns

LIMIT = 60.0
HOSTILE = "<script>alert(1)</script>"


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
    walls, parting, calm, averages, particles = 4, 2, 3, 1, 2  # so small a box has no inner part
    assert len(shown) == walls + parting + calm + averages + particles
    assert all(p.std() > 0.01 and min(p.shape[:2]) > 200 for p in shown)
    headings = re.findall(r"<h2>(.*?)</h2>", html)
    assert headings == [
        "Verdicts", "What failed, and how to repeat it", "Numbers of the whole test",
        "Stress and volume against strain", "Do the codes agree?", "How calm was the sample?", "Micro-macro averages",
        "Force chains", "Particle rotations", "Time and cost", "Versions", "Machines", "All checks", "Runs",
        "Reproduce",
    ]
    curves = numbers_of(tmp_path / "report" / "curves.csv")
    assert len(curves) == 2 * 41
    assert float(curves[40]["stress_zz (N/m)"]) == pytest.approx(450.0)
    assert float(curves[81]["stress_zz (N/m)"]) == pytest.approx(300.0)
    assert [n for n in curves[0] if "(" not in n] == ["engine", "strain", "ratio", "volume_strain", "control_error"]
    assert "sigma_zz from walls (N/m)" in numbers_of(tmp_path / "report" / "states.csv")[0]
    assert "time (s)" in numbers_of(tmp_path / "report" / "growth.csv")[0]
    assert not [w for w in recwarn if issubclass(w.category, UserWarning)]


def test_what_a_box_does_after_the_peak_is_shown(biaxial, box, tmp_path):
    """Mean 166.7 N/m after the peak of 200 at 5 %, down to 100 at the end: -40 and +20 %."""
    comparison = biaxial({("lammps", 0): box.trajectory(lambda eps: 1 + 400 * eps * (0.1 - eps))})
    write_report(comparison, tmp_path / "report")
    before, after, plateau = numbers_of(tmp_path / "report" / "phases.csv")
    assert [r["part"] for r in (before, after, plateau)] == ["up to the peak", "after the peak", "plateau"]
    assert before["sigma_zz, lowest over mean - 1"] == ""
    assert float(after["sigma_zz, lowest over mean - 1"]) == pytest.approx(-0.4, abs=2e-3)
    assert float(after["sigma_zz, highest over mean - 1"]) == pytest.approx(0.2, abs=4e-3)
    html = (tmp_path / "report" / "report.html").read_text()
    assert "quasi-static</td>" not in html
    assert "slow drive</td>" in html
    shown = phase_page_rows(comparison)
    assert ("up to the peak", "sigma_zz, mean (N/m)") not in [(r["part"], r["quantity"]) for r in shown]
    row = next(r for r in shown if (r["part"], r["quantity"]) == ("after the peak", "sigma_zz, lowest over mean - 1"))
    assert row["lammps"] == float(after["sigma_zz, lowest over mean - 1"])
    peak = next(r for r in macro_rows(comparison) if r["quantity"] == "strain at the peak")
    assert peak["mean"] == pytest.approx(0.05)


def test_a_peak_that_only_one_engine_has_is_none_of_the_other(biaxial, box, tmp_path):
    runs = {("a", 0): box.trajectory(), ("b", 0): box.trajectory(lambda eps: 1 + 400 * eps * (0.1 - eps))}
    comparison = biaxial(runs)
    row = next(r for r in macro_page_rows(comparison) if r["quantity"] == "peak stress ratio")
    assert row == {"quantity": "peak stress ratio", "unit": "1", "a": None, "b": "2"}
    assert write_report(comparison, tmp_path / "report").page.is_file()


def test_what_was_not_recorded_is_not_shown(biaxial, box, tmp_path, recwarn):
    bare = box.changed(("contacts = true\nrotations = true", "contacts = false"))
    t = bare.trajectory()
    t = replace(t, frames=tuple(replace(f, contacts=None) for f in t))
    comparison = biaxial({("lammps", 0): t}, bare)
    html = write_report(comparison, tmp_path / "report").page.read_text()
    assert not {"Force chains", "Particle rotations", "Do the codes agree?", "Micro-macro averages"} & set(
        re.findall(r"<h2>(.*?)</h2>", html))
    assert len(pictures(html)) == 5
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
    assert shown["lammps"] == "250 (s = 25, n = 3)"


def test_a_single_packing_has_no_spread(biaxial, box):
    comparison = biaxial({("lammps", 0): box.trajectory()})
    assert {r["standard deviation"] for r in macro_rows(comparison)} == {None}
    assert next(r for r in macro_page_rows(comparison) if r["unit"] == "N/m")["lammps"] == "250"


def packed(box, force: float):
    """A run whose recorded contact forces are `force` times those of the box."""
    t = box.trajectory()
    return replace(t, frames=tuple(replace(f, contacts=stronger(f.contacts, force)) for f in t))


def stronger(contacts, force: float):
    return Columns({k: contacts[k] * (force if k in ("fx", "fy") else 1) for k in contacts}, "contacts")


def test_averages_over_packings_are_means_with_standard_errors(biaxial, box, tmp_path):
    """Of 0.9, 1 and 1.1 times the same forces: s = 0.1, error 0.1/sqrt(3); an engine has the packings it completed."""
    forces = {("lammps", 0): 0.9, ("lammps", 1): 1.0, ("lammps", 2): 1.1, ("liggghts", 0): 1.0, ("liggghts", 2): 1.2}
    comparison = biaxial({key: packed(box, f) for key, f in forces.items()})
    write_report(comparison, tmp_path / "report")
    one = comparison.result.replicates["lammps"][1].values["sigma_zz from contacts"]
    rows = [r for r in average_rows(comparison) if r["quantity"] == "sigma_zz from contacts"]
    ours, theirs = ([r for r in rows if r["engine"] == e] for e in ("lammps", "liggghts"))
    assert one.min() > 0
    assert [r["mean"] for r in ours] == pytest.approx(one)
    assert [r["standard error"] for r in ours] == pytest.approx(one * 0.1 / np.sqrt(3))
    assert [r["mean"] for r in theirs] == pytest.approx(1.1 * one)
    assert [r["standard error"] for r in theirs] == pytest.approx(one * 0.1)
    assert {(r["engine"], r["runs"], r["unit"]) for r in rows} == {("lammps", 3, "N/m"), ("liggghts", 2, "N/m")}
    written = numbers_of(tmp_path / "report" / "averages.csv")
    assert [(r["engine"], float(r["mean"]), float(r["standard error"])) for r in written] == [
        (r["engine"], r["mean"], r["standard error"]) for r in rows]


def test_averages_over_packings_are_drawn_with_bands(biaxial, box, monkeypatch):
    drawn = []
    monkeypatch.setattr(
        "harness.report.biaxial_panels.panel", lambda draw, caption: drawn.append((axes_of(draw), caption)))
    average_panels(biaxial({("lammps", k): packed(box, f) for k, f in enumerate((0.9, 1.1))}))
    average_panels(biaxial({("lammps", 0): packed(box, 1.0)}))
    (axes, caption), (alone, single) = drawn
    assert [len(a.collections) for a in (axes, alone)] == [1, 0]
    assert caption == (
        "Sigma_zz from contacts. A band is the mean over an engine's runs +- its standard error s/√n, n = 2.")
    assert single == "Sigma_zz from contacts. One packing, hence no bands."
    assert axes.get_ylabel() == "sigma_zz from contacts (N/m)"


def test_bands_of_wall_curves_are_written_over_packings_only(biaxial, box, mutate, tmp_path):
    """Of 0.9, 1 and 1.1 times the same forces: s = 0.1, error 0.1/sqrt(3). The page says where they are."""
    out = tmp_path / "report"
    forces = {("lammps", 0): 0.9, ("lammps", 1): 1.0, ("lammps", 2): 1.1, ("liggghts", 0): 1.0, ("liggghts", 2): 1.2}
    runs = {key: mutate.series(box.trajectory(), top_fy=lambda f, s=size: s * f) for key, size in forces.items()}
    page = write_report(biaxial(runs), out).page.read_text()
    one = np.array([float(r["stress_zz (N/m)"]) for r in numbers_of(out / "curves.csv") if r["engine"] == "liggghts"])
    rows = numbers_of(out / "wall_bands.csv")
    assert "wall_bands.csv" in page
    assert list(rows[0]) == ["engine", "strain", "replicates", *(
        f"{q}, {of}{unit}" for q, unit in (
            ("stress_zz", " (N/m)"), ("stress_xx", " (N/m)"), ("friction_angle", " (deg)"), ("volume_strain", ""),
            ("control_error", ""),
        ) for of in ("mean", "standard error"))]
    for engine, mean, error, count in (("lammps", 1.0, 0.1 / np.sqrt(3), "3"), ("liggghts", 1.1, 0.1, "2")):
        of = [r for r in rows if r["engine"] == engine]
        assert {r["replicates"] for r in of} == {count}
        assert [float(r["stress_zz, mean (N/m)"]) for r in of] == pytest.approx(mean * one)
        assert [float(r["stress_zz, standard error (N/m)"]) for r in of] == pytest.approx(error * one)
    single = write_report(biaxial({("lammps", 0): box.trajectory()}), out)
    assert not (out / "wall_bands.csv").exists()
    assert out / "wall_bands.csv" not in single.tables
    assert "wall_bands" not in single.page.read_text() + single.data.read_text()


def axes_of(draw):
    _, ((axes,),) = new_figure(1, 1, width=4, height=3)
    draw(axes)
    return axes


def test_nothing_completed_still_makes_a_page(flight, obedient, tmp_path):
    comparison = compare(flight, (obedient("a", does="abort"), obedient("b", available=False)), tmp_path / "out",
                         time_limit=LIMIT)
    written = write_report(comparison, tmp_path / "report")
    html = written.page.read_text()
    assert_self_contained(html)
    assert "0 of 2 runs completed, a crashed, b is unavailable" in html
    assert "get it from nowhere" in html
    assert comparison.exit_status == 1


@pytest.mark.parametrize(("third", "said"), [
    ({"does": "abort"}, "third crashed"), ({"available": False}, "third is unavailable"),
    ({"level": "unsupported"}, "third cannot compute this scene"),
])
def test_a_run_that_failed_is_in_every_table(free, tmp_path, third, said):
    comparison = free(**third)
    written = write_report(comparison, tmp_path / "report")
    assert f"2 of 3 runs completed, {said}" in summary(comparison)
    assert said in written.page.read_text()
    row = numbers_of(tmp_path / "report" / "runs.csv")[2]
    assert row["status"] == comparison.runs[2].outcome.status != "completed"
    assert row["reason"]
    assert row["CPU (s)"] == row["CPU over steps (us)"] == ""
    status = json.loads(written.data.read_text())["runs"][2]["status"]
    assert status == row["status"]


def test_every_way_to_fail_is_a_sentence():
    assert set(FAILED) == set(get_args(Status)) - {"completed"}


def test_cost_is_cpu_time_over_steps(free):
    for row, run in zip(run_rows(free()), free().runs, strict=True):
        assert row["CPU over steps (us)"] == pytest.approx(1e6 * run.outcome.cpu_seconds / run.outcome.steps)


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
    assert html.count("&lt;script&gt;alert(1)&lt;/script&gt;") == 6
    assert_self_contained(html)
