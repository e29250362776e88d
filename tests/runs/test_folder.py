import json
from hashlib import sha256

import pytest

from harness.runs.folder import RunFolder, list_runs, runs_root


def folder_of(root, system, engine="fake", version="1.0"):
    return RunFolder.of(root, system, engine, version)


def test_name_is_readable_and_ends_with_the_hash_of_identity_json(root, system):
    folder = folder_of(root, system)
    folder.prepare({"deck.in": "run 12\n"})
    identity = json.loads((folder.path / "identity.json").read_text())
    digest = sha256(json.dumps(identity, sort_keys=True).encode()).hexdigest()
    assert folder.path == root / f"flight-fake-{digest[:12]}"
    assert identity["system"]["particles"] == system.particles_digest()


def test_everything_that_decides_the_result_is_in_the_name(root, system, make_system, monkeypatch):
    paths = {
        folder_of(root, system).path,
        folder_of(root, make_system(vx=1.5000000000000002)).path,
        folder_of(root, system.with_(dt=2e-3)).path,
        folder_of(root, system, engine="other").path,
        folder_of(root, system, version="1.1").path,
    }
    monkeypatch.setattr("harness.runs.folder.SCHEMA", -1)
    paths.add(folder_of(root, system).path)
    assert len(paths) == 6


def test_titles_are_not_part_of_the_content(root, system):
    assert folder_of(root, system).path == folder_of(root, system.with_(title="A title")).path


def test_no_scene_name_leads_out_of_the_root(root, system):
    path = folder_of(root, system.with_(scene_name="../../etc/x y")).path
    assert path.parent == root
    assert not path.name.startswith(".")


def test_prepare_leaves_nothing_of_the_old_run(root, system):
    folder = folder_of(root, system)
    folder.prepare({"deck.in": "a"})
    (folder.path / "old.log").write_text("old")
    folder.prepare({"deck.in": "b", "mesh/wall.stl": "c"})
    files = sorted(p.relative_to(folder.path).as_posix() for p in folder.path.rglob("*") if p.is_file())
    assert files == ["deck.in", "identity.json", "mesh/wall.stl"]
    assert (folder.path / "deck.in").read_text() == "b"
    assert not list((root / ".trash").iterdir())


def test_root_is_out_or_the_cache(tmp_path, monkeypatch):
    assert runs_root(tmp_path) == tmp_path / "runs"
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "xdg"))
    monkeypatch.delenv("GRAINPROOF_CACHE", raising=False)
    assert runs_root() == tmp_path / "xdg" / "grainproof" / "runs"
    monkeypatch.setenv("GRAINPROOF_CACHE", str(tmp_path / "own"))
    assert runs_root() == tmp_path / "own" / "runs"


def test_lock_is_freed_when_its_owner_fails(root, system):
    folder = folder_of(root, system)
    with pytest.raises(ZeroDivisionError), folder.lock():
        1 / 0  # noqa: B018
    with folder.lock():
        pass


def test_no_runs_in_an_absent_root(root):
    assert list_runs(root) == []
