import json
import os

import numpy as np
import pytest

from harness.runs.atomic import write_json_atomic, write_text_atomic


def test_text_is_written_whole_and_nothing_else_left(tmp_path):
    path = tmp_path / "a.txt"
    write_text_atomic(path, "first")
    write_text_atomic(path, "κ_n\n")
    assert path.read_bytes() == "κ_n\n".encode()
    assert os.listdir(tmp_path) == ["a.txt"]


def test_a_failed_write_leaves_the_old_file(tmp_path, monkeypatch):
    path = tmp_path / "a.txt"
    write_text_atomic(path, "old")
    monkeypatch.setattr(os, "fsync", lambda handle: (_ for _ in ()).throw(OSError("disk full")))
    with pytest.raises(OSError, match="disk full"):
        write_text_atomic(path, "new")
    assert path.read_text() == "old"
    assert os.listdir(tmp_path) == ["a.txt"]


def test_new_files_have_the_permissions_of_any_new_file(tmp_path):
    write_text_atomic(tmp_path / "a", "")
    (tmp_path / "b").write_text("")
    assert (tmp_path / "a").stat().st_mode == (tmp_path / "b").stat().st_mode


def test_json_of_numpy_values_and_nan(tmp_path):
    value = {"n": np.int64(3), "x": np.array([[1.0, np.nan]]), "y": float("nan"), "t": (0.1, None), "p": tmp_path}
    write_json_atomic(tmp_path / "a.json", value)
    assert json.loads((tmp_path / "a.json").read_text()) == {
        "n": 3, "x": [[1.0, None]], "y": None, "t": [0.1, None], "p": str(tmp_path)
    }


def test_json_refuses_infinity_and_what_is_no_data(tmp_path):
    with pytest.raises(ValueError):
        write_json_atomic(tmp_path / "a.json", {"x": np.inf})
    with pytest.raises(TypeError):
        write_json_atomic(tmp_path / "a.json", {"x": object()})
    assert not os.listdir(tmp_path)
