"""One study from the command's words to page, tables and what is kept: friction, with tiny boxes, on the kernel."""

import json

import pytest

from harness.cli import main
from harness.report.reproduce import PAGE, page_folder, reproduce_data, write_reproduce
from harness.report.reproduce_keep import keep
from harness.studies.reproduce import friction, runs


@pytest.fixture
def small(tiny, monkeypatch):
    tiny(friction, 24, 0.02)
    monkeypatch.setattr(friction, "PRESSURES", {"quick": (100.0, 500.0)})
    monkeypatch.setattr(friction, "SERIES", {"quick": ()})


def test_friction(small, ask, tmp_path):
    asked = ask("quick", "kernel:talk", packings=1)
    result = friction.run(asked)
    assert not result.broken
    assert {r.ours.engine for r in result.rows} == {"kernel:talk"}
    assert all(r.verdict in ("inconclusive", "not_checked") for r in result.rows)  # a quick size decides nothing
    assert {p.setting for p in result.rates} == {f"T = {t:g} s" for t in friction.DURATIONS["quick"]}
    page = write_reproduce(friction.STUDY, asked, result)
    assert page == page_folder(friction.STUDY, asked) / PAGE
    assert "geometrical friction angle" in page.read_text()

    again = friction.run(asked)  # nothing is made twice, and the same comes of it
    assert [r.outcome.finished for r in again.runs] == [r.outcome.finished for r in result.runs]
    assert reproduce_data(friction.STUDY, asked, again)["rows"] == reproduce_data(friction.STUDY, asked, result)["rows"]

    place = keep(friction.STUDY, asked, result, tmp_path / "kept")
    assert place == tmp_path / "kept" / "friction"
    kept = json.loads((place / "result.json").read_text())
    assert kept["command"] == "grainproof reproduce friction --size quick --engines kernel:talk --packings 1"
    assert kept["versions"]["kernel:talk"]
    assert kept["runs"] == len(result.runs)
    assert not any(str(tmp_path) in f.read_text() for f in place.iterdir() if f.suffix in (".json", ".csv"))


def test_packings_are_shared_by_cases(small, ask, monkeypatch):
    asked = ask("quick", "kernel:talk", packings=1)
    made = []
    real = runs.prepare
    monkeypatch.setattr(runs, "prepare", lambda *a, **k: made.append(1) or real(*a, **k))
    planned = friction.cases(asked)
    starts = runs._starts(asked, planned)
    assert set(starts) == {c.name for c in planned}
    assert len(made) == 2  # one a pressure, whatever mu and the rate


def test_the_command_lists_and_refuses(capsys, tmp_path):
    assert main(["reproduce", "--list"]) == 0
    assert "cohesion" in capsys.readouterr().out
    assert main(["reproduce", "frictoin", "--out", str(tmp_path)]) == 2
    assert "did you mean friction" in capsys.readouterr().err
    assert main(["reproduce", "friction", "--measurements", "x.csv", "--out", str(tmp_path)]) == 2
    assert "takes no measurements" in capsys.readouterr().err
    assert not list(tmp_path.iterdir())
