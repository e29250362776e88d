"""Discs grown in shear between two rings: inside, at full size, flowing, kept, made again when damaged."""

import numpy as np
import pytest

from harness.errors import InputError
from harness.packing.grow import _stages, grow_ring, inserted, without_memory
from harness.scene.load import load_scene
from harness.scene.ring import free_bounds, radii
from reference.kernel.simulation import KernelUnstable

SCENE = """
kind = "couette"
title = "ring"
duration = 0.1
particles = {seed = 3, inertia = "disc", mass = {kind = "disc", density = 1060.0, height = 6e-3}, species = [
  {count = 140, radius = 3.71e-3}, {count = 23, radius = 4.495e-3}]}
rings = {inner_radius = 0.02, outer_radius = 0.06, grain_radius = 1.25e-3, omega = 1.0}
preparation = {start_size = 0.5, grow = 0.2, settle = 0.05}
numerics = {dt_fraction = 0.04}
outputs = {samples = 20, frames = 10, contacts = true}
compare = {steady_from = 0.05, band = 0.02}
contact.normal = {law = "linear", normal_stiffness = 352.1, normal_damping = 0.19, attraction = "allowed"}
"""
VISCOUS = 'contact.sliding = {law = "viscous", shear_friction = 0.44, shear_damping = 0.15}\n'
SPRING = (
    'contact.sliding = {law = "spring", shear_friction = 0.44, shear_stiffness = 100.0, shear_damping = 0.15}\n'
)


def ring(folder, sliding=VISCOUS, **changes):
    text = SCENE + sliding
    for old, new in changes.values():
        assert old in text
        text = text.replace(old, new)
    path = folder / "ring.toml"
    path.write_text(text)
    return load_scene(path)


@pytest.fixture(scope="module")
def made(tmp_path_factory):
    folder = tmp_path_factory.mktemp("ring")
    scene = ring(folder)
    return scene, grow_ring(scene, seed=3, cache=folder), folder


def test_discs_lie_between_the_rings_at_full_size_and_flow(made):
    scene, flow, _ = made
    assert (flow.radius == radii(scene)).all()
    distance = np.hypot(*flow.x.T)
    low, high = scene.rings.inner_radius, scene.rings.outer_radius
    assert (distance > low).all()
    assert (distance < high).all()
    angular = (flow.x[:, 0] * flow.v[:, 1] - flow.x[:, 1] * flow.v[:, 0]) / distance
    near = distance < np.quantile(distance, 0.3)
    assert angular[near].mean() > 0.02 * scene.rings.omega * low, "the inner ring drags the discs near it"
    assert np.abs(flow.spin).max() > 0


def test_discs_overlap_little(made):
    _, flow, _ = made
    distance = np.linalg.norm(flow.x[:, None] - flow.x, axis=2)
    overlap = flow.radius[:, None] + flow.radius - distance
    np.fill_diagonal(overlap, -1.0)
    assert 0 < overlap.max() < 0.1 * flow.radius.min()


def test_kept_and_made_again_when_damaged(made, caplog):
    scene, flow, folder = made
    assert grow_ring(scene, seed=3, cache=folder).x.tobytes() == flow.x.tobytes()
    text = flow.path.read_text()
    flow.path.write_text(text[:-20])
    again = grow_ring(scene, seed=3, cache=folder)
    assert "made again" in caplog.text
    assert again.x.tobytes() == flow.x.tobytes()
    assert flow.path.read_text() == text


def test_another_seed_is_another_state(made):
    scene, flow, folder = made
    assert grow_ring(scene, seed=4, cache=folder).path != flow.path


def test_a_state_at_rest_is_what_the_inner_ring_is_turned_back_for(made):
    """It ends where `rings_of` has it: the last stage's begin and what it turns add up to nothing."""
    scene, *_ = made
    last = _stages(scene, 1e-4)[-1]
    assert last.size == 1.0
    assert last.angle + last.omega * last.steps * 1e-4 == pytest.approx(0.0, abs=1e-15)


def test_sizes_and_rates_rise(made):
    scene, *_ = made
    stages = _stages(scene, 1e-4)
    assert np.all(np.diff([s.size for s in stages]) >= 0)
    assert stages[0].size > 0.5
    assert np.all(np.diff([s.omega for s in stages]) >= 0)
    assert stages[-1].omega == 1.0


def test_inserted_discs_do_not_touch(made):
    scene, *_ = made
    x, small = inserted(scene, 3).T, 0.5 * radii(scene)
    distance = np.linalg.norm(x[:, None] - x, axis=2) + 1e9 * np.eye(len(x))
    assert (distance > small[:, None] + small).all()
    low, high = free_bounds(scene.rings)
    assert (np.hypot(*x.T) - small > low).all()
    assert (np.hypot(*x.T) + small < high).all()


def test_a_spring_is_prepared_with_its_dashpot(tmp_path):
    law = without_memory(ring(tmp_path, SPRING))
    assert (law.shear_friction, law.shear_damping) == (0.44, 0.15)
    assert without_memory(ring(tmp_path, "")) is None


def test_what_finds_no_place_is_said_in_one_line(tmp_path, monkeypatch):
    """So unlikely below the start sizes that the scene lets pass that the insertion is made to fail."""
    monkeypatch.setattr("harness.packing.grow.insert_in_annulus", lambda *_: None)
    with pytest.raises(InputError, match="packing: preparation.start_size: expected discs that find places"):
        grow_ring(ring(tmp_path), seed=3, cache=tmp_path)
    assert not list(tmp_path.glob("ring-*"))


def test_what_cannot_grow_is_said_in_one_line(tmp_path, monkeypatch):
    """A kernel that stops, as it does when positions are no longer numbers, is the scene's fault."""
    def advance(self, steps):  # noqa: ARG001
        raise KernelUnstable("step 3: a position is no longer a finite number")

    monkeypatch.setattr("reference.kernel.program.simulation.ProgramSimulation.advance", advance)
    with pytest.raises(InputError, match="packing: preparation: expected discs that can grow .* step 3"):
        grow_ring(ring(tmp_path), seed=3, cache=tmp_path)
    assert not list(tmp_path.glob("ring-*"))
