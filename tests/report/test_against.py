"""`grainproof report`: tables for people, the same as JSON, a page; exit status and one line for what is wrong."""

import json

import pytest

from harness.cli import main
from harness.report.against import page
from harness.report.compare import write_report
from harness.report.difference import difference


@pytest.fixture
def reports(free, flight, obedient, tmp_path):
    """Folders of two reports: in the new one b is off by a thousand times more, and a third engine is there."""
    from harness.studies.compare import compare

    write_report(free(), tmp_path / "old")
    engines = (obedient("a"), obedient("b", off=1e-3), obedient("third", does="abort"))
    write_report(compare(flight, engines, tmp_path / "runs of new", time_limit=60.0), tmp_path / "new")
    return tmp_path / "old", tmp_path / "new"


@pytest.fixture
def call(capsys):
    def made(*words):
        status = main(["report", *map(str, words)])
        return status, *capsys.readouterr()

    return made


def test_a_finished_report_is_shown_and_its_exit_status_is_its_own(reports, call, capsys):
    for folder in reports:
        status, out, err = call(folder)
        assert status == json.loads((folder / "report.json").read_text())["exit_status"]
        assert [t for t in ("Runs", "Time and cost", "Versions", "Verdicts") if f"{t}\n" in out] == [
            "Runs", "Time and cost", "Versions", "Verdicts"]
        assert "flight: 2 particles" in out
        assert err == ""


def test_a_difference_is_said_in_three_ways(reports, call):
    old, new = reports
    status, out, _ = call(new, "--against", old)
    assert status == 0
    assert "Deviations that changed by more than rounding" in out
    assert out.splitlines()[-1] == f"report: {new / 'difference.html'}"
    assert "runs: 1 appeared" in out
    data = json.loads((new / "difference.json").read_text())
    assert data["deviations"][0]["new over old"] == pytest.approx(1000.0, rel=0.01)
    assert data["runs"][0]["engine"] == "third"
    html = (new / "difference.html").read_text()
    assert "No verdict got worse" in html
    assert "<h2>Deviations that changed by more than rounding</h2>" in html
    status, out, _ = call(new, "--against", old / "report.json", "--json", "-")
    assert json.loads(out) == data


def test_a_worse_verdict_is_exit_status_1_with_its_command_first(reports, call):
    old, new = reports
    stored = json.loads((new / "report.json").read_text())
    good = next(c for c in json.loads((old / "report.json").read_text())["checks"] if c["verdict"] == "not_checked")
    bad = next(c for c in stored["checks"] if (c["quantity"], c["left"]) == (good["quantity"], good["left"]))
    bad |= {"verdict": "differs", "why": "too far; rerun: grainproof compare <x>"}
    (new / "report.json").write_text(json.dumps(stored))
    status, out, _ = call(new, "--against", old)
    assert status == 1
    assert "1 worse" in out
    html = (new / "difference.html").read_text()
    assert html.index("What got worse") < html.index("<pre>grainproof compare &lt;x&gt;</pre>") < html.index("<h2>Cost")


def test_a_run_that_no_longer_completes_comes_with_its_command(finished_report, check, ran):
    old = finished_report([check()], name="old")
    new = finished_report([check()], runs=[ran("a"), ran("b", status="crashed", reproduce="cd x && y")])
    html = page(difference(old, new))
    assert "b, packing 1: completed -&gt; crashed" in html
    assert "<pre>cd x &amp;&amp; y</pre>" in html


@pytest.mark.parametrize("words", [["nowhere"], ["new", "--against", "nowhere"], ["new", "--against", "new"]])
def test_wrong_places_are_one_line_and_exit_status_2(reports, call, tmp_path, monkeypatch, words):
    monkeypatch.chdir(tmp_path)
    status, out, err = call(*words)
    assert (status, out) == (2, "")
    assert err.count("\n") == 1
    assert err.startswith("grainproof: ")
    assert not (tmp_path / "new" / "difference.html").exists()


def test_json_is_never_written_onto_a_report_that_is_read(reports, call):
    old, new = reports
    for target in (old, new):
        before = (target / "report.json").read_bytes()
        status, _, err = call(new, "--against", old, "--json", target / "report.json")
        assert status == 2
        assert "does not read" in err
        assert (target / "report.json").read_bytes() == before
