"""The Couette ring: what is refused, where glued discs stand, which densities it has, what system it means."""

import math

import numpy as np
import pytest

from harness.packing.stand_in import stand_in
from harness.scene.explain import explain
from harness.scene.model import Couette
from harness.scene.resolve import needs_packing, resolve
from harness.scene.ring import area_fractions, free_bounds, glued_discs, rings_of


@pytest.fixture(scope="module")
def scene(shared_scenes):
    return shared_scenes.load(shared_scenes.ring)


REFUSED = [
    ({"contact.normal.law": "hertz"}, "contact.normal"),
    ({"rings.outer_radius": 0.03}, 'rings.outer_radius: expected at least 0.05846'),
    ({"rings.grain_radius": 0.011}, "rings.grain_radius: expected at most half of rings.inner_radius = 0.02"),
    ({"rings.grain_radius": 1e-20}, "rings.grain_radius: expected a radius of which at most 1000000"),
    ({"particles.species": [{"count": 600000, "radius": 1e-6}] * 2}, "species: expected at most 1000000 discs"),
    ({"rings.omega": 0.0}, "rings.omega: expected a rate that is not 0, got 0"),
    ({"particles.species.0.count": 600}, "particles.species: expected discs that fill at most 0.9"),
    ({"preparation.start_size": 0.9}, "preparation.start_size: expected at most 0.71"),
    ({"preparation.start_size": 1.0}, "preparation.start_size: expected a number > 0 and < 1"),
    ({"particles.species": []}, "particles.species"),
    ({"compare.steady_from": 0.095}, "compare.steady_from: expected at most 0.09"),
    ({"compare.band": 0.001}, "compare.band: expected a width from four cells to the gap"),
    ({"compare.windows": [{"pairs": "codes", "time": 0.2, "tolerance": 1e-3}]}, "compare.windows[0].time"),
    ({"planes": []}, "planes: expected one of"),
    ({"numerics.dt_fraction": 0.5}, "numerics.dt_fraction: expected at most"),
]


@pytest.mark.parametrize(("changes", "message"), REFUSED)
def test_refused(scenes, changes, message):
    assert message in scenes.refusal(scenes.ring, changes)


def test_other_normal_laws_are_refused(scenes):
    message = scenes.refusal(scenes.ring, {"contact.normal": scenes.normals["hertz"]})
    assert 'contact.normal.law: expected "linear" in a ring, got "hertz"' in message


def test_glued_discs_touch_and_stand_on_the_circle():
    x = glued_discs(0.02, 1.25e-3)
    assert len(x) == round(math.pi * 0.02 / 1.25e-3) == 50
    assert np.allclose(np.hypot(*x.T), 0.02, rtol=0, atol=1e-12)
    spacing = np.linalg.norm(x - np.roll(x, 1, axis=0), axis=1)
    assert np.allclose(spacing, 2 * 0.02 * math.sin(math.pi / 50), rtol=1e-9)
    assert abs(spacing[0] / 2.5e-3 - 1) < 0.02


def test_area_fractions_count_discs_over_both_annuli(scene):
    discs = 140 * 3.71e-3**2 + 23 * 4.495e-3**2
    nu = area_fractions(scene)
    assert nu["bare"] == pytest.approx(discs / (0.06**2 - 0.02**2), rel=1e-14)
    low, high = free_bounds(scene.rings)
    assert (low, high) == pytest.approx((0.02125, 0.05875))
    assert nu["free"] == pytest.approx(discs / (high**2 - low**2), rel=1e-14)


def test_the_inner_ring_turns_and_the_outer_one_rests(scene):
    inner, outer = rings_of(scene)
    assert (inner.index, inner.name, inner.omega, inner.circle) == (1, "inner", 1.0, 0.02)
    assert (outer.index, outer.name, outer.omega, outer.circle) == (2, "outer", None, 0.06)


def test_resolved(scene, shared_scenes):
    assert isinstance(scene, Couette)
    assert needs_packing(scene)
    system = resolve(scene, shared_scenes.file, stand_in(scene))
    assert system.walls == ()
    assert [r.name for r in system.rings] == ["inner", "outer"]
    assert len(system.particles) == 163
    assert system.particles.mass[0] == pytest.approx(math.pi * 1060 * 6e-3 * 3.71e-3**2)
    assert system.steps * system.dt == pytest.approx(0.1)
    with pytest.raises(TypeError, match="around flowing discs"):
        resolve(scene, shared_scenes.file)


def test_a_ring_is_part_of_the_hash(scene, shared_scenes):
    system = resolve(scene, shared_scenes.file, stand_in(scene))
    inner, outer = system.rings
    faster = system.with_(rings=(type(inner)(**{**vars(inner), "omega": 2.0}), outer))
    assert faster.digest() != system.digest()
    assert system.with_(rings=()).digest() != system.digest()
    assert "rings" not in system.with_(rings=()).identity()


def test_explained(scene):
    sections = {title: {r.name: r for r in rows} for title, rows in explain(scene)}
    assert sections["rings"]["discs glued on the inner ring"].value == 50
    assert sections["rings"]["speed of the inner ring"].value == pytest.approx(0.02)
    assert sections["effects"]["glued rings"].value == "on"
    assert sections["effects"]["driven walls"].value == "off"


def test_a_stand_in_is_the_same_each_time_and_lies_between_the_rings(scene):
    a, b = stand_in(scene), stand_in(scene)
    assert a.x.tobytes() == b.x.tobytes()
    distance = np.hypot(*a.x.T)
    low, high = free_bounds(scene.rings)
    assert (distance > low).all()
    assert (distance < high).all()
