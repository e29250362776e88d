"""A real ring on three codes, of a few hundred discs: half a minute, so only in `make test-long`."""

from __future__ import annotations

import csv
import shutil
from pathlib import Path

import pytest

from harness.cli import main

SCENE = Path(__file__).parents[1] / "inputs" / "scenes" / "couette_quick.toml"

SMALLER = (
    ("count = 817", "count = 253"), ("count = 130", "count = 40"), ("inner_radius = 0.0802", "inner_radius = 0.04"),
    ("outer_radius = 0.1552", "outer_radius = 0.085"), ("omega = 0.2 ", "omega = 0.5 "),
    ("duration = 40.0", "duration = 6.0"), ("samples = 4000", "samples = 600"), ("frames = 200", "frames = 60"),
    ("steady_from = 15.0", "steady_from = 2.0"), ("band = 0.04", "band = 0.03"), ("cells = 20", "cells = 12"),
)
"""The shipped scene with fewer discs and less time."""

WINDOWS = """
[[compare.windows]]
pairs = "same_conventions"
time = 0.3
tolerance = 1e-8

[[compare.windows]]
pairs = "codes"
time = 0.05
tolerance = 2e-3
"""
"""Measured: 1.1e-10 and 1.2e-11 to 0.5 s with the kernel in a code's conventions, 3.4e-4 between the codes."""


@pytest.mark.long
@pytest.mark.skipif(shutil.which("liggghts") is None, reason="needs the liggghts binary: Debian's liggghts")
def test_a_small_ring_is_followed_and_balanced_on_three_codes(tmp_path):
    text = SCENE.read_text()
    for old, new in SMALLER:
        assert old in text, old
        text = text.replace(old, new)
    scene = tmp_path / "ring.toml"
    scene.write_text(text + WINDOWS)
    assert main(["compare", str(scene), "--out", str(tmp_path / "out")]) == 0
    with open(tmp_path / "out" / "checks.csv", newline="") as f:
        checks = list(csv.DictReader(f))
    windows = [c for c in checks if "up to" in c["quantity"]]
    assert len(windows) == 3
    assert {c["verdict"] for c in windows} == {"agrees"}
    through = [c for c in checks if c["quantity"].startswith("2 pi r^2")]
    assert len(through) == 4
    assert {c["verdict"] for c in through} == {"agrees"}
    assert all(float(c["deviation"]) < 0.05 for c in through)
    assert {c["quantity"] for c in checks if c["level"] == "L3"} >= {"profile: velocity", "profile: stress"}
    assert (tmp_path / "out" / "overview.png").stat().st_size > 10_000
