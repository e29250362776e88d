"""The bulk accuracy report from ladders that are known."""

import csv
import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from harness.errors import InputError
from harness.report.accuracy_bulk import BULK_NAMES, SCHEMA, bulk_answer, bulk_data, write_bulk
from harness.report.accuracy_bulk_tables import bulk_tables, shown_budget
from harness.report.accuracy_bulk_words import bulk_paragraph
from harness.report.accuracy_expected import announcement
from harness.runs.outcome import Host
from harness.scene.load import load_scene
from harness.studies.accuracy.asked import asked_all
from harness.studies.accuracy.bulk import BulkAccuracy
from harness.studies.accuracy.bulk_result import Ladder, Rung, floor_of, scale_of
from harness.studies.accuracy.limit import find_limit, find_order

FOLDER = Path(__file__).resolve().parents[2] / "inputs" / "scenes"
FILE = FOLDER / "biaxial_quick.toml"
ANGLE = "friction_angle"
SPREAD = np.linspace(-1.0, 1.0, 8)
PRICE = {"dt": -1.0, "stiffness": 0.5, "rate": -1.0, "size": 1.0, "width": 0.0}
SLOPES = {"dt": 0.0, "stiffness": 0.05, "rate": 0.5, "size": 0.0, "width": 2000.0}


def rung(one, value, own, factor, seed):
    """One packing in eight lacks an angle at the own setting of `rate`; the fastest drive of all is lost."""
    noise = 0.02 * np.random.default_rng(seed).standard_normal(8)
    angle = 25.0 + SPREAD + SLOPES[one.knob.name] * one.knob.x(value) ** one.knob.expected + noise
    lost = one.knob.name == "rate" and value == 8.0
    seconds = factor * 8.0 * (value / one.knob.own(load_scene(FILE))) ** PRICE[one.knob.name]
    values = {ANGLE: angle[:, None], "volume_strain": np.full((8, 1), -0.03), "stress_strain": np.ones((8, 40))}
    return Rung(
        knob=one.knob.name, value=value, x=one.knob.x(value), label=f"{value:.4g}", own=own, particles=200, dt=3e-7,
        status="crashed" if lost else "completed", reason="<no> answer" if lost else "", steps=185500,
        values={} if lost else values, seconds=None if lost else seconds, each=() if lost else (seconds,) * 8,
        setup=0.2, output=None,
    )


def ladder(one, engine, factor):
    own = one.knob.own(load_scene(FILE))
    rungs = tuple(rung(one, v, v == own, factor, k) for k, v in enumerate(one.values))
    good = [r for r in rungs if r.good]
    x = [r.x for r in good]
    limits = {q: find_limit(x, np.array([r.values[q] for r in good]), one.knob.expected) for q in good[0].values}
    return Ladder(
        knob=one.knob, engine=engine, rungs=rungs, limits=limits,
        orders={q: find_order(x, np.array([r.values[q] for r in good])) for q in limits},
        scales={q: scale_of(limit, None, None) for q, limit in limits.items()},
    )


@pytest.fixture(scope="module")
def made():
    scene = load_scene(FILE)
    wanted = asked_all(scene, FILE, knob=None, ladder=None, quantity=None)
    ladders = tuple(ladder(a, e, f) for a in wanted for e, f in (("lammps", 1.0), ("liggghts", 2.0)))
    floors = {
        (la.engine, q): floor_of(la.own, q, la.scales[q], "deg") for la in ladders[:2] for q in la.scales
    }
    return BulkAccuracy(
        scene=scene, scene_file=FILE, asked=wanted, packings=8, ladders=ladders, floors=floors, runs=100, kept=4,
        load=2.0,
        host=Host(cpu_model="CPU <1>", cores=2, os="os", python="3", numpy="2"), wall_seconds=600.0, own_seconds=20.0,
        packing_seconds=30.0, engine_seconds=950.0,
    )


def rows_of(made, table):
    return bulk_tables(made)[table]


def test_the_budget_names_the_cheapest_of_each_knob(made):
    rows = {(r["error below"], r["knob"]): r for r in shown_budget(made)}
    soft = rows[0.1, "stiffness"]
    assert (soft["cheapest"], soft["setting"]) == ("lammps", "0.0625")
    assert soft["times faster than declared"] == pytest.approx(4.0)
    assert soft["error"] == pytest.approx(0.05 * 16 / 25.0, abs=0.002)
    assert rows[0.1, "rate"]["setting"] == "4"
    assert rows[0.01, "rate"]["cheapest"] is None
    assert rows[0.01, "rate"]["gives up"].startswith("the finest rungs are off by 2")
    assert rows[0.01, "dt"]["gives up"] == "nothing that stands out of the noise"
    floored = "nothing that stands out of the noise; the friction_angle itself, mean over "
    assert rows[0.001, "dt"]["gives up"].startswith(f"{floored}packings, is known to 0.98 % only: 7")
    every = [r for r in rows_of(made, "budget") if r["of"] == "liggghts" and r["knob"] == "stiffness"]
    assert [r["cheapest"] for r in every] == ["liggghts", "liggghts", None]


def test_slopes_against_time_follow_from_orders(made):
    rows = {(r["knob"], r["engine"]): r for r in rows_of(made, "orders") if r["quantity"] == ANGLE}
    soft = rows["stiffness", "lammps"]
    assert soft["order"] == pytest.approx(1.0, abs=0.1)
    assert soft["slope of error against time"] == pytest.approx(-2.0 * soft["order"])
    assert rows["width", "lammps"]["slope of error against time"] is None, "no run changes"
    assert rows["dt", "lammps"]["order"] is None
    assert rows["dt", "lammps"]["limit is"] == "flat"


def test_failed_rungs_are_told_with_their_reason(made):
    (row, *_) = [r for r in rows_of(made, "rungs") if r["status"] == "crashed"]
    assert (row["reason"], row["CPU (s)"], row["error"]) == ("<no> answer", None, None)
    assert "No answer: rate = 8 on lammps (crashed: <no> answer)" in bulk_paragraph(made)


def barred(made):
    """Steps longer than declared are beyond the scene's limit."""
    return replace(made, ladders=tuple(
        replace(la, rungs=tuple(replace(r, beyond=0.0536 if la.knob.name == "dt" and r.value > 0.045 else None)
                                for r in la.rungs)) for la in made.ladders
    ))


def test_steps_that_scene_refuses_are_shown_and_not_recommended(made):
    before = [r for r in shown_budget(made) if r["knob"] == "dt" and r["error below"] == 0.1]
    assert [r["setting"] for r in before] == ["0.36"]
    study = barred(made)
    rows = [r for r in shown_budget(study) if r["knob"] == "dt" and r["error below"] == 0.1]
    assert [r["setting"] for r in rows] == ["0.045"]
    refused = ("0.36", "0.18", "0.09")
    assert not [r for r in rows_of(study, "front") if r["knob"] == "dt" and r["setting"] in refused]
    rungs = [r for r in rows_of(study, "rungs") if r["knob"] == "dt"]
    assert [r["beyond the scene's limit of"] for r in rungs[:4]] == [0.0536] * 3 + [None]
    assert all(r["CPU (s)"] for r in rungs), "measured all the same"
    words = bulk_paragraph(study)
    assert "Dt = 0.36, 0.18, 0.09: beyond the scene's limit of 0.0536, so measured and shown, but in no budget" in words
    assert "saved by dt" not in words
    data = [r for r in bulk_data(study)["rows"] if r["knob"] == "dt" and r["kind"] == "measured"]
    refuses = dict.fromkeys((0.36, 0.18, 0.09), 0.0536)
    assert {r["value"]: r["beyond_limit"] for r in data} == {**refuses, 0.045: None, 0.0225: None}


def test_every_rung_without_the_quantity_has_a_cross(made):
    """One that crashed, and one that completed on samples without an angle."""
    from harness.report.accuracy_bulk_figure import bulk_figure

    def without(rung):
        return replace(rung, values={k: v for k, v in rung.values.items() if k != ANGLE})

    ladders = tuple(
        replace(la, rungs=(without(la.rungs[0]), *la.rungs[1:])) if la.knob.name == "stiffness" else la
        for la in made.ladders
    )
    figure = bulk_figure(replace(made, ladders=ladders))
    for knob, expected in (("rate", 2), ("stiffness", 2), ("dt", 0)):
        axes = figure.axes[len(made.knobs) + 1 + made.knobs.index(knob)]
        crosses = [len(line.get_xdata()) for line in axes.lines
                   if line.get_marker() == "x" and line.get_transform() == axes.get_xaxis_transform()]
        assert sum(crosses) == expected, knob


def test_columns_name_their_units(made):
    first = rows_of(made, "rungs")[0]
    assert {"friction_angle (deg)", "friction_angle (deg) +-"} <= set(first)
    assert ANGLE not in first


def test_the_load_is_the_machines(made):
    from harness.report.accuracy_bulk import bulk_summary

    assert "load of the machine, these runs and all else on it, up to 2.0 when a run began" in bulk_summary(made)


def test_the_words_are_made_of_the_numbers(made):
    words = bulk_paragraph(made)
    assert "lammps 24.99 deg (2.8 %, 8 packings)" in words
    assert "that no knob buys anything" in words
    assert "96 of 100 runs were made in 10.0 minutes; the study itself took 2 % of all CPU time" in words
    assert "falling with order" in words
    kept = bulk_paragraph(replace(made, kept=100))
    assert "All 100 runs were there already." in kept


def test_rows_for_programs_say_all_they_need(made):
    data = bulk_data(made)
    assert data["schema"] == SCHEMA
    rows = [r for r in data["rows"] if r["quantity"] == ANGLE and r["engine"] == "lammps"]
    told = {r["knob"] for r in rows}
    assert told == {"dt", "stiffness", "rate", "size", "width"}
    own = [r for r in rows if r["kind"] == "measured" and r["declared"]]
    assert len(own) == 5
    assert len({round(r["whole_error"], 2) for r in own}) == 1, "one setting, whichever knob it is read from"
    limits = [r for r in rows if r["kind"] == "extrapolated"]
    assert [r["state"] for r in limits] == ["flat", "extrapolated", "extrapolated", "flat", "extrapolated"]
    assert all(r["x"] == 0.0 and r["mean_error"] > 0.0 for r in limits)
    rate = next(r for r in rows if r["knob"] == "rate" and r["value"] == 4.0)
    assert rate["error"] == pytest.approx(2.0 / 25.0, abs=0.003)
    assert rate["signed_error"] == pytest.approx(rate["error"])
    assert rate["seen"] is True
    assert rate["cpu_seconds"] == pytest.approx(2.0)
    assert (len(rate["each"]), rate["packings"], rate["unit"]) == (8, 8, "deg")
    lost = next(r for r in rows if r["knob"] == "rate" and r["value"] == 8.0)
    assert (lost["status"], lost["error"], lost["cpu_seconds"], lost["each"]) == ("crashed", None, None, None)


def test_all_files_hold_the_same(made, tmp_path):
    page = write_bulk(made, tmp_path)
    text = page.read_text()
    assert f"--out {tmp_path}" in text
    assert "&lt;no&gt; answer" in text
    assert "CPU &lt;1&gt;" in text
    assert "data:image/png;base64," in text
    data = json.loads((tmp_path / "accuracy.json").read_text())
    assert data["words"] == bulk_paragraph(made)
    assert len(data["rows"]) == len(bulk_data(made)["rows"])
    for name in BULK_NAMES.tables:
        with (tmp_path / f"{name}.csv").open() as file:
            assert len(list(csv.reader(file))) == len(rows_of(made, name)) + 1
    for picture in ("accuracy.png", "accuracy.svg"):
        assert (tmp_path / picture).stat().st_size > 10_000
    assert set(bulk_answer(made).tables) == {"Cheapest settings", "Orders and limits", "Floor", "Rungs"}


def test_advice_reads_what_is_written(made, tmp_path):
    from harness.studies.advise import advise, read_evidence
    from harness.studies.advise.files import BULK_SCHEMA

    assert SCHEMA == BULK_SCHEMA
    write_bulk(barred(made), tmp_path)
    evidence = read_evidence(made.scene, FILE, quantity=None, folder=tmp_path, effects=None, tolerance=0.1)
    assert evidence.ladders["lammps"]["dt"].beyond == (0.09, 0.18, 0.36)
    assert advise(evidence, 0.1).choice.rungs["dt"].value == 0.045


def test_a_study_without_any_answer_is_drawn_too(made, tmp_path):
    """Every rung lost: no limit, no floor, nothing to be drawn but crosses."""
    lost = tuple(
        replace(la, rungs=tuple(replace(r, status="crashed", reason="gone", values={}, seconds=None, each=())
                                for r in la.rungs), limits={}, orders={}, scales={})
        for la in made.ladders
    )
    empty = replace(made, ladders=lost, floors={})
    assert empty.exit_status == 1
    assert "there is no error to tell" in bulk_paragraph(empty)
    assert write_bulk(empty, tmp_path).exists()


def test_a_folder_in_the_way_is_found_before(tmp_path):
    (tmp_path / "rungs.csv").mkdir()
    with pytest.raises(InputError, match="got a folder"):
        BULK_NAMES.check(tmp_path)


@pytest.mark.parametrize(("scene", "words", "says"), [
    ("oblique_impact.toml", {"packings": 3}, "--packings: expected nothing"),
    ("biaxial_quick.toml", {"phases": 3}, "--phases: expected nothing"),
    ("head_on.toml", {"quantity": "spin"}, "no law of this scene turns bodies"),
])
def test_what_cannot_be_is_refused_before_a_time_is_told(scene, words, says):
    none = dict.fromkeys(("knob", "ladder", "quantity", "packings", "phases", "workers"))
    with pytest.raises(InputError, match=says):
        announcement(FOLDER / scene, **none | words, engines=["kernel:talk"])


def test_time_is_told_before():
    none = dict.fromkeys(("knob", "ladder", "quantity", "packings", "phases", "workers"))
    line = announcement(FILE, **none | {"packings": 4}, engines=["kernel:talk"])
    assert "52 runs and 4 packings" in line
    assert line.startswith("expected: about")
    line = announcement(FOLDER / "oblique_impact.toml", **none, engines=["kernel:talk"])
    assert "26 runs" in line
    assert "besides 3 oracles and timing" in line, "oracles are part of what is told"
