"""The study as a whole, on kernels alone: matrices, exit status, files, and what wrong words are answered."""

import json
from dataclasses import replace

import pytest

from harness.cli import main
from harness.engines.registry import ENGINES
from harness.errors import InputError
from harness.report.laws import laws_answer, summary, tables, write_laws_report
from harness.report.tables import csv_text
from harness.studies.laws import choose_laws, prove_laws
from harness.studies.laws.cases import CASES
from harness.studies.laws.study import with_kernels


@pytest.fixture(scope="module")
def result(tmp_path_factory):
    """A frictionless combination and one that no kernel takes, on two kernels."""
    kernels = [ENGINES["kernel:talk"], ENGINES["kernel:lammps"]]
    return prove_laws(choose_laws(["hysteretic", "jkr"]), kernels, tmp_path_factory.mktemp("out"), workers=2)


def test_every_cell_is_there_and_says_what_it_is(result):
    shown = {(c.laws, c.engine): c.text for c in result.prescribed}
    assert shown == {
        ("hysteretic", "kernel:talk"): "0", ("hysteretic", "kernel:lammps"): "0",
        ("jkr", "kernel:talk"): "unsupported", ("jkr", "kernel:lammps"): "unsupported",
    }
    assert {(c.laws, c.shown) for c in result.collisions} == {("hysteretic", "measured"), ("jkr", "unsupported")}
    assert [x.engine for x in result.exits] == ["kernel:talk", "kernel:lammps"]


def test_exit_status(result):
    assert result.exit_status == 0
    wrong = replace(result.checks[0], verdict="differs")
    assert replace(result, checks=(*result.checks, wrong)).exit_status == 1
    broken = replace(result.prescribed[0], shown="failed", deviation=None)
    assert replace(result, prescribed=(broken,)).exit_status == 1
    assert replace(result, checks=()).exit_status == 1


def test_frames_and_closed_forms_are_among_the_checks(result):
    assert {c.right for c in result.checks} == {"closed form", "itself, plain frame", "restitution_hysteretic"}
    assert {c.verdict for c in result.checks} == {"agrees"}


def test_files_hold_the_same_numbers(result, tmp_path):
    written = write_laws_report(result, tmp_path)
    page = written.page.read_text()
    assert "Prescribed motion" in page
    assert "data:image/png;base64," in page
    assert written.picture.read_bytes().startswith(b"\x89PNG")
    data = json.loads((tmp_path / "laws.json").read_text())
    assert data["exit_status"] == 0
    assert data["summary"] == summary(result)
    assert len(data["prescribed"]) == 4
    assert data["laws"]["hysteretic"]["normal"]["loading_stiffness"] == 5e4
    for name, rows in tables(result).items():
        assert (tmp_path / f"laws_{name}.csv").read_text() == csv_text(rows)


def test_what_people_see(result):
    shown = laws_answer(result).tables
    (matrix, _, impacts) = shown.values()
    assert matrix[1] == {"laws": "jkr", "kernel:talk": "unsupported", "kernel:lammps": "unsupported"}
    assert impacts[0]["kernel:talk"] == pytest.approx(0.57735, rel=1e-3)
    wrong = replace(result, checks=(replace(result.checks[0], verdict="differs"),))
    assert "What differs" in laws_answer(wrong).tables


def test_a_code_brings_the_kernel_in_its_conventions():
    assert [e.name for e in with_kernels([ENGINES["lammps"]])] == ["lammps", "kernel:lammps"]
    assert [e.name for e in with_kernels([ENGINES["kernel:talk"]])] == ["kernel:talk"]


def test_laws_are_chosen_by_name():
    assert [each.name for each in choose_laws([])] == list(CASES)
    assert [each.name for each in choose_laws(["hertz", "hertz"])] == ["hertz"]
    with pytest.raises(InputError, match="--law: expected one of linear, .* got nix"):
        choose_laws(["nix"])


@pytest.mark.parametrize("words", [["--law", "nix"], ["--engine", "nix"], ["--time-limit", "0"], ["--workers", "0"]])
def test_wrong_words_are_refused(words, tmp_path, capsys):
    try:
        status = main(["laws", *words, "--out", str(tmp_path / "out")])
    except SystemExit as stop:
        status = stop.code
    assert status == 2
    assert len(capsys.readouterr().err.strip().splitlines()) == 1
    assert not (tmp_path / "out").exists()


def test_the_command_proves_and_writes(tmp_path, capsys):
    words = ["laws", "--law", "dmt", "--engine", "kernel:talk", "--out", str(tmp_path), "--json", "-"]
    assert main(words) == 0
    data = json.loads(capsys.readouterr().out)
    assert {c["engine"] for c in data["prescribed"]} == {"kernel:talk"}
    assert (tmp_path / "laws.html").exists()
