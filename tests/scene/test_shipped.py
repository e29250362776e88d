"""The scenes that come with the project: they load, survive a round trip, and are what they say."""

import math
import tempfile
from pathlib import Path

import msgspec
import numpy as np
import pytest

from harness.engines.kernel.deck import render_deck
from harness.scene.derived import derive
from harness.scene.explain import explain
from harness.scene.load import load_scene
from harness.scene.resolve import known_system
from reference.analytic.linear_collision import LinearCollision
from reference.kernel.deck import read_deck
from reference.kernel.simulation import Simulation

FOLDER = Path(__file__).resolve().parents[2] / "inputs" / "scenes"
FILES = sorted(FOLDER.glob("*.toml"))
BOXES = ["biaxial", "biaxial_frictionless", "biaxial_quick"]


def shipped(name):
    return load_scene(FOLDER / f"{name}.toml")


def test_there_are_scenes():
    impacts = {"head_on", "oblique", "hertz_impact", "hysteretic_impact"}
    assert {f.stem for f in FILES} >= {*BOXES, *impacts, "rolling_incline", "spinning_sphere"}


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
    particles, (only,) = system.particles, derive(scene, system).pairs
    branch = particles.x[1] - particles.x[0]
    distance, approach = np.linalg.norm(branch), np.linalg.norm(particles.v[0])
    assert np.cross(branch, particles.v[0]) == pytest.approx(np.zeros(3), abs=1e-12 * distance * approach)
    flight = (distance - particles.radius.sum()) / approach
    assert flight == pytest.approx(1e-5, rel=2e-2)
    assert only.met.time_scale == pytest.approx(2.880e-5, rel=1e-3)
    assert only.met.fact("restitution, attraction allowed").value == pytest.approx(0.842, abs=5e-4)
    assert flight + only.met.time_scale < 0.9 * scene.duration


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


def facts_of(name):
    file = FOLDER / f"{name}.toml"
    scene = load_scene(file)
    (only,) = derive(scene, known_system(scene, file)).pairs
    return scene, only.met


def test_hertz_impact_is_test_1_of_chung_and_ooi():
    scene, met = facts_of("hertz_impact")
    assert met.time_scale == pytest.approx(40.34e-6, rel=1e-3)
    assert met.fact("largest overlap").value == pytest.approx(274.1e-6, rel=1e-3)
    assert met.fact("elastic force there").value == pytest.approx(10.697e3, rel=1e-3)
    assert scene.contact.normal.impact_speed == scene.bodies[0].velocity[0] - scene.bodies[1].velocity[0]
    assert 1e-5 + met.time_scale < 0.9 * scene.duration


def test_hysteretic_impact_keeps_a_quarter_of_its_energy():
    scene, met = facts_of("hysteretic_impact")
    assert met.fact("restitution").value == pytest.approx(0.5, rel=1e-12)
    assert met.fact("contact time").value == pytest.approx(4.55e-5, rel=1e-3)
    assert 1e-5 + met.fact("contact time").value < 0.9 * scene.duration


def early(name, part):
    """Run the first part of a scene of one body in the kernel; return the simulation and its time."""
    file = FOLDER / f"{name}.toml"
    system = known_system(load_scene(file), file)
    with tempfile.TemporaryDirectory() as folder:
        for name, text in render_deck(system, "talk").items():
            (Path(folder) / name).write_text(text)
        simulation = Simulation(read_deck(Path(folder))[0])
    steps = int(part * system.steps)
    simulation.advance(steps)
    return simulation.state, steps * system.dt


def test_incline_rolls_as_its_comment_says():
    """(1 + 2/5) a = g sin a - mu_r g cos a, down the slope (12, -5)/13; the start costs little."""
    state, time = early("rolling_incline", 0.2)
    acceleration = 9.81 * (5 - 0.1 * 12) / 13 / 1.4
    assert acceleration == pytest.approx(2.048, abs=5e-4)
    v = state.v[:, 0]
    assert v @ [12 / 13, -5 / 13] == pytest.approx(acceleration * time, rel=1e-2)
    assert abs(v @ [5 / 13, 12 / 13]) < 1e-4 * np.linalg.norm(v)
    assert -state.spin[0, 0] * 1e-3 == pytest.approx(np.linalg.norm(v), rel=1e-2)


def test_spinning_sphere_slows_as_its_comment_says():
    state, time = early("spinning_sphere", 0.2)
    slowing = 2.5 * 0.1 * 9.81 / 1e-3
    assert slowing == pytest.approx(2452.5)
    assert 50.0 - state.spin[2, 0] == pytest.approx(slowing * time, rel=1e-2)
    assert np.abs(state.v[:, 0]).max() < 1e-9
    assert slowing * load_scene(FOLDER / "spinning_sphere.toml").duration > 50.0


def _without_none(value):
    if isinstance(value, dict):
        return {k: _without_none(v) for k, v in value.items() if v is not None}
    return [_without_none(v) for v in value] if isinstance(value, list | tuple) else value
