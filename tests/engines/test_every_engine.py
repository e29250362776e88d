"""The acceptance test that every engine of the registry must pass: adding one is one line, and this walks it."""

from __future__ import annotations

import numpy as np
import pytest

from harness.engines.registry import ENGINES
from harness.runs.sanity import find_fault
from harness.scene.contact import LinearNormal, SpringSliding
from harness.scene.model import Background
from harness.scene.system import Cosine, Loaded, Particles, System, Wall

SLIDING = SpringSliding(shear_friction=0.3, shear_stiffness=3e3, shear_damping=0.2)
RADIUS = np.array([1.0e-3, 1.1e-3, 0.9e-3, 1.05e-3])


def small_box(**changes) -> System:
    """Four discs, slightly pressed together, in a box whose top comes down and whose right wall has a mass."""
    x = np.array([[1.0e-3, 1.0e-3], [3.08e-3, 1.1e-3], [0.9e-3, 2.86e-3], [2.9e-3, 3.22e-3]])
    walls = (
        Wall(index=1, name="left", point=(0.0, 0.0), normal=(1.0, 0.0), friction=False),
        Wall(index=2, name="bottom", point=(0.0, 0.0), normal=(0.0, 1.0), friction=False),
        Wall(index=3, name="right", point=(4.17e-3, 0.0), normal=(-1.0, 0.0), friction=False,
             motion=Loaded(mass=1e-4, load=0.0, stress=100.0, span=("bottom", "top"), damping=0.05)),
        Wall(index=4, name="top", point=(0.0, 4.25e-3), normal=(0.0, -1.0), friction=False,
             motion=Cosine(travel=2e-4, duration=2e-3)),
    )
    particles = Particles(
        x=x, radius=RADIUS, mass=4e3 * RADIUS**3, inertia_factor=np.full(4, 0.5),
        v=np.array([[0.1, 0.0], [0.0, -0.1], [0.05, 0.0], [0.0, 0.0]]),
        spin=np.array([[10.0], [-5.0], [0.0], [3.0]]),
    )
    fields = {
        "dimension": 2, "particles": particles, "walls": walls, "sliding": SLIDING, "background": None,
        "normal": LinearNormal(normal_stiffness=1e5, normal_damping=0.1, attraction="allowed"), "gravity": None,
        "periodic": None, "dt": 1e-6, "steps": 800, "sample_every": 20, "frame_every": 80, "contacts": True,
        "scene_name": "small_box",
    }
    return System(**(fields | changes))


def lone_disc(**changes) -> System:
    """One spinning disc in free flight."""
    particles = Particles(
        x=np.zeros((1, 2)), radius=np.array([1e-3]), mass=np.array([1e-5]), inertia_factor=np.array([0.5]),
        v=np.array([[0.5, -0.25]]), spin=np.array([[40.0]]),
    )
    return small_box(particles=particles, walls=(), contacts=False, **changes)


@pytest.fixture(params=ENGINES.values(), ids=ENGINES)
def engine(request):
    if not request.param.probe().available:
        pytest.skip(f"{request.param.name}: {request.param.probe().detail}")
    return request.param


def perform(engine, system, folder):
    folder.mkdir()
    for name, text in engine.render(system).items():
        (folder / name).write_text(text)
    result = engine.run(folder, time_limit=60.0)
    assert result.status == "completed", (result.reason, result.last_lines)
    return engine.read(folder, system)


def test_run_is_whole_and_sane(engine, tmp_path):
    system = small_box(rotations=True)
    trajectory = perform(engine, system, tmp_path / "run")
    assert find_fault(system, trajectory) is None
    assert trajectory.steps == tuple(range(0, 801, 80))
    assert engine.steps_done(tmp_path / "run") == 800


def test_contact_output_leaves_the_run_alone_to_the_last_bit(engine, tmp_path):
    with_contacts = perform(engine, small_box(), tmp_path / "with").frames[-1]
    without = perform(engine, small_box(contacts=False), tmp_path / "without").frames[-1]
    assert with_contacts.contacts.rows > 0
    assert without.contacts is None
    for column in ("x", "y", "vx", "vy", "wz"):
        np.testing.assert_array_equal(with_contacts.particles[column], without.particles[column])


def test_same_run_twice_gives_the_same_bits(engine, tmp_path):
    first, second = (perform(engine, small_box(), tmp_path / k).frames[-1] for k in "ab")
    for column in first.particles:
        np.testing.assert_array_equal(first.particles[column], second.particles[column])


def test_effects_that_are_off_leave_nothing_in_the_deck(engine):
    """Switching an effect on adds to the deck; a deck without it is the same whatever it was before."""
    plain = small_box(sliding=None, contacts=False)
    bare = _words(engine.render(plain))
    for change in (
        {"sliding": SLIDING}, {"background": Background(translational_drag=1e-3)}, {"gravity": (0.0, -9.81)},
        {"contacts": True},
    ):
        assert _words(engine.render(plain.with_(**change))) - bare, change
    assert engine.render(plain.with_(gravity=(0.0, -1.0)).with_(gravity=None)) == engine.render(plain)


def test_rotation_is_the_time_integral_of_the_spin(engine, tmp_path):
    frames = perform(engine, lone_disc(rotations=True), tmp_path / "run").frames
    turned = [f.particles["rotation"][0] for f in frames]
    np.testing.assert_allclose(turned, [40.0 * f.time for f in frames], rtol=1e-12, atol=1e-15)


def test_rotations_not_asked_for_are_not_there(engine, tmp_path):
    assert "rotation" not in perform(engine, lone_disc(), tmp_path / "run").frames[0].particles


@pytest.mark.parametrize("name", ["lammps", "liggghts"])
def test_sampled_rotations_follow_those_summed_in_every_step(name, tmp_path):
    """Against the kernel in the engine's own conventions; the engine samples spins every ten steps."""
    if not ENGINES[name].probe().available:
        pytest.skip(f"{name} is not installed")
    system = small_box(rotations=True)
    own = perform(ENGINES[name], system, tmp_path / "own").frames[-1].particles["rotation"]
    kernel = perform(ENGINES[f"kernel:{name}"], system, tmp_path / "kernel").frames[-1].particles["rotation"]
    assert np.abs(kernel).max() > 1e-2
    np.testing.assert_allclose(own, kernel, atol=0.01 * np.abs(kernel).max())


@pytest.mark.parametrize("name", ["lammps", "liggghts"])
def test_mdanalysis_reads_the_same_particles(name, tmp_path):
    """The second reader agrees with ours on what the engine itself wrote, to the last bit."""
    from postproc.readers.mdanalysis import read_with_mdanalysis

    if not ENGINES[name].probe().available:
        pytest.skip(f"{name} is not installed")
    ours = perform(ENGINES[name], small_box(), tmp_path / "run")
    dump, unwrapped = {"lammps": ("frames.dump", "u"), "liggghts": ("particles.dump", "")}[name]
    columns = {"id": "id", "x" + unwrapped: "x", "y" + unwrapped: "y", "vx": "vx", "vy": "vy", "radius": "radius"}
    theirs = read_with_mdanalysis(tmp_path / "run" / dump, tuple(columns))
    assert [step for step, _ in theirs] == list(ours.steps)
    for (_, table), frame in zip(theirs, ours, strict=True):
        for column, name_here in columns.items():
            np.testing.assert_array_equal(table[column], frame.particles[name_here])


def _words(deck: dict[str, str]) -> set[str]:
    """Lines of all deck files."""
    return {line.strip() for text in deck.values() for line in text.splitlines()}
