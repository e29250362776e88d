"""The study as a whole, on kernels alone: matrices, exit status, files, and what wrong words are answered."""

import json
from dataclasses import replace

import pytest

from harness.cli import main
from harness.engines.registry import ENGINES
from harness.errors import InputError
from harness.report.law_tables import LEGEND, summary, tables
from harness.report.laws import above_asked, closing_words, laws_answer, part_name, write_laws_report
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
    forms = {"closed form", "closed form, stepped", "restitution_hysteretic"}
    assert {c.right for c in result.checks} == {*forms, "itself, plain frame"}
    assert {c.verdict for c in result.checks} == {"agrees"}


def test_files_hold_the_same_numbers(result, tmp_path):
    written = write_laws_report(result, tmp_path)
    folder = tmp_path / "parts" / "hysteretic,jkr_kernel-talk,kernel-lammps"
    assert written.page == folder / "laws.html"
    page = written.page.read_text()
    assert "Prescribed motion" in page
    assert "data:image/png;base64," in page
    assert written.picture.read_bytes().startswith(b"\x89PNG")
    data = json.loads((folder / "laws.json").read_text())
    assert data["exit_status"] == 0
    assert data["summary"] == summary(result)
    assert len(data["prescribed"]) == 4
    assert data["laws"]["hysteretic"]["normal"]["loading_stiffness"] == 5e4
    for name, rows in tables(result).items():
        assert (folder / f"laws_{name}.csv").read_text() == csv_text(rows)


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
    with pytest.raises(InputError, match=r"got hertz\+mindlim; did you mean hertz\+mindlin\?"):
        choose_laws(["hertz+mindlim"])


def whole(result):
    """The result as if it were about everything."""
    return replace(result, laws=tuple(CASES.values()), engines=tuple(ENGINES))


def test_a_part_never_takes_the_place_of_the_whole(result, tmp_path):
    assert (result.whole, whole(result).whole) == (False, True)
    page = tmp_path / "laws.html"
    page.write_text("the whole report")
    written = write_laws_report(result, tmp_path)
    assert page.read_text() == "the whole report"
    assert written.page.is_relative_to(tmp_path / "parts")
    assert "is not touched" in closing_words(result, written)


def test_parts_have_names_of_their_own(result):
    assert part_name(replace(result, engines=tuple(ENGINES))) == "hysteretic,jkr_all"
    many = replace(result, laws=tuple(CASES.values())[:20])
    assert part_name(many).startswith("20-laws_2-engines_")
    assert part_name(many) != part_name(replace(many, laws=many.laws[1:] + many.laws[:1]))
    assert len(part_name(many)) < 80


def test_marks_and_failures_are_explained_where_they_are_seen(result, tmp_path):
    written = write_laws_report(result, tmp_path)
    assert closing_words(result, written).startswith(LEGEND)
    assert "A star: " in written.page.read_text()
    cell = replace(result.prescribed[0], shown="failed", note="pairs in 2D: crashed: SIGSEGV (log in there)")
    broken = replace(result, prescribed=(cell, *result.prescribed[1:]))
    (row,) = laws_answer(broken).tables["What failed"]
    assert row == {
        "laws": "hysteretic", "engine": "kernel:talk", "where": "prescribed motion",
        "why": "pairs in 2D: crashed: SIGSEGV (log in there)",
    }
    page = write_laws_report(broken, tmp_path).page.read_text()
    assert "What failed" in page
    assert "SIGSEGV" in page
    assert summary(broken).endswith("; 1 cell failed")


def test_one_of_a_thing_is_one(result):
    assert summary(result).startswith("2 combinations of laws on 2 engines; ")
    assert summary(replace(result, laws=result.laws[:1], engines=("kernel:talk",))).startswith(
        "1 combination of laws on 1 engine; "
    )


def test_the_page_says_how_invariant_the_answers_are(result):
    rows = tables(result)["invariance"]
    assert [(r["laws"], r["dimension"]) for r in rows] == [("hysteretic", "2D"), ("hysteretic", "3D")]
    assert 0.0 < rows[1]["kernel:talk"] <= 1e-13
    assert above_asked(result).startswith("Above 1e-13 in 3D: nothing; all else in 3D changes by at most ")
    loud = [replace(c, deviation=2e-13) if getattr(c, "reason", "x") == "" else c for c in result.checks]
    said = above_asked(replace(result, checks=tuple(loud)))
    assert "kernel:talk, frame " in said
    assert "at most 2.0e-13" in said


def test_a_second_time_everything_is_there_already(tmp_path):
    """And nobody says that anything is started."""
    import io

    from harness.runs.progress import Lines

    words = choose_laws(["linear"]), [ENGINES["kernel:talk"]], tmp_path
    said = []
    for _ in range(2):
        stream = io.StringIO()
        prove_laws(*words, progress=lambda stream=stream: Lines(stream))
        said.append(stream.getvalue())
    assert "linear: 4 completed\n" in said[0]
    assert "started" not in said[1]
    assert "linear: 4 completed (4 kept from before)\n" in said[1]


@pytest.mark.parametrize("option", ["--law", "--laws"])
@pytest.mark.parametrize("engine", ["--engine", "--engines"])
def test_names_come_one_by_one_or_with_commas(option, engine, tmp_path, capsys, monkeypatch):
    from harness.studies.laws import study

    asked = []
    monkeypatch.setattr(study, "_driven", lambda laws, engines, *_: asked.append((laws, engines)) or 1 / 0)
    words = [option, "linear,dmt", option, "hertz", engine, "kernel:talk,kernel:lammps", "--out", str(tmp_path)]
    with pytest.raises(ZeroDivisionError):
        main(["laws", *words])
    ((laws, engines),) = asked
    assert [each.name for each in laws] == ["linear", "dmt", "hertz"]
    assert [e.name for e in engines] == ["kernel:talk", "kernel:lammps"]


def test_engines_are_named_alike_in_every_verb():
    from harness.cli import parser

    for words in (["--engines", "a,b"], ["--engine", "a", "--engine", "b"], ["--engines", "a", "--engine", "b"]):
        for verb in (["compare", "f.toml"], ["laws"]):
            assert parser().parse_args([*verb, *words]).engines == ["a", "b"]
    assert parser().parse_args(["run", "f.toml", "--engines", "a"]).engine == "a"


WRONG = [["--law", "nix"], ["--engine", "nix"], ["--engines", ","], ["--time-limit", "0"], ["--workers", "0"]]


@pytest.mark.parametrize("words", WRONG)
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
    assert (tmp_path / "parts" / "dmt_kernel-talk" / "laws.html").exists()
    assert not (tmp_path / "laws.html").exists()
