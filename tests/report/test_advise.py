"""Advice as a page, tables, JSON and a scene, from a study made up of numbers; and the command line."""

import json
from pathlib import Path

import pytest

from harness.cli import main
from harness.report.advise import NAMES, advise_answer, write_advice
from harness.report.advise_words import limits, paragraph
from harness.scene.load import load_scene

ROOT = Path(__file__).resolve().parents[2]
FILE = ROOT / "inputs" / "scenes" / "biaxial_quick.toml"
WIDTH = {"width": {0.005: (-0.004, 0.001, 10.0), 0.0025: (-0.001, 0.001, 10.0)}}


def test_everything_is_written_and_the_scene_loads(advised, tmp_path):
    advice = advised(0.05, WIDTH)
    write_advice(advice, tmp_path / "out")
    for name in (NAMES.page, "advice.json", "advice.png", "advised.toml", *(f"{t}.csv" for t in NAMES.tables)):
        assert (tmp_path / "out" / name).stat().st_size > 0
    made = load_scene(tmp_path / "out" / "advised.toml")
    assert made == advice.scene
    data = json.loads((tmp_path / "out" / "advice.json").read_text())
    assert data["kept"] is True
    assert data["origin"] == {"dt": "measured", "stiffness": "measured"}
    assert data["expected_error"] <= 0.05


def test_words_say_what_was_measured_and_what_is_not_known(advised):
    advice = advised(0.05, WIDTH)
    words, told = paragraph(advice), " ".join(limits(advice))
    assert "friction_angle within 5 %" in words
    assert "below the statistical floor: one packing scatters by 8 %" in words
    assert "measured rungs of dt, stiffness" in words
    assert "rate, size as declared, not measured" in words
    assert "is not counted" in told
    assert "Not measured, so in no sum: rate, size." in told


def test_the_sum_is_that_of_its_parts(advised):
    advice = advised(0.05, WIDTH)
    first = advise_answer(advice).data["tables"]["sum"][0]
    assert first["CPU of all (s)"] == first["CPU of one (s)"] * first["packings"]
    assert first["expected error (%)"] <= 5.0
    rows = {r["what"]: r for r in advise_answer(advice).data["tables"]["advice"]}
    assert rows["rate, times the scene's"]["take"] is None
    json.dumps(advise_answer(advice).data, allow_nan=False)


def test_without_an_answer_no_scene_is_left(advised, tmp_path):
    out = tmp_path / "out"
    write_advice(advised(0.05, WIDTH), out)
    none = advised(0.002, WIDTH)
    write_advice(none, out)
    assert not (out / "advised.toml").exists()
    assert "No setting is known that keeps friction_angle" in (out / NAMES.page).read_text()
    assert json.loads((out / "advice.json").read_text())["kept"] is False


def test_an_extrapolated_setting_is_called_so(advised):
    advice = advised(0.013, WIDTH, order=2.0)
    assert advice.choice is not None
    words = paragraph(advice) + " ".join(limits(advice))
    assert "extrapolated ones of" in words
    assert "beyond what was run" in words
    rows = advise_answer(advice).data["tables"]["advice"]
    assert any(r["known from"].startswith("extrapolated: error ~ x^2") for r in rows)


def test_the_command_line_gives_advice(made_up_study, tmp_path, capsys):
    folder = made_up_study(WIDTH)
    words = ["advise", str(FILE), "--tolerance", "0.05", "--quantity", "friction_angle", "--from", str(folder)]
    assert main([*words, "--out", str(tmp_path / "out")]) == 0
    said = capsys.readouterr().out
    assert "What to take" in said
    assert "For friction_angle within 5 %: lammps with dt_fraction" in said
    assert main([*words, "--out", str(tmp_path / "out"), "--json", "-"]) == 0
    assert json.loads(capsys.readouterr().out)["engine"] == "lammps"
    strict = ["advise", str(FILE), "--tolerance", "0.002", "--from", str(folder), "--out", str(tmp_path / "out")]
    assert main(strict) == 1


def test_words_that_a_finished_study_cannot_follow_are_refused(made_up_study, tmp_path, capsys):
    folder = made_up_study(WIDTH, engines=("lammps", "liggghts"), dearer={"lammps": 2.0})
    out = tmp_path / "out"
    words = ["advise", str(FILE), "--tolerance", "0.05", "--from", str(folder), "--out", str(out)]
    for more, says in (
        (["--packings", "4"], "--packings: expected nothing beside --from, got 4"),
        (["--engines", "kernel:talk"], "--engines: expected some of lammps, liggghts"),
    ):
        assert main([*words, *more]) == 2
        said = capsys.readouterr().err
        assert says in said
        assert said.count("\n") == 1
        assert not out.exists()
    for engines in ("lammps", "liggghts"):
        assert main([*words, "--engines", engines]) == 0
        assert json.loads((out / "advice.json").read_text())["engine"] == engines
        assert f"--engines {engines} --out {out}" in (out / NAMES.page).read_text()


@pytest.mark.parametrize(
    ("words", "says"),
    [
        (["--tolerance", "0"], "--tolerance: expected a number > 0"),
        (["--tolerance", "-1"], "--tolerance: expected a number > 0"),
        (["--tolerance", "0.01", "--quantity", "friction"], "--quantity: expected one of friction_angle"),
        (["--tolerance", "0.01", "--from", "nowhere"], "run grainproof accuracy first"),
        (["--tolerance", "x"], "invalid float value"),
    ],
)
def test_wrong_words_are_refused_in_one_line(words, says, tmp_path, capsys):
    try:
        status = main(["advise", str(FILE), "--out", str(tmp_path / "out"), *words])
    except SystemExit as end:
        status = end.code
    assert status == 2
    said = capsys.readouterr().err
    assert says in said
    assert said.count("\n") == 1
    assert not (tmp_path / "out").exists()
