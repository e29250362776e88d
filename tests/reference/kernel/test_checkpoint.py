"""A run that was killed goes on from its checkpoint to the same last bit, for every scheme and memory."""

import json
import os
import signal
import subprocess
import sys
from pathlib import Path

import h5py
import numpy as np
import pytest

import reference.kernel.__main__ as command
from reference.kernel.checkpoint import CHECKPOINT, read_checkpoint, write_checkpoint
from reference.kernel.deck import read_deck
from reference.kernel.program.simulation import ProgramSimulation, fastest

DISCS = 40

LAWS = {
    "spring": {"sliding": {"law": "spring", "shear_friction": 0.5, "shear_stiffness": 2e2, "shear_damping": 0.005}},
    "rolling": {
        "sliding": {"law": "spring", "shear_friction": 0.5, "shear_stiffness": 2e2, "shear_damping": 0.005},
        "rolling": {
            "law": "spring", "rolling_friction": 0.1, "rolling_stiffness": 2e2, "rolling_damping": 0.005,
        },
    },
    "hysteretic": {
        "normal": {
            "law": "hysteretic", "loading_stiffness": 5e2, "unloading_stiffness": 1e3, "adhesion_stiffness": 2e2,
            "normal_damping": 0.01,
        },
    },
    "smooth": {},
}


@pytest.fixture
def deck(tmp_path):
    """Write a box of discs that fall, with a loaded side wall and a driven top, in a convention with some laws."""

    def write(folder: Path, convention: str, laws: dict, steps: int = 600) -> Path:
        folder.mkdir()
        wall = {"friction": True, "motion": {"kind": "fixed"}}
        loaded = {"kind": "loaded", "mass": 1e-4, "load": 0.5, "stress": 0.0, "span": None, "damping": 0.01}
        cosine = {"kind": "cosine", "travel": 1e-3, "duration": 5e-3}
        content = {
            "title": "checkpoint", "dimension": 2, "convention": convention, "dt": 1e-5,
            "plan": {"steps": steps, "sample_every": 20, "frame_every": 50, "contacts": True},
            "normal": {"law": "linear", "normal_stiffness": 1e3, "normal_damping": 0.02, "attraction": "allowed"},
            "walls": [
                {"name": "floor", "point": [0.0, 0.0], "normal": [0.0, 1.0], **wall},
                {"name": "left", "point": [0.0, 0.0], "normal": [1.0, 0.0], **wall},
                {"name": "right", "point": [0.008, 0.0], "normal": [-1.0, 0.0], **wall, "motion": loaded},
                {"name": "top", "point": [0.0, 0.0135], "normal": [0.0, -1.0], **wall, "motion": cosine},
            ],
            "gravity": [0.0, -50.0], "rotations": True, **laws,
        }
        (folder / "kernel.json").write_text(json.dumps(content))
        draw = np.random.default_rng(3)
        rows = ["id,x,y,radius,mass,inertia,vx,vy,wz"]
        for k in range(DISCS):
            x, y, r = 8e-4 * (2 * (k % 5) + 1), 7.7e-4 * (2 * (k // 5) + 1), 1e-3 * draw.uniform(0.72, 0.8)
            rows.append(f"{k + 1},{x!r},{y!r},{r!r},1e-5,5e-12,{0.1 * draw.normal():.17g},{0.1 * draw.normal():.17g},0")
        (folder / "particles.csv").write_text("\n".join(rows) + "\n")
        return folder

    return lambda name, convention, laws, **more: write(tmp_path / name, convention, laws, **more)


def outputs(folder: Path) -> tuple[str, dict[str, np.ndarray]]:
    found = {}
    with h5py.File(folder / "frames.h5") as f:
        assert f.attrs["finished"] == 1
        f.visititems(lambda name, item: found.update({name: item[()]}) if isinstance(item, h5py.Dataset) else None)
    return (folder / "series.csv").read_text(), found


@pytest.mark.parametrize("convention", ["lammps", "liggghts", "talk", "corrected"])
@pytest.mark.parametrize("laws", LAWS)
def test_going_on_gives_the_same_bits(deck, convention, laws):
    whole = fastest(read_deck(deck("whole", convention, LAWS[laws]))[0])
    if not isinstance(whole, ProgramSimulation):
        pytest.skip("evaluated by the textbook, which keeps no checkpoints")
    whole.advance(600)
    first = fastest(read_deck(deck("first", convention, LAWS[laws]))[0])
    first.advance(317)
    second = fastest(read_deck(deck("second", convention, LAWS[laws]))[0])
    second.take(first.kept())
    second.advance(283)
    for name in ("x", "v", "spin", "force", "wall_d", "wall_rate", "turned"):
        np.testing.assert_array_equal(getattr(second.state, name), getattr(whole.state, name), err_msg=name)
    assert second.time == whole.time
    assert any(len(forces.f_n) for _, forces in whole.contacts())


@pytest.mark.parametrize("stops", [(3,), (1, 2, 9)])
def test_a_killed_run_writes_the_same_files(deck, monkeypatch, capsys, stops):
    """Ends the run after its n-th checkpoint and output; the files are those of a run that was left alone."""
    assert command.main(deck("whole", "lammps", LAWS["spring"])) == 0
    folder = deck("killed", "lammps", LAWS["spring"])
    monkeypatch.setattr(command, "EVERY", 0.0)
    for stop in stops:
        monkeypatch.setattr(command, "write_checkpoint", _ends_after(stop))
        with pytest.raises(RuntimeError, match="killed"):
            command.main(folder)
        assert (folder / CHECKPOINT).exists()
        assert not (folder / "frames.h5").exists()
    capsys.readouterr()
    monkeypatch.setattr(command, "EVERY", 60.0)
    assert command.main(folder) == 0
    report = json.loads(capsys.readouterr().out.splitlines()[-1])
    assert report["resumed_at"] > 0
    series, frames = outputs(folder)
    expected_series, expected_frames = outputs(folder.parent / "whole")
    assert series == expected_series
    assert frames.keys() == expected_frames.keys()
    for name, values in expected_frames.items():
        np.testing.assert_array_equal(frames[name], values, err_msg=name)
    assert not list(folder.glob("*.part*"))
    assert not (folder / CHECKPOINT).exists()


def _ends_after(count: int):
    made = [0]

    def write(*args, **outputs):
        write_checkpoint(*args, **outputs)
        made[0] += 1
        if made[0] == count:
            raise RuntimeError("killed")

    return write


def test_kill_9_in_the_middle(deck):
    script = (
        "import sys, pathlib, reference.kernel.__main__ as c; c.EVERY = 0.0; "
        "sys.exit(c.main(pathlib.Path(sys.argv[1])))"
    )
    folder = deck("killed", "talk", LAWS["spring"], steps=8000)
    process = subprocess.Popen([sys.executable, "-c", script, str(folder)], stdout=subprocess.PIPE)
    while not (folder / CHECKPOINT).exists() or len((folder / "series.csv").read_text().splitlines()) < 9:
        assert process.poll() is None
    os.kill(process.pid, signal.SIGKILL)
    process.wait()
    assert read_checkpoint(folder) is not None
    done = subprocess.run([sys.executable, "-m", "reference.kernel", str(folder)], capture_output=True, text=True)
    assert json.loads(done.stdout.splitlines()[-1])["resumed_at"] > 0
    assert subprocess.run([sys.executable, "-m", "reference.kernel", str(deck("whole", "talk", LAWS["spring"],
                          steps=8000))], capture_output=True).returncode == 0
    assert outputs(folder)[0] == outputs(folder.parent / "whole")[0]


def test_a_damaged_checkpoint_is_none(deck, capsys):
    folder = deck("run", "lammps", LAWS["spring"])
    (folder / CHECKPOINT).write_bytes(b"PK\x03\x04 not a checkpoint")
    assert read_checkpoint(folder) is None
    assert command.main(folder) == 0
    assert "resumed_at" not in json.loads(capsys.readouterr().out.splitlines()[-1])


def test_short_runs_write_none(deck, monkeypatch):
    monkeypatch.setattr(command, "write_checkpoint", lambda *_, **__: pytest.fail("a checkpoint"))
    assert command.main(deck("run", "lammps", LAWS["smooth"])) == 0
