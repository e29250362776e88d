"""Committed decks: written, verified, and those of the shipped scenes are current."""

import hashlib
from pathlib import Path

import pytest

from harness.engines.registry import ENGINES
from harness.errors import InputError
from harness.studies.decks import (
    LARGEST,
    check_decks,
    default_decks_folder,
    rendered_decks,
    shipped_scenes,
    write_decks,
)

HEAD_ON = next(p for p in shipped_scenes() if p.stem == "head_on")


@pytest.fixture(scope="module")
def decks():
    return rendered_decks([HEAD_ON])


def states(rows):
    return {f"{r['scene']}/{r['file']}": r["state"] for r in rows}


def test_decks_of_the_shipped_scenes_are_current():
    """`grainproof decks` rewrites them."""
    rows = check_decks(rendered_decks(shipped_scenes()), default_decks_folder(), whole=True)
    assert {name: state for name, state in states(rows).items() if state != "current"} == {}


def test_every_engine_that_takes_the_scene_has_its_deck(decks):
    assert {name.split("/")[1] for name in decks} == {name.replace(":", "-") for name in ENGINES}
    assert all(name.startswith("head_on/") for name in decks)


def test_decks_are_deterministic_and_name_no_place_of_this_machine(decks):
    assert rendered_decks([HEAD_ON]) == decks
    assert not [name for name, text in decks.items() for p in ("/work", "/tmp", "/root", str(Path.home())) if p in text]


def test_writing_then_checking_is_current(decks, tmp_path):
    assert set(states(check_decks(decks, tmp_path, whole=True)).values()) == {"missing"}
    assert set(states(write_decks(decks, tmp_path, whole=True, remove=False)).values()) == {"written"}
    assert set(states(check_decks(decks, tmp_path, whole=True)).values()) == {"current"}
    before = {p: p.stat().st_mtime_ns for p in tmp_path.rglob("*")}
    assert set(states(write_decks(decks, tmp_path, whole=True, remove=True)).values()) == {"current"}
    assert {p: p.stat().st_mtime_ns for p in tmp_path.rglob("*")} == before


def test_stale_missing_and_left_over_are_found_and_mended(decks, tmp_path):
    write_decks(decks, tmp_path, whole=True, remove=True)
    stale, missing, *_ = (tmp_path / name for name in decks)
    extra = tmp_path / "head_on" / "lammps" / "old.in"
    elsewhere = tmp_path / "gone" / "lammps" / "in.lammps"
    elsewhere.parent.mkdir(parents=True)
    stale.write_bytes(stale.read_bytes().replace(b"\n", b"\r\n", 1))
    missing.unlink()
    extra.write_text("")
    elsewhere.write_text("")
    wrong = {name: s for name, s in states(check_decks(decks, tmp_path, whole=True)).items() if s != "current"}
    assert wrong == {
        str(stale.relative_to(tmp_path)): "stale", str(missing.relative_to(tmp_path)): "missing",
        "head_on/lammps/old.in": "left over", "gone/lammps/in.lammps": "left over",
    }
    write_decks(decks, tmp_path, whole=True, remove=True)
    assert not extra.exists()
    assert not elsewhere.exists()
    assert set(states(check_decks(decks, tmp_path, whole=True)).values()) == {"current"}


def test_a_folder_of_the_users_keeps_what_is_not_a_deck(decks, tmp_path):
    """A comparison's results may lie where decks are written: nothing of them is touched or called left over."""
    mine = [tmp_path / "head_on" / "report.html", tmp_path / "head_on" / "runs" / "x", tmp_path / "other" / "y"]
    inside = tmp_path / "head_on" / "lammps" / "notes.txt"
    for path in (*mine, inside):
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text("mine")
    rows = states(write_decks(decks, tmp_path, whole=False, remove=False))
    assert {n for n, s in rows.items() if s != "written"} == {"head_on/lammps/notes.txt"}
    assert all(path.read_text() == "mine" for path in (*mine, inside))


def test_large_files_are_kept_as_their_hash(decks, monkeypatch):
    """What is kept of them is what sha256sum prints."""
    monkeypatch.setattr("harness.studies.decks.LARGEST", 700)
    shorter = rendered_decks([HEAD_ON])
    kept = {name.removesuffix(".sha256") for name in shorter if name.endswith(".sha256")}
    assert kept == {name for name, text in decks.items() if len(text.encode()) > 700}
    assert 0 < len(kept) < len(decks)
    for name in kept:
        digest = hashlib.sha256(decks[name].encode()).hexdigest()
        assert shorter[f"{name}.sha256"] == f"{digest}  {Path(name).name}\n"


def test_the_small_box_is_kept_whole_and_the_full_one_is_not():
    """Two hundred discs stand in git as they are, 1950 as their hash."""
    names = {str(p.relative_to(default_decks_folder())) for p in default_decks_folder().rglob("*") if p.is_file()}
    assert {"biaxial_quick/lammps/packing.data", "biaxial/lammps/packing.data.sha256"} <= names
    assert max((default_decks_folder() / name).stat().st_size for name in names) <= LARGEST


def test_two_scenes_of_one_name_are_refused(tmp_path):
    again = tmp_path / "head_on.toml"
    again.write_text(HEAD_ON.read_text())
    with pytest.raises(InputError, match="expected scenes of different names, got head_on again"):
        rendered_decks([HEAD_ON, again])


def test_a_scene_cannot_name_a_folder_outside(tmp_path):
    odd = tmp_path / "...toml"
    odd.write_text(HEAD_ON.read_text())
    assert all(name.startswith("scene/") for name in rendered_decks([odd]))
