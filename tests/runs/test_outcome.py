import json
import subprocess
import sys
from datetime import UTC, datetime

import msgspec
import pytest

from harness.runs.outcome import (
    Damaged,
    FileRecord,
    Outcome,
    describe_outcome,
    host_facts,
    read_outcome,
    write_outcome,
)


def outcome(**changes) -> Outcome:
    facts = {
        "status": "completed", "reason": "", "scene_name": "flight", "engine": "fake", "engine_version": "1.0",
        "harness_version": "0.1.0", "host": host_facts(), "system_digest": "a", "particles_digest": "b",
        "steps": 12, "particles": 2, "started": datetime(2024, 2, 29, 23, 59, 59, 123456, tzinfo=UTC),
        "finished": datetime(2024, 3, 1, tzinfo=UTC), "load_average": 0.5, "steps_done": 12,
        "deck_digest": "c", "timings": {"run": 0.1 + 0.2}, "cpu_seconds": 1 / 3, "wall_seconds": 0.5,
        "last_lines": ('say "αβ"', "\ufffd"), "reproduce": "cd x && y", "native": "kept as written",
        "trajectory": FileRecord(size=3, sha256="d"),
    }
    return Outcome(**facts | changes)


CRASH = {"status": "crashed", "reason": "SIGSEGV", "trajectory": None, "steps_done": 6}


@pytest.mark.parametrize("changes", [{}, CRASH, {"partial": ("sliding: partial: x",)}, {"warning": "swings grew"}])
def test_json_round_trip_is_exact(tmp_path, changes):
    path = tmp_path / "outcome.json"
    write_outcome(path, outcome(**changes))
    assert read_outcome(path) == outcome(**changes)


@pytest.mark.parametrize("damage", [
    lambda text: text[: len(text) // 2],
    lambda text: "",
    lambda text: text.replace('"completed"', '"fine"'),
    lambda text: text.replace('"steps": 12', '"steps": "12"'),
    lambda text: text.replace('"steps": 12,', ""),
    lambda text: text.replace('"steps": 12', '"steps": 12, "more": 1'),
    lambda text: text.replace('"completed"', '"crashed"'),
    lambda text: "[1, 2]",
])
def test_wrong_json_is_damaged(tmp_path, damage):
    path = tmp_path / "outcome.json"
    write_outcome(path, outcome())
    text = path.read_text()
    assert damage(text) != text
    path.write_text(damage(text))
    with pytest.raises(Damaged, match=r"outcome\.json is damaged"):
        read_outcome(path)


@pytest.mark.parametrize(("old", "new"), [
    ('"completed, slow"', '"completed, fast"'), ('"cpu_seconds": 0.3', '"cpu_seconds": 0.2'),
    ('"engine_version": "1.0"', '"engine_version": "1.1"'), ('"size": 3', '"size": 4'), ("23:59:59", "23:59:58"),
])
def test_an_edited_outcome_is_not_believed(tmp_path, old, new):
    path = tmp_path / "outcome.json"
    write_outcome(path, outcome(native="completed, slow"))
    assert old in path.read_text()
    path.write_text(path.read_text().replace(old, new))
    with pytest.raises(Damaged, match="is not what was written"):
        read_outcome(path)


def test_an_outcome_without_a_checksum_is_not_believed(tmp_path):
    path = tmp_path / "outcome.json"
    path.write_bytes(msgspec.json.encode(outcome()))
    with pytest.raises(Damaged, match=r"outcome\.json has no checksum"):
        read_outcome(path)


def test_bytes_that_are_no_text_are_damaged(tmp_path):
    (tmp_path / "outcome.json").write_bytes(b'{"status": "\xff\xfe"}')
    with pytest.raises(Damaged):
        read_outcome(tmp_path / "outcome.json")


@pytest.mark.parametrize("wrong", [
    {"trajectory": None}, {"reason": "but"}, CRASH | {"reason": ""}, {"timings": {"run": float("nan")}},
    {"timings": {"read": -1.0}},
])
def test_impossible_outcomes_are_refused(wrong):
    with pytest.raises(ValueError):
        outcome(**wrong)


def test_one_line_for_a_completed_run():
    assert describe_outcome(outcome()) == (
        "flight, fake 1.0: completed, 12 steps, 2 particles, 0.5 s (cpu 0.333 s)")
    assert describe_outcome(outcome(partial=("sliding: partial: x",))).endswith("partial: sliding: partial: x")


def test_failure_ends_with_the_reproduce_command():
    line = describe_outcome(outcome(**CRASH, last_lines=("Setting up", "ERROR: lost\n atoms")))
    assert line == ("flight, fake 1.0: crashed after step 6 of 12: SIGSEGV; last words: ERROR: lost atoms; "
                    "reproduce: cd x && y")


def test_the_same_words_are_said_once():
    said = "unstable: step 12, particle 1 moves 0.6 radii"
    line = describe_outcome(outcome(**CRASH | {"status": "unstable", "reason": said}, last_lines=("begin", said)))
    assert line == "flight, fake 1.0: unstable at step 12 of 12: particle 1 moves 0.6 radii; reproduce: cd x && y"


@pytest.mark.parametrize(("reason", "where"), [
    ("step 9: too fast", "at step 9 of 12: too fast;"), ("unstable: step 9: too fast", "at step 9 of 12: too fast;"),
    ("by step 9: it is gone", "by step 9 of 12: it is gone;"), ("it is gone", "after step 6 of 12: it is gone;"),
])
def test_a_failed_run_names_one_step(reason, where):
    line = describe_outcome(outcome(**CRASH | {"status": "unstable", "reason": reason}))
    assert f"unstable {where}" in line
    assert line.count(" step ") == 1


def test_refused_run_gives_its_reason():
    made = outcome(status="unavailable", reason="build it", trajectory=None, wall_seconds=None, cpu_seconds=None)
    assert describe_outcome(made) == "flight, fake 1.0: unavailable: build it"


def test_host_facts_are_of_this_machine():
    host = msgspec.to_builtins(host_facts())
    assert all(host.values())
    assert json.dumps(host)
    assert host["cores"] >= 1


def test_threads_find_the_types_ready(tmp_path):
    """What msgspec learns of a type at its first use is no business of several threads: a crash in one of twenty."""
    write_outcome(tmp_path / "outcome.json", outcome())
    code = (
        "import sys, msgspec._utils as u, pathlib\n"
        "from harness.runs.outcome import read_outcome\n"
        "u._get_class_mro_and_typevar_mappings = None  # whoever learns now, fails\n"
        "print(read_outcome(pathlib.Path(sys.argv[1])).status)\n"
    )
    command = [sys.executable, "-c", code, str(tmp_path / "outcome.json")]
    done = subprocess.run(command, capture_output=True, text=True, timeout=60)
    assert (done.returncode, done.stdout) == (0, "completed\n"), done.stderr


def test_a_warning_is_said_and_without_one_the_file_has_no_word_of_it(tmp_path):
    said = outcome(warning="swings could have grown")
    assert describe_outcome(said).endswith("; warning: swings could have grown")
    assert said.warnings == ("swings could have grown",)
    assert outcome().warnings == ()
    write_outcome(tmp_path / "outcome.json", outcome())
    assert "warning" not in (tmp_path / "outcome.json").read_text()
