"""Packings of a scene: how many, with which seeds, in words; and one run of it."""

import numpy as np
import pytest

from harness.engines.kernel.deck import render_deck
from harness.errors import InputError
from harness.scene.load import load_scene
from harness.studies.prepare import prepare
from harness.studies.single import single_run
from reference.kernel.deck import read_deck
from reference.kernel.simulation import Simulation

LIMIT = 60.0
SMALL = ("count = 9", "count = 12")


class Told:
    def __init__(self, said):
        self.said = said

    def begin(self, labels, costs):
        self.said.append(labels)

    def running(self, job, fraction):
        self.said.append(job)

    def done(self, job, line):
        self.said.append(line)

    def end(self):
        self.said.append("end")


def test_each_packing_has_its_own_seed_and_is_made_once(box, tmp_path):
    small, said = box.changed(SMALL), []
    starts = prepare(small.scene, small.file, packings=2, cache=tmp_path / "packings", progress=lambda: Told(said))
    assert [s.number for s in starts] == [0, 1]
    assert starts[0].packing.path != starts[1].packing.path
    assert not np.array_equal(starts[0].system.particles.radius, starts[1].system.particles.radius)
    assert said[0] == ["packing 1", "packing 2"]
    assert said[2].startswith("packing 1: 12 particles, ")
    assert said[-1] == "end"
    written = {p: p.stat().st_mtime_ns for p in (tmp_path / "packings").iterdir()}
    (again,) = prepare(small.scene, small.file, packings=None, cache=tmp_path / "packings")
    assert np.array_equal(again.system.particles.x, starts[0].system.particles.x)
    assert {p: p.stat().st_mtime_ns for p in (tmp_path / "packings").iterdir()} == written


def test_too_many_packings_are_refused_before_any_is_made(box, tmp_path):
    with pytest.raises(InputError, match="--packings: expected a number from 1 to 1000, got 1001"):
        prepare(box.scene, box.file, packings=1001, cache=tmp_path / "packings")
    assert not (tmp_path / "packings").exists()


MEMORY = (
    'law = "hysteretic", loading_stiffness = 2e4, unloading_stiffness = 1e5, adhesion_stiffness = 3e4, '
    "normal_damping = "
)


def test_a_box_with_memory_starts_in_balance(box, tmp_path):
    """Contacts begin with k_1 and without memory: only a packing relaxed with k_1 is at rest under them."""
    linear = 'law = "linear", normal_stiffness = 1e5, normal_damping = '
    small = box.changed(SMALL, (linear, MEMORY), (', attraction = "allowed"', ""))
    (start,) = prepare(small.scene, small.file, packings=1, cache=tmp_path / "packings")
    for name, text in render_deck(start.system, "talk").items():
        (tmp_path / name).write_text(text)
    forces = Simulation(read_deck(tmp_path)[0]).state.force
    width, height = start.packing.box
    pressure, count = small.scene.preparation.pressure, len(start.system.particles)
    assert np.abs(forces[:, :count]).max() < 1e-6 * pressure * width
    _, _, right, top = forces[:, count:].T
    assert right[0] == pytest.approx(pressure * height, rel=1e-6)
    assert top[1] == pytest.approx(pressure * width, rel=1e-6)


def test_the_scene_says_how_many(box, tmp_path):
    three = box.changed(SMALL, ("[compare]\n", "[compare]\npackings = 3\n"))
    assert len(prepare(three.scene, three.file, packings=None, cache=tmp_path)) == 3
    assert len(prepare(three.scene, three.file, packings=1, cache=tmp_path)) == 1


def test_a_scene_without_random_particles_has_one_start(flight, tmp_path):
    scene = load_scene(flight)
    (start,) = prepare(scene, flight, packings=1, cache=tmp_path / "none")
    assert start.packing is None
    assert not (tmp_path / "none").exists()
    with pytest.raises(InputError, match="--packings: expected 1, as this scene's particles are not drawn"):
        prepare(scene, flight, packings=3, cache=tmp_path / "none")


def test_one_run_is_completed_and_reused(flight, obedient, tmp_path):
    first, second = (single_run(flight, obedient("a"), tmp_path / "out", time_limit=LIMIT) for _ in range(2))
    assert first.outcome == second.outcome
    assert obedient.begun() == ["a"]
    assert first.trajectory.frames[-1].particles["x"][0] == pytest.approx(0.3e-3)


@pytest.mark.parametrize("settings", [{"does": "abort"}, {"available": False}])
def test_a_run_that_did_not_complete_has_no_trajectory(flight, obedient, tmp_path, settings):
    run = single_run(flight, obedient("a", **settings), tmp_path, time_limit=LIMIT)
    assert run.trajectory is None
    assert run.outcome.status in ("crashed", "unavailable")
