"""A kernel run that was broken off goes on where its checkpoint stands; other codes begin anew and say why."""

from pathlib import Path

import pytest

import reference.kernel.__main__ as command
from harness.engines.registry import ENGINES
from harness.runs.execute import run_one, same_trajectory
from harness.runs.folder import RunFolder
from harness.scene.load import load_scene
from postproc.trajectory import read_trajectory
from reference.kernel.checkpoint import CHECKPOINT, write_checkpoint

SCENE = Path("inputs/scenes/cluster.toml")


@pytest.fixture
def system():
    from harness.scene.resolve import resolve

    return resolve(load_scene(SCENE), SCENE)


def broken_off(folder: RunFolder, engine, system, monkeypatch) -> None:
    """Leave what a run leaves that was killed after its fifth checkpoint."""
    made = []

    def write(*args, **outputs):
        write_checkpoint(*args, **outputs)
        made.append(1)
        if len(made) == 5:
            raise RuntimeError("killed")

    folder.prepare(engine.render(system))
    with monkeypatch.context() as context:
        context.setattr(command, "EVERY", 0.0)
        context.setattr(command, "write_checkpoint", write)
        with pytest.raises(RuntimeError):
            command.main(folder.path)
    assert (folder.path / CHECKPOINT).exists()


def test_a_run_goes_on_to_the_same_bits_and_says_so(system, tmp_path, monkeypatch, caplog):
    engine = ENGINES["kernel:lammps"]
    folder = RunFolder.of(tmp_path / "broken", system, engine.name, engine.probe().version)
    broken_off(folder, engine, system, monkeypatch)
    outcome, path = run_one(engine, system, tmp_path / "broken", time_limit=60.0)
    whole, other = run_one(engine, system, tmp_path / "whole", time_limit=60.0)
    assert outcome.status == whole.status == "completed"
    assert outcome.resumed_at > 0
    assert whole.resumed_at is None
    assert "goes on from its checkpoint" in caplog.text
    assert same_trajectory(read_trajectory(path / "trajectory.h5"), read_trajectory(other / "trajectory.h5"))


@pytest.mark.parametrize("change", ["force", "deck", "owned"])
def test_it_begins_anew_when_asked_or_when_the_deck_or_the_process_is_not_its_own(
    system, tmp_path, monkeypatch, change
):
    engine = ENGINES["kernel:lammps"]
    folder = RunFolder.of(tmp_path, system, engine.name, engine.probe().version)
    broken_off(folder, engine, system, monkeypatch)
    if change == "deck":
        deck = folder.path / "kernel.json"
        deck.write_text(deck.read_text() + "\n")
    with _owner(folder.path, owned=change == "owned"):
        outcome, _ = run_one(engine, system, tmp_path, time_limit=60.0, force=change == "force")
    assert outcome.status == "completed"
    assert outcome.resumed_at is None


def _owner(folder: Path, *, owned: bool):
    """Hold the lock as a process would that outlived its harness."""
    import contextlib
    import fcntl

    if not owned:
        return contextlib.nullcontext()
    file = open(folder / "running.lock", "w")  # noqa: SIM115
    fcntl.flock(file, fcntl.LOCK_EX)
    return contextlib.closing(file)


@pytest.mark.parametrize("name", ["lammps", "liggghts"])
def test_codes_whose_restarts_change_bits_begin_anew(name, tmp_path):
    assert not ENGINES[name].resumes(tmp_path)
    assert "restart" in type(ENGINES[name]).resumes.__doc__.lower()
