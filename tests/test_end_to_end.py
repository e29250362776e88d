"""The shipped collisions and a short, small biaxial box on the real codes, by the command line."""

import contextlib
import csv
import io
import json
import re
import shutil
from dataclasses import dataclass
from pathlib import Path

import pytest

from harness.cli import main
from harness.engines.registry import ENGINES

SCENES = Path(__file__).resolve().parents[1] / "inputs" / "scenes"
HERE = {name for name, engine in ENGINES.items() if engine.probe().available}
needs_all = pytest.mark.skipif(not {"lammps", "liggghts"} <= HERE, reason="needs LAMMPS and LIGGGHTS")

SHORTER = {
    r"count = \d+": "count = 40", r"final_strain = [\d.]+": "final_strain = 0.004",
    r"duration = [\d.]+": "duration = 0.005", r"samples = \d+": "samples = 40", r"frames = \d+": "frames = 4",
    r"strains = \[.*": "strains = [0.002]", r"plateau = \[.*": "",
}
"""What makes the quick box shorter; the strain rate and with it the inertial number get smaller."""


@dataclass(frozen=True)
class Said:
    status: int
    out: str
    folder: Path

    @property
    def data(self) -> dict:
        return json.loads((self.folder / "report.json").read_text())

    def deviations(self, left: str, right: str) -> dict[str, float]:
        checks = [c for c in self.data["checks"] if (c["left"], c["right"]) == (left, right)]
        return {c["quantity"].split(",")[0]: c["deviation"] for c in checks if c["deviation"] is not None}


def compare(file: Path, folder: Path, *words: str) -> Said:
    out = io.StringIO()
    with contextlib.redirect_stdout(out), contextlib.redirect_stderr(io.StringIO()):
        status = main(["compare", str(file), "--out", str(folder), *words])
    return Said(status, out.getvalue(), folder)


def short_box(folder: Path) -> Path:
    text = (SCENES / "biaxial_quick.toml").read_text()
    for pattern, word in SHORTER.items():
        text, count = re.subn(pattern, word, text)
        assert count == 1, pattern
    file = folder / "short.toml"
    file.write_text(text)
    return file


@pytest.fixture(scope="module")
def folder(tmp_path_factory) -> Path:
    return tmp_path_factory.mktemp("end to end")


@pytest.fixture(scope="module")
def oblique(folder) -> Said:
    return compare(SCENES / "oblique.toml", folder / "oblique")


@pytest.fixture(scope="module")
def head_on(folder) -> Said:
    return compare(SCENES / "head_on.toml", folder / "head_on")


@pytest.fixture(scope="module")
def short(folder) -> Said:
    return compare(short_box(folder), folder / "short")


@needs_all
@pytest.mark.parametrize("code", ["lammps", "liggghts"])
def test_oblique_impact_agrees_to_rounding_in_the_codes_own_conventions(oblique, code):
    """Over the whole trajectory; asked for is 1e-12, measured 1.2e-14 for both codes (2e-16 by the textbook kernel)."""
    assert oblique.status == 0
    deviations = oblique.deviations(code, f"kernel:{code}")
    assert set(deviations) == {"displacement", "velocity", "spin"}
    assert max(deviations.values()) <= 1e-13


@needs_all
def test_oblique_impact_shows_that_the_codes_conventions_differ(oblique):
    """Measured: 1.8e-4 of the displacement, 3.2e-4 of the velocity, 1.0e-3 of the spin."""
    deviations = oblique.deviations("lammps", "liggghts")
    assert 1e-4 < deviations["velocity"] < 1e-3
    assert 5e-4 < deviations["spin"] < 2e-3


@needs_all
def test_head_on_impact_is_one_law_in_all_codes(head_on):
    """Without friction nothing is left to conventions: the kernel is run once, and all agree to rounding."""
    assert head_on.status == 0
    assert [r["engine"] for r in head_on.data["runs"]] == ["lammps", "liggghts", "kernel:talk"]
    for pair in (("lammps", "kernel:talk"), ("liggghts", "kernel:talk"), ("lammps", "liggghts")):
        deviations = head_on.deviations(*pair)
        assert set(deviations) == {"displacement", "velocity"}
        assert max(deviations.values()) <= 1e-13


@needs_all
def test_short_box_on_all_engines(short):
    """LAMMPS and LIGGGHTS against the kernel in their conventions: 1e-6 asked for, 1e-11 measured."""
    runs = short.data["runs"]
    response = "kernel:lammps"  # once more, kicked
    assert [r["engine"] for r in runs] == ["lammps", "liggghts", "kernel:lammps", "kernel:liggghts", response]
    assert {r["status"] for r in runs} == {"completed"}
    checks = short.data["checks"]
    same = [c for c in checks if c["right"].startswith("kernel:") and "up to 0.2" in c["quantity"]]
    assert len(same) == 2
    assert max(c["deviation"] for c in same) < 1e-8
    assert {c["verdict"] for c in checks if c["level"] == "run"} == {"agrees"}
    assert len([c for c in checks if c["level"] == "run"]) == 4 * 4
    assert short.status == (1 if any(c["verdict"] == "differs" for c in checks) else 0)
    assert "5 of 5 runs completed" in short.out


@needs_all
def test_the_report_of_the_short_box_is_one_page(short):
    html = (short.folder / "report.html").read_text()
    pictures = len(re.findall(r'src="data:image/png;base64,', html))
    assert pictures == html.count("<figure") > 6
    assert not re.findall(r'(?:src|href)="(?!data:|#)', html)
    rows = list(csv.DictReader(io.StringIO((short.folder / "curves.csv").read_text())))
    assert len(rows) == 4 * 41
    assert float(rows[40]["strain"]) == pytest.approx(0.004)


@needs_all
def test_without_liggghts_two_engines_go_on_say_so_and_run_nothing_again(short, folder, monkeypatch):
    before = {r["engine"]: r for r in short.data["runs"]}
    shutil.copytree(short.folder, folder / "hidden")
    monkeypatch.setenv("PATH", str(folder))
    said = compare(folder / "short.toml", folder / "hidden")
    after = {r["engine"]: r for r in said.data["runs"]}
    assert said.status == 0
    assert {e: r["status"] for e, r in after.items()} == {
        "lammps": "completed", "liggghts": "unavailable", "kernel:lammps": "completed",
    }
    assert "3 of 4 runs completed, liggghts is unavailable" in said.out
    assert "apt-get install" in said.out
    assert {e: after[e] for e in ("lammps", "kernel:lammps")} == {e: before[e] for e in ("lammps", "kernel:lammps")}


@needs_all
def test_a_second_call_runs_nothing(oblique):
    """Outcomes keep the times at which runs were made."""
    again = compare(SCENES / "oblique.toml", oblique.folder)
    assert again.status == 0
    assert again.data["runs"] == oblique.data["runs"]
    assert again.data["checks"] == oblique.data["checks"]
