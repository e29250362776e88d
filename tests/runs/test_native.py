import gzip
import os

import numpy as np

from harness.runs.native import LARGE, settle_native


def make_folder(folder):
    text = "\n".join(f"{v:.17g}" for v in np.random.default_rng(1).random(LARGE // 16)).encode()
    sub = folder / "post"
    sub.mkdir()
    for path in (folder / "data.in", folder / "run.log", sub / "dump.1"):
        path.write_bytes(text)
    (folder / "small.txt").write_text("few")
    return text


def names(folder):
    return sorted(p.relative_to(folder).as_posix() for p in folder.rglob("*") if p.is_file())


def test_gzip_keeps_every_byte_and_leaves_decks_and_small_files(tmp_path):
    text = make_folder(tmp_path)
    said = settle_native(tmp_path, keep={"data.in"}, policy="gzip")
    assert names(tmp_path) == ["data.in", "post/dump.1.gz", "run.log.gz", "small.txt"]
    assert gzip.decompress((tmp_path / "post/dump.1.gz").read_bytes()) == text
    assert (tmp_path / "data.in").read_bytes() == text
    assert "dump.1 compressed" in said
    assert "run.log compressed" in said


def test_drop_deletes_dumps_but_no_log(tmp_path):
    make_folder(tmp_path)
    said = settle_native(tmp_path, keep={"data.in"}, policy="drop")
    assert names(tmp_path) == ["data.in", "run.log.gz", "small.txt"]
    assert "dump.1 deleted" in said


def test_plain_and_small_are_left_alone(tmp_path):
    make_folder(tmp_path)
    before = names(tmp_path)
    assert settle_native(tmp_path, keep=(), policy="plain") == "kept as written"
    assert names(tmp_path) == before
    os.remove(tmp_path / "run.log")
    os.remove(tmp_path / "post/dump.1")
    assert settle_native(tmp_path, keep={"data.in"}, policy="gzip") == "kept as written"


def test_compressing_twice_changes_nothing(tmp_path):
    make_folder(tmp_path)
    settle_native(tmp_path, keep=(), policy="gzip")
    before = {p: (tmp_path / p).read_bytes() for p in names(tmp_path)}
    settle_native(tmp_path, keep=(), policy="gzip")
    assert {p: (tmp_path / p).read_bytes() for p in names(tmp_path)} == before


def test_numbers_in_binary_stay_as_no_reader_opens_them_compressed(tmp_path):
    (tmp_path / "frames.h5").write_bytes(bytes(LARGE))
    (tmp_path / "dump.txt").write_bytes(bytes(LARGE))
    said = settle_native(tmp_path, keep=(), policy="gzip")
    assert (tmp_path / "frames.h5").read_bytes() == bytes(LARGE)
    assert "frames.h5" not in said
    assert (tmp_path / "dump.txt.gz").is_file()
    assert "frames.h5 deleted" in settle_native(tmp_path, keep=(), policy="drop")
