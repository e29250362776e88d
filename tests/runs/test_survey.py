"""What is kept, what could go, and that nothing else is ever touched."""

import json
import threading

import msgspec
import pytest

from harness.errors import InputError
from harness.report.status import clean_answer, status_answer
from harness.runs.execute import run_one
from harness.runs.folder import RunFolder
from harness.runs.survey import remove, survey

LIMIT = 60.0


@pytest.fixture
def made(in_mode, make_system, root):
    """made("complete", "exit") runs these and returns outcomes and folders."""
    return lambda *modes: [
        run_one(in_mode(m), make_system(vx=1.0 + k), root, time_limit=LIMIT) for k, m in enumerate(modes)
    ]


def states(root, report=None):
    return {k.folder: (k.state, k.needless) for k in survey(root, report or root / "none.json")}


def test_without_a_report_every_run_that_ended_stays(made, root):
    (_, good), (_, bad), (_, cut), (_, edited) = made("complete", "exit", "complete", "complete")
    (cut / "outcome.json").unlink()
    (edited / "outcome.json").write_text("{}")
    assert states(root) == {
        good: ("completed", ""), bad: ("crashed", ""), cut: ("unfinished", "unfinished"),
        edited: ("damaged", "damaged"),
    }
    notes = {k.folder: k.note for k in survey(root, root / "none.json")}
    assert "exit status 3" in notes[bad]
    assert notes[edited].startswith("outcome.json is damaged")


def test_a_report_says_what_is_needed(made, root, tmp_path):
    (outcome, good), (_, old) = made("complete", "complete")
    report = tmp_path / "report.json"
    report.write_text(json.dumps({"runs": [msgspec.to_builtins(outcome)]}))
    assert states(root, report) == {good: ("completed", ""), old: ("completed", "not in the report")}
    report.write_text("[]")
    assert {why for _, why in states(root, report).values()} == {""}


def test_a_run_under_way_is_left_alone(made, root):
    ((_, folder),) = made("complete")
    (folder / "outcome.json").unlink()
    with RunFolder.at(folder).lock():
        assert states(root) == {folder: ("under way", "")}
    found = survey(root, root / "none.json")
    taken, freed = threading.Event(), threading.Event()

    def somebody():
        with RunFolder.at(folder).lock():
            taken.set()
            freed.wait(60)

    thread = threading.Thread(target=somebody)
    thread.start()
    taken.wait(60)
    assert remove(found) == []
    freed.set()
    thread.join(60)
    assert remove(found) == found
    assert not folder.exists()


def test_sizes_are_of_all_files(made, root):
    ((_, folder),) = made("complete")
    (kept,) = survey(root, root / "none.json")
    assert kept.size == sum(f.stat().st_size for f in folder.iterdir())


def test_links_and_strangers_are_not_ours(made, root, tmp_path):
    ((_, folder),) = made("complete")
    (tmp_path / "precious").mkdir()
    (tmp_path / "precious" / "identity.json").write_text("{}")
    (root / f"link-{'0' * 12}").symlink_to(tmp_path / "precious")
    (root / "notes").mkdir()
    (root / "notes" / "identity.json").write_text("{}")
    assert list(states(root)) == [folder]


def test_clean_shows_first_and_deletes_when_told(made, root, tmp_path):
    (_, good), (_, cut) = made("complete", "complete")
    (cut / "outcome.json").unlink()
    for _ in range(2):
        (row,) = clean_answer(tmp_path, really=False).data["needless"]
        assert (row["run"], row["could go"]) == (cut.name, "unfinished")
        assert cut.exists()
    (row,) = clean_answer(tmp_path, really=True).data["deleted"]
    assert row["run"] == cut.name
    assert not cut.exists()
    assert good.exists()
    assert not list((root / ".trash").iterdir())
    assert clean_answer(tmp_path, really=True).data == {"deleted": []}


def test_looking_writes_nothing(made, root, tmp_path):
    made("complete")
    for lock in (root / ".locks").iterdir():
        lock.unlink()
    (root / ".locks").rmdir()
    before = sorted(tmp_path.rglob("*"))
    status_answer(tmp_path)
    clean_answer(tmp_path, really=False)
    assert sorted(tmp_path.rglob("*")) == before


def test_status_counts_and_sums(made, tmp_path):
    made("complete", "exit", "complete")
    data = status_answer(tmp_path).data
    assert {(t["state"], t["runs"]) for t in data["totals"]} == {("completed", 2), ("crashed", 1)}
    assert sum(t["size (MB)"] for t in data["totals"]) == pytest.approx(sum(r["size (MB)"] for r in data["runs"]))


@pytest.mark.parametrize("place", ["nowhere", "."])
def test_a_folder_without_runs_is_refused(tmp_path, place):
    with pytest.raises(InputError, match="a results folder"):
        status_answer(tmp_path / place)
