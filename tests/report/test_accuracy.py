"""The accuracy report from ladders that are known."""

import csv
import json
from pathlib import Path

import numpy as np
import pytest

from harness.errors import InputError
from harness.report.accuracy import NAMES, accuracy_answer, write_accuracy
from harness.report.accuracy_tables import tables
from harness.report.accuracy_words import paragraph
from harness.runs.outcome import Host
from harness.scene.load import load_scene
from harness.studies.accuracy.asked import asked
from harness.studies.accuracy.cost import Cost
from harness.studies.accuracy.fit import fit_order
from harness.studies.accuracy.result import Point, Track
from harness.studies.accuracy.study import Accuracy

FILE = Path(__file__).resolve().parents[2] / "inputs" / "scenes" / "oblique_impact.toml"
VALUES = (0.64, 0.04, 0.02, 0.01, 0.005)
PHASES = np.linspace(0.5, 1.5, 8) / np.sqrt((np.linspace(0.5, 1.5, 8) ** 2).mean())
"""Errors of the phases over their rms."""


def point(value, size, step):
    """At a step of 0.64 nothing is left."""
    steps = round(4.0 / value)
    lost = value == 0.64
    errors = {} if lost else {"exit": size * PHASES, "velocity": 0.6 * size * PHASES, "spin": 0.8 * size * PHASES}
    return Point(
        rung=value, value=value, dt=1e-5 * value, steps=steps, status="unstable" if lost else "completed",
        reason="kinetic energy grew by <30> %" if lost else "", errors=errors,
        seconds=None if lost or step is None else step * steps, process_seconds=0.1,
    )


def track(engine, factor, order, step, *, parted=0.0):
    points = tuple(point(v, factor * v**order, step) for v in VALUES)
    good = points[1:]
    fits = {q: fit_order([p.dt for p in good], np.array([p.errors[q] for p in good]), oracle=0.0)
            for q in ("exit", "velocity", "spin")}
    timed = Cost(reason="not timed") if step is None else Cost(seconds=(step,) * 3, setup=(0.2,) * 3, steps=400)
    return Track(
        case="as declared", engine=engine, points=points, cost=timed, fits=fits, oracle={"exit": 1e-9},
        oracle_says="exact", round_off=None, growth=None, parted={"exit": parted},
    )


@pytest.fixture
def made():
    scene = load_scene(FILE)
    tracks = (
        track("lammps", 0.3, 1.0, 2e-6, parted=2e-4), track("kernel:corrected", 0.5, 2.0, 2e-5),
        track("lammps@1", 0.3, 1.0, None),
    )
    return Accuracy(
        scene=scene, scene_file=FILE, asked=asked(scene, FILE, knob=None, ladder=VALUES, quantity=None), phases=8,
        bodies=2, contact_time=2e-5, tracks=tracks, wall_seconds=10.0, own_seconds=1.0,
        host=Host(cpu_model="CPU <1>", cores=2, os="os", python="3", numpy="2"),
    )


def test_the_budget_names_the_cheapest_of_all_and_of_each(made):
    rows = {(r["error below"], r["of"]): r for r in tables(made)["budget"]}
    assert rows[0.1, "all"]["cheapest"] == "lammps"
    assert rows[0.1, "all"]["CPU (ms)"] == pytest.approx(0.2)
    assert rows[0.001, "lammps"]["cheapest"] is None
    assert rows[0.001, "all"]["cheapest"] == "kernel:corrected"
    assert rows[0.001, "all"]["dt_fraction"] == 0.04
    assert "energy drifts" in rows[0.001, "all"]["gives up"]
    assert "velocity 0.048 %, spin 0.064 %" in rows[0.001, "all"]["gives up"]
    assert rows[0.01, "lammps"]["times faster than the scene's step"] == pytest.approx(2.0)
    assert rows[0.1, "lammps@1"]["cheapest"] is None


def coarse(made):
    """The rung of 0.04 ran as 0.038, beyond a limit of 0.03; that of 0.01 as 0.0095."""
    from dataclasses import replace

    ran, beyond = {0.04: 0.038, 0.01: 0.0095}, {0.04: 0.03}
    return replace(made, tracks=tuple(
        replace(t, points=tuple(replace(p, value=ran.get(p.rung, p.rung), beyond=beyond.get(p.rung))
                                for p in t.points)) for t in made.tracks
    ))


def test_the_step_that_ran_is_the_one_that_is_told(made):
    found = coarse(made)
    rows = {(r["error below"], r["of"]): r for r in tables(found)["budget"]}
    row = rows[0.01, "lammps"]
    assert (row["dt_fraction"], row["times faster than the scene's step"]) == (0.02, pytest.approx(0.02 / 0.0095))
    assert "50 steps a contact" in row["gives up"]
    told = [(r["rung"], r["dt_fraction"]) for r in tables(found)["points"] if r["engine"] == "lammps"]
    assert told == [(0.64, 0.64), (0.04, 0.038), (0.02, 0.02), (0.01, 0.0095), (0.005, 0.005)]
    assert "At the scene's own step, dt_fraction = 0.01, errors are" in paragraph(found)


def test_steps_that_scene_refuses_are_measured_and_not_recommended(made):
    found = coarse(made)
    for name in ("budget", "front"):
        assert 0.04 in {r["dt_fraction"] for r in tables(made)[name]}
        assert not {0.04, 0.038} & {r["dt_fraction"] for r in tables(found)[name]}
    row = next(r for r in tables(found)["points"] if r["rung"] == 0.04)
    assert (row["status"], row["beyond the scene's limit of"]) == ("completed", 0.03)
    words = paragraph(found)
    assert "Beyond the scene's limit of 0.03, so measured and shown, but in no budget and on no front: " in words
    assert "lammps, kernel:corrected, lammps@1 at 0.038 (dt_fraction)." in words


def test_what_is_not_timed_is_not_on_the_front(made):
    front = tables(made)["front"]
    assert {r["engine"] for r in front} == {"lammps", "kernel:corrected"}
    untimed = [r for r in tables(made)["points"] if r["engine"] == "lammps@1"]
    assert all(r["CPU (ms)"] is None for r in untimed)
    assert all(r["exit"] is not None for r in untimed[1:])


def test_words_are_made_of_the_numbers(made):
    words = paragraph(made)
    assert "p = 1.00 ± 0.00 (lammps, lammps@1), 2.00 ± 0.00 (kernel:corrected)" in words
    assert "At the scene's own step, dt_fraction = 0.01, errors are: lammps 0.3 %" in words
    assert "Cheapest rung below 1 %: lammps at dt_fraction = 0.02, 0.4 ms." in words
    assert "these give answers that are 0.02 % (lammps) from those of the talk's laws" in words
    lost = "(kinetic energy grew by <30> %)"
    assert f"No answer: lammps at 0.64 {lost}; kernel:corrected at 0.64 {lost}; lammps@1 at 0.64 {lost}." in words


def test_a_slope_that_tells_nothing_is_not_told(made):
    """Of round-off alone one gets an order with an error as large as itself: it stands in the table, not in words."""
    from dataclasses import replace

    (first, *rest) = made.tracks
    vague = replace(first, fits={q: replace(fit, error=0.73) for q, fit in first.fits.items()})
    words = paragraph(replace(made, tracks=(vague, *rest)))
    assert "1.00 ± 0.00 (lammps@1)" in words


def test_the_comparison_of_steps_needs_ladders_that_tell(made):
    """The leapfrog's ladder ends above 0.1 %, so no ratio can be told; one with a smaller constant tells."""
    from dataclasses import replace

    assert "times as many" not in paragraph(made)
    better = replace(made, tracks=(track("lammps", 0.15, 1.0, 2e-6), track("kernel:corrected", 1.0, 2.0, 2e-5)))
    words = paragraph(better)
    assert "reach an error of 0.1 %, it takes 126 steps by kernel:corrected, 4.74 times as many by lammps" in words


def test_all_files_hold_the_same(made, tmp_path):
    page = write_accuracy(made, tmp_path)
    html = page.read_text()
    assert "&lt;30&gt;" in html
    assert "<30>" not in html
    assert f"--out {tmp_path}" in html
    assert (tmp_path / NAMES.pictures[0]).read_bytes().startswith(b"\x89PNG")
    assert b"<svg" in (tmp_path / NAMES.pictures[1]).read_bytes()
    data = json.loads((tmp_path / "accuracy.json").read_text())
    for name in NAMES.tables:
        rows = list(csv.DictReader((tmp_path / f"{name}.csv").open()))
        assert len(rows) == len(data["tables"][name]) > 0
    assert data["words"] == paragraph(made)
    assert len(data["errors"]) == 3 * (len(VALUES) - 1)
    assert accuracy_answer(made).data["phases"] == 8


def test_advice_names_the_same_step(made, tmp_path):
    from harness.report.accuracy import SCHEMA
    from harness.studies.advise import advise, read_evidence
    from harness.studies.advise.files import FREE_SCHEMA

    assert SCHEMA == FREE_SCHEMA
    found = coarse(made)
    write_accuracy(found, tmp_path)
    evidence = read_evidence(made.scene, FILE, quantity=None, folder=tmp_path, effects=None, tolerance=0.01)
    row = next(r for r in tables(found)["budget"] if (r["error below"], r["of"]) == (0.01, "all"))
    choice = advise(evidence, 0.01).choice
    assert (choice.engine, choice.rungs["dt"].value) == (row["cheapest"], row["dt_fraction"])
    assert evidence.ladders["lammps"]["dt"].own.value == 0.0095
    assert evidence.ladders["lammps"]["dt"].beyond == (0.038,)


def test_pictures_are_the_same_every_time(made, tmp_path):
    for folder in ("a", "b"):
        write_accuracy(made, tmp_path / folder)
    assert (tmp_path / "a" / NAMES.pictures[1]).read_bytes() == (tmp_path / "b" / NAMES.pictures[1]).read_bytes()


def test_a_folder_in_the_way_is_found_before_anything_runs(tmp_path):
    (tmp_path / "slopes.csv").mkdir()
    with pytest.raises(InputError, match="slopes.csv"):
        NAMES.check(tmp_path)


def test_exit_status_asks_for_one_good_rung_of_each(made):
    from dataclasses import replace

    assert made.exit_status == 0
    dead = replace(made.tracks[0], points=made.tracks[0].points[:1])
    assert replace(made, tracks=(dead, *made.tracks[1:])).exit_status == 1
    missing = replace(made.tracks[0], points=(replace(made.tracks[0].points[0], status="unavailable"),))
    assert replace(made, tracks=(missing, *made.tracks[1:])).exit_status == 0
