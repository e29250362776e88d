"""Copies begun earlier: they meet later, and all do the same."""

from pathlib import Path

import numpy as np
import pytest

from harness.errors import InputError
from harness.scene.load import load_scene
from harness.scene.resolve import resolve
from harness.scene.system import Wall
from harness.studies.accuracy.phases import delays, fastest_pair, stepped, with_phases

FILE = Path(__file__).resolve().parents[3] / "inputs" / "scenes" / "oblique_impact.toml"


@pytest.fixture
def system():
    return resolve(load_scene(FILE), FILE)


def test_delays_cover_every_phase_of_every_step():
    found = delays(48, 1.0)
    assert np.array_equal(np.floor(48 * found), np.arange(48))
    for halvings in (1, 3, 6):
        phase = np.mod(found * 2**halvings, 1.0)
        assert np.histogram(phase, 4, (0.0, 1.0))[0].min() >= 4


def test_copies_fly_to_the_same_place_later(system):
    delay = np.array([0.0, 3e-6, 7e-6])
    phased = with_phases(system, delay, FILE)
    p = phased.system.particles
    assert phased.bodies == 2
    assert len(p) == 6
    x = (p.x + np.repeat(delay, 2)[:, None] * p.v).reshape(3, 2, 2)
    assert np.allclose(x[:, 0] - x[:, 1], x[0, 0] - x[0, 1], rtol=0, atol=1e-17)
    assert np.array_equal(x[:, :, 0], np.repeat(x[:1, :, 0], 3, axis=0))
    travelled = fastest_pair(system) * (system.dt * system.steps + 7e-6)
    assert np.diff(np.sort(p.x[::2, 1])).min() > 2 * p.radius.max() + 2 * travelled


def test_steps_are_whole_and_no_longer_than_asked(system):
    made = stepped(system, 1.3e-6, 6e-5)
    assert made.steps == 47
    assert made.dt * made.steps == pytest.approx(6e-5, rel=1e-14)
    assert made.frame_every == made.sample_every == made.steps


def plane(normal):
    return Wall(index=1, name="wall", point=(-1.0, -1.0), normal=normal, friction=True)


def test_copies_stand_along_walls(system):
    phased = with_phases(system.with_(walls=(plane((0.0, 1.0)),)), np.zeros(2), FILE)
    x = phased.system.particles.x
    assert np.array_equal(x[:2, 1], x[2:, 1])
    assert x[2, 0] > x[0, 0]


@pytest.mark.parametrize(("changes", "longest", "says"), [
    ({"gravity": (0.0, -9.81)}, 0.0, "gravity: expected bodies on which nothing acts"),
    ({"walls": (plane((0.6, 0.8)),)}, 0.0, "got planes across every axis"),
    ({"walls": (plane((1.0, 0.0)),)}, 10.0, "that fly freely in the 10 s before the start"),
])
def test_scenes_without_free_flight_are_refused(system, changes, longest, says):
    with pytest.raises(InputError, match=says.replace("(", "\\(")):
        with_phases(system.with_(**changes), np.array([0.0, longest]), FILE)


def test_bodies_that_touch_are_refused(system):
    p = system.particles
    from dataclasses import replace

    touching = system.with_(particles=replace(p, x=0.99 * p.x))
    with pytest.raises(InputError, match="bodies that touch at the start"):
        with_phases(touching, np.zeros(2), FILE)
