"""The main job at its true size: minutes, so only in `make test-long`."""

from __future__ import annotations

import csv
import shutil
from pathlib import Path

import pytest

from harness.cli import main

SCENE = Path(__file__).parents[1] / "inputs" / "scenes" / "biaxial.toml"


@pytest.mark.long
@pytest.mark.skipif(shutil.which("liggghts") is None, reason="needs the liggghts binary: Debian's liggghts")
def test_biaxial_box_meets_its_declared_numbers_on_three_codes(tmp_path):
    """N = 1950, mu = 0.5: the windows of the scene, the side wall, and nothing that differs."""
    assert main(["compare", str(SCENE), "--out", str(tmp_path)]) == 0
    with open(tmp_path / "checks.csv", newline="") as f:
        checks = list(csv.DictReader(f))
    windows = [c for c in checks if "strain" in c["quantity"] and "up to" in c["quantity"]]
    assert {(c["left"], c["right"]) for c in windows} == {
        ("lammps", "kernel:lammps"), ("liggghts", "kernel:liggghts"), ("lammps", "liggghts"),
    }
    assert {c["verdict"] for c in windows} == {"agrees"}
    assert not [c for c in checks if c["verdict"] in ("differs", "not_checked")]
