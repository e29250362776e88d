"""The scenes that come with the project: they load, survive a round trip, and are what they say."""

import math
from pathlib import Path

import msgspec
import numpy as np
import pytest

from harness.scene.derived import derive
from harness.scene.explain import explain
from harness.scene.load import load_scene
from harness.scene.resolve import known_system
from reference.analytic.linear_collision import LinearCollision

FOLDER = Path(__file__).resolve().parents[2] / "inputs" / "scenes"
FILES = sorted(FOLDER.glob("*.toml"))
BOXES = ["biaxial", "biaxial_frictionless", "biaxial_quick"]


def shipped(name):
    return load_scene(FOLDER / f"{name}.toml")


def test_there_are_scenes():
    assert {f.stem for f in FILES} >= {*BOXES, "head_on", "oblique"}


@pytest.mark.parametrize("file", FILES, ids=lambda f: f.stem)
def test_scene_loads_and_survives_a_round_trip(file, scenes):
    scene = load_scene(file)
    text = scenes.dump(_without_none(msgspec.to_builtins(scene)))
    assert load_scene(scenes.write(text)) == scene


@pytest.mark.parametrize("file", FILES, ids=lambda f: f.stem)
def test_scene_is_far_from_instability_and_explains_itself(file):
    scene = load_scene(file)
    system = known_system(scene, file)
    assert derive(scene, system).stability_margin > 1.15  # of a bound that counts six smallest neighbours
    assert all(row.text for _, rows in explain(scene, system) for row in rows)


def test_boxes_differ_in_friction_and_size_only():
    friction, smooth, quick = (msgspec.to_builtins(shipped(n)) for n in BOXES)
    assert {k for k in friction if friction[k] != smooth[k]} <= {"title", "contact", "compare", "outputs", "top"}
    assert smooth["outputs"]["rotations"] is False
    assert friction["contact"]["normal"] == smooth["contact"]["normal"]
    assert smooth["contact"]["sliding"] is None
    assert {k for k in friction if friction[k] != quick[k]} <= {"title", "particles", "top", "outputs", "compare"}


@pytest.mark.parametrize("name", BOXES[:2])
def test_boxes_are_slow_and_their_wall_is_light(name):
    """The wall's own inertia and friction stay below 1 % of p z while the sample gives way smoothly."""
    derived = derive(shipped(name))
    assert derived.inertial_number < 1e-3
    (wall,) = derived.walls
    assert wall.inertia_share + wall.damping_share < 0.01


def test_quick_box_is_quick():
    derived = derive(shipped("biaxial_quick"))
    assert derived.plan.steps * derived.grains.count <= 200 * 200_000
    assert derived.inertial_number < 1e-3


def test_head_on_meets_within_its_duration():
    """Its comment's numbers, and that the bodies touch on a line through both centres and part in time."""
    file = FOLDER / "head_on.toml"
    scene = load_scene(file)
    system = known_system(scene, file)
    particles, (mean,) = system.particles, derive(scene, system).pairs
    branch = particles.x[1] - particles.x[0]
    distance, approach = np.linalg.norm(branch), np.linalg.norm(particles.v[0])
    assert np.cross(branch, particles.v[0]) == pytest.approx(np.zeros(3), abs=1e-12 * distance * approach)
    flight = (distance - particles.radius.sum()) / approach
    assert flight == pytest.approx(1e-5, rel=2e-2)
    assert mean.time_scale == pytest.approx(2.880e-5, rel=1e-3)
    assert mean.restitution_allowed == pytest.approx(0.842, abs=5e-4)
    assert flight + mean.time_scale < 0.9 * scene.duration


def test_oblique_touches_and_slips():
    """Glancing: the slip speed at touch exceeds what gross sliding can stop, or not, within the duration."""
    file = FOLDER / "oblique.toml"
    scene = load_scene(file)
    particles = known_system(scene, file).particles
    x, v, radius = particles.x, particles.v, particles.radius
    relative, branch = v[0] - v[1], x[1] - x[0]
    along = branch @ relative / np.linalg.norm(relative)
    miss = abs(branch[0] * relative[1] - branch[1] * relative[0]) / np.linalg.norm(relative)
    assert 0.1 * radius.sum() < miss < 0.9 * radius.sum()
    flight = (along - math.sqrt(radius.sum() ** 2 - miss**2)) / np.linalg.norm(relative)
    normal = scene.contact.normal
    pair = LinearCollision(
        stiffness=normal.normal_stiffness, damping=normal.normal_damping,
        reduced_mass=particles.mass.prod() / particles.mass.sum(),
    )
    assert flight > 0
    assert flight + pair.duration("allowed") < 0.9 * scene.duration
    assert particles.spin.all()


def _without_none(value):
    if isinstance(value, dict):
        return {k: _without_none(v) for k, v in value.items() if v is not None}
    return [_without_none(v) for v in value] if isinstance(value, list | tuple) else value
