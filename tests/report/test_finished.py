"""A report read again is the report that was written; anything else is refused in one line."""

import json

import pytest

from harness.errors import InputError
from harness.report.compare import check_rows, run_rows, write_report
from harness.report.finished import read_finished


@pytest.fixture
def written(free, tmp_path):
    comparison = free(does="abort")
    write_report(comparison, tmp_path / "report")
    return comparison, tmp_path / "report"


def test_what_was_written_is_read(written):
    comparison, folder = written
    for place in (folder, folder / "report.json"):
        read = read_finished(place)
        assert read.checks == comparison.checks
        assert [(r.engine, r.packing, r.outcome) for r in read.runs] == [
            (r.engine, r.packing, r.outcome) for r in comparison.runs]
        assert (read.title, read.exit_status) == ("flight", 1)
        assert (check_rows(read), run_rows(read)) == (check_rows(comparison), run_rows(comparison))
        assert read.tables["exits"]


def damage(folder, change):
    data = json.loads((folder / "report.json").read_text())
    change(data)
    (folder / "report.json").write_text(json.dumps(data))


@pytest.mark.parametrize(("change", "said"), [
    (lambda d: d["tables"].pop("runs"), "no table of runs"),
    (lambda d: d["checks"][0].update(verdict="maybe"), "verdict"),
    (lambda d: d["runs"].pop(), "shorter"),
    (lambda d: d.pop("scene"), "scene"),
    (lambda d: d["runs"][0].update(status="completed", trajectory=None), "trajectory"),
    (lambda d: (d["runs"].clear(), d["tables"]["runs"].clear()), "without any run"),
])
def test_a_damaged_report_is_refused(written, change, said):
    _, folder = written
    damage(folder, change)
    with pytest.raises(InputError, match=said) as raised:
        read_finished(folder)
    assert "\n" not in str(raised.value)


@pytest.mark.parametrize("text", ["", "[]", "null", "{", "[" * 100_000, "\xff"])
def test_a_file_that_is_none_is_refused(tmp_path, text):
    (tmp_path / "report.json").write_bytes(text.encode("latin-1"))
    with pytest.raises(InputError, match="none or damaged"):
        read_finished(tmp_path)


def test_a_place_without_a_report_is_refused(tmp_path):
    with pytest.raises(InputError, match="no report.json there"):
        read_finished(tmp_path)
    with pytest.raises(InputError, match="^--against .*/nowhere: .*nothing there"):
        read_finished(tmp_path / "nowhere", option="--against")
