"""An advice that was put to the test, as a page, tables, JSON and words: from numbers made up; and the command line."""

import csv
import dataclasses
import json
import math
from pathlib import Path

import numpy as np
import pytest

from harness.cli import main
from harness.report.advise import advise_answer, write_advice
from harness.report.advise_figure import advise_figure
from harness.report.advise_verified import (
    NOTHING,
    TABLES,
    result_rows,
    verification_data,
    verification_limits,
    verification_line,
)
from harness.report.advise_words import limits
from harness.studies.advise import Verification
from harness.studies.advise.verification import Side, difference_of, mean_and_error, verdict_of
from harness.studies.statistics.difference import Difference
from harness.verbs import advise as verb

ROOT = Path(__file__).resolve().parents[2]
FILE = ROOT / "inputs" / "scenes" / "biaxial_quick.toml"
ADVISED, FINEST = (24.0, 25.0, 26.5), (24.5, 25.5, 26.5)


def column(*values):
    return np.array(values, float)[:, None]


def side(name, values, **facts):
    mean, error = mean_and_error(column(*values))
    usual = {"settings": {"dt": 0.045, "stiffness": 0.25}, "without": (), "particles": 200, "steps": 1000,
             "status": "completed", "reason": "", "seconds": 5.0, "foretold_seconds": 4.0}
    return Side(name=name, values=column(*values), mean=mean, error=error, **(usual | facts))


def verified(advised=ADVISED, tolerance=0.05, **facts):
    """Three packings; the reference takes four times as long."""
    found = difference_of(column(*advised), column(*FINEST), 25.0, paired=True)
    verdict, why, needed = verdict_of(found, tolerance, "packings")
    usual = {
        "quantity": "friction_angle", "unit": "deg", "engine": "lammps", "free": False,
        "advised": side("advised", advised),
        "reference": side("reference", FINEST, seconds=20.0, foretold_seconds=15.0),
        "count": 3, "scale": 25.0, "over": "25 deg", "tolerance": tolerance, "difference": found, "expected": 0.04,
        "remaining": 0.015, "verdict": verdict, "why": why, "needed": needed,
    }
    return Verification(**(usual | facts))


@pytest.fixture
def advice(advised):
    return advised(0.05)


def rows(out, name):
    with (out / f"{name}.csv").open() as file:
        return list(csv.DictReader(file))


def test_page_json_and_tables_have_it(advice, tmp_path):
    found, out = verified(), tmp_path / "out"
    page = write_advice(advice, out, found).read_text()
    assert "All at once, as run" in page
    assert "not the limit" in page
    assert "--verify 3" in page
    told = json.loads((out / "advice.json").read_text())
    data = told["verification"]
    assert data["verdict"] == "agrees"
    assert data["difference"] == pytest.approx(-1.0 / 3.0 / 25.0)
    assert data["from_limit"] == pytest.approx(abs(data["difference"]) + data["bar"] + 0.015)
    assert (data["time_ratio"], data["foretold_time_ratio"]) == (0.25, pytest.approx(4.0 / 15.0))
    assert [s["values"] for s in data["sides"]] == [list(ADVISED), list(FINEST)]
    assert told["exit_status"] == 0
    (verdict,) = (r for r in rows(out, "verification") if r["what"] == "verdict")
    assert verdict["value"] == "agrees"
    assert [r["setting"] for r in rows(out, "verification_runs")] == ["advised", "reference"]
    each = rows(out, "verification_packings")
    assert [float(r["difference (%)"]) for r in each] == pytest.approx([-2.0, -2.0, 0.0])


def test_without_it_nothing_of_it_exists(advice, tmp_path):
    out = tmp_path / "out"
    write_advice(advice, out, verified())
    page = write_advice(advice, out).read_text()
    assert not [t for t in TABLES if (out / f"{t}.csv").exists()]
    assert "All at once, as run" not in page
    data = json.loads((out / "advice.json").read_text())
    assert "verification" not in data
    assert not [t for t in data["tables"] if t in TABLES]
    assert len(advise_figure(advice).axes) == 2
    assert len(advise_figure(advice, verified()).axes) == 3


def test_the_line_says_everything_once():
    line = verification_line(verified())
    assert "\n" not in line
    for words in (
        "Verified on 3 packings: agrees", "2.92 standard errors", "25.17 +- 0.73 deg (advised)",
        "-1.3 % +- 0.67 % apart", "expected error 4 %",
        "the reference itself is expected to be off by 1.5 %", "CPU time 0.25 of the reference's, foretold 0.27",
    ):
        assert words in line, words


def test_a_failed_reference_leaves_no_number(advice, tmp_path):
    lost = side("reference", (), status="crashed", reason="signal 6", seconds=None)
    found = verified(reference=dataclasses.replace(lost, values=np.empty((0, 1))), difference=None,
                     verdict="not_checked", why="the reference run is crashed: signal 6", needed=None)
    data = verification_data(found)
    assert (data["verdict"], data["difference"], data["bar"], data["time_ratio"]) == ("not_checked", None, None, None)
    assert data["exit_status"] == 1
    assert "has not been put to the test" in limits(advice, found)[0]
    json.dumps(advise_answer(advice, found).data, allow_nan=False)
    write_advice(advice, tmp_path / "out", found)
    assert [r["status"] for r in rows(tmp_path / "out", "verification_runs")] == ["completed", "crashed"]
    assert not rows(tmp_path / "out", "verification_packings")


def test_a_packing_without_a_value_is_a_gap():
    found = verified(advised=(24.0, math.nan, 26.5))
    assert verification_data(found)["sides"][0]["values"] == [24.0, None, 26.5]
    says = {r["what"]: r["says"] for r in result_rows(found)}
    assert says["friction_angle, advised"] == "mean over 2 packings; 1 have none"
    assert says["difference"].endswith("the same 2 packings")
    json.dumps(verification_data(found), allow_nan=False)


def test_limits_say_what_was_run_in_place_of_what_was_not(advice):
    assert "run the advised scene before relying on it" in limits(advice)[0]
    told = limits(advice, verified(untested=("dt",)))
    assert not any("run the advised scene" in s for s in told)
    assert any("not put to the test: dt" in s for s in told)
    assert "what knobs do to each other was not put to the test" in limits(advice, verified(joint=False))[0]
    for error, said in ((0.001, True), (0.02, False)):
        act = Difference(value=0.03, error=error, dof=2.0, count=3, paired=True)
        assert any("act on each other" in s for s in verification_limits(verified(together=act))) is said


def test_a_difference_ends_with_status_one(made_up_study, tmp_path, capsys, monkeypatch):
    folder, out = made_up_study(), tmp_path / "out"
    words = ["advise", str(FILE), "--tolerance", "0.05", "--from", str(folder), "--out", str(out), "--verify"]
    for advised, status in ((ADVISED, 0), ((14.0, 15.0, 16.5), 1)):
        monkeypatch.setattr(verb, "_verified", lambda *_, a=advised: verified(advised=a))
        assert main(words) == status
        said = capsys.readouterr().out
        assert f"Verified on 3 packings: {'differs' if status else 'agrees'}" in said
        assert "All at once, as run" in said


def test_no_choice_is_no_verification(made_up_study, tmp_path, capsys):
    folder, out = made_up_study(), tmp_path / "out"
    words = ["advise", str(FILE), "--tolerance", "0.002", "--from", str(folder), "--out", str(out), "--verify"]
    assert main(words) == 1
    assert NOTHING in capsys.readouterr().out.splitlines()
    assert not (out / "runs").exists()
    assert not (out / "verification.csv").exists()


@pytest.mark.parametrize(("scene", "words", "says"), [
    ("biaxial_quick.toml", ["--verify", "1"], "--verify: expected a number of packings from 2 to 1000, got 1"),
    ("biaxial_quick.toml", ["--verify", "few"], "--verify: expected a whole number from 1"),
    ("oblique_impact.toml", ["--verify", "4"], "--verify: expected no number for this kind of scene, got 4"),
])
def test_wrong_words_are_refused_in_one_line(scene, words, says, tmp_path, capsys):
    file = FILE.with_name(scene)
    try:
        status = main(["advise", str(file), "--tolerance", "0.05", "--out", str(tmp_path / "out"), *words])
    except SystemExit as end:
        status = end.code
    assert status == 2
    said = capsys.readouterr().err
    assert says in said
    assert said.count("\n") == 1
    assert not (tmp_path / "out").exists()
