"""An effect is on because a table says so, and only then."""

from typing import get_args

import numpy as np
import pytest

from harness.scene.contact import NormalLaw, RollingLaw, SlidingLaw
from harness.scene.effects import EFFECT_NAMES, EFFECTS, effects, effects_on
from harness.scene.resolve import resolve, resolve_biaxial

LOADED = {"kind": "loaded", "mass": 1e-3, "load": 1.0}
MOVED = {"kind": "constant", "velocity": [0.0, -1.0]}


def names(found, on=True):
    return {e.name for e in found if e.on is on}


def free(scenes, changes):
    scene = scenes.load(scenes.free, changes)
    return scene, resolve(scene, scenes.file)


@pytest.mark.parametrize(
    ("changes", "added"),
    [
        ({}, set()),
        ({"contact.normal.normal_damping": 0.1, "contact.normal.attraction": "clipped"}, {"normal damping"}),
        ({"contact.normal.normal_damping": 0.1}, {"normal damping", "damping attraction"}),
        ({"bodies.0.spin": [1.0]}, {"rotation"}),
        ({"background": {"translational_drag": 1e-3}}, {"background drag"}),
        ({"gravity": [0.0, -9.81]}, {"gravity"}),
        ({"periodic": [1.0, 0.0]}, {"periodic axes"}),
        ({"planes": ["lid"]}, set()),
        ({"planes": ["lid", MOVED]}, {"driven walls"}),
        ({"planes": ["lid", LOADED]}, {"loaded walls"}),
    ],
)
def test_each_table_brings_its_effect_and_no_other(scenes, changes, added):
    bare = {"contact.sliding": scenes.remove, "contact.normal.normal_damping": 0.0, "bodies.0.spin": scenes.remove}
    if "planes" in changes:
        motion = {"motion": changes["planes"][1]} if len(changes["planes"]) > 1 else {}
        changes = {"planes": [scenes.lid | motion]}
    scene, system = free(scenes, bare | changes)
    assert set(effects_on(system)) == {"normal contact: linear"} | added
    assert names(effects(scene, system)) == names(effects(scene)) == without_laws(effects_on(system))


ALWAYS = {"normal damping", "damping attraction"}


@pytest.mark.parametrize(
    ("law", "brought"),
    [
        ("linear", ALWAYS), ("hertz", ALWAYS), ("hysteretic", ALWAYS | {"adhesion", "plastic memory"}),
        ("hysteretic_variable", ALWAYS | {"adhesion", "plastic memory"}), ("dmt", ALWAYS | {"adhesion"}),
        ("jkr", ALWAYS | {"adhesion"}),
    ],
)
def test_normal_laws(scenes, law, brought):
    bare = {"contact.sliding": scenes.remove, "bodies.0.spin": scenes.remove, "contact.normal": scenes.normals[law]}
    scene, system = free(scenes, bare)
    assert set(effects_on(system)) == {f"normal contact: {law}"} | brought
    (contact,) = (e for e in effects(scene) if e.name == "normal contact")
    assert contact.reason.startswith(f"{law}, ")


def test_what_a_law_does_not_have_with_these_numbers_is_off(scenes):
    elastic = {"contact.sliding": scenes.remove, "bodies.0.spin": scenes.remove}
    hertz = scenes.normals["hertz"]
    _, system = free(scenes, elastic | {"contact.normal": hertz | {"restitution": 1.0}})
    assert set(effects_on(system)) == {"normal contact: hertz"}
    _, system = free(scenes, elastic | {"contact.normal": hertz | {"attraction": "clipped"}})
    assert set(effects_on(system)) == {"normal contact: hertz", "normal damping"}
    smooth = scenes.normals["hysteretic"] | {"adhesion_stiffness": 0.0, "normal_damping": 0.0}
    _, system = free(scenes, elastic | {"contact.normal": smooth})
    assert set(effects_on(system)) == {"normal contact: hysteretic", "plastic memory"}


@pytest.mark.parametrize("law", ["spring", "viscous"])
def test_sliding_laws(scenes, law):
    _, system = free(scenes, {"contact.sliding": scenes.slidings[law]})
    assert f"sliding friction: {law}" in effects_on(system)
    assert "dynamic friction" not in effects_on(system)


def test_dynamic_friction(scenes):
    _, system = free(scenes, {"contact.sliding.dynamic_friction": 0.3})
    assert {"sliding friction: spring", "dynamic friction"} <= set(effects_on(system))


@pytest.mark.parametrize("law", ["spring", "constant"])
def test_rolling_alone_turns_particles(scenes, law):
    changes = {"contact.sliding": scenes.remove, "contact.rolling": scenes.rollings[law], "planes": [scenes.floor]}
    scene, system = free(scenes, changes)
    assert {f"rolling resistance: {law}", "rotation", "wall friction"} <= set(effects_on(system))
    reasons = {e.name: e.reason for e in effects(scene)}
    assert reasons["rotation"] == "rolling turns the particles"


def test_torsion(scenes):
    scene, system = free(scenes, scenes.balls | {"contact.torsion": scenes.torsion})
    assert "torsion resistance: spring" in effects_on(system)
    reasons = {e.name: e.reason for e in effects(scene, system)}
    assert reasons["rotation"] == "sliding and torsion turn the particles"


def test_every_law_has_its_name():
    """As many names a mechanism as the scene has laws for it, in the order of the effects."""
    laws = {"normal contact": NormalLaw, "sliding friction": SlidingLaw, "rolling resistance": RollingLaw}
    for effect, union in laws.items():
        words = [law.__struct_config__.tag for law in get_args(union)]
        assert [n for n in EFFECT_NAMES if n.startswith(f"{effect}: ")] == [f"{effect}: {w}" for w in words]
    assert list(dict.fromkeys(n.split(": ")[0] for n in EFFECT_NAMES)) == list(EFFECTS)


def without_laws(found):
    return {name.split(": ")[0] for name in found}


def test_friction_brings_rotation_and_walls_only_if_they_say_so(scenes):
    _, smooth = free(scenes, {"planes": [scenes.lid]})
    _, rough = free(scenes, {"planes": [scenes.floor]})
    assert {"sliding friction: spring", "rotation"} <= set(effects_on(smooth))
    assert set(effects_on(rough)) - set(effects_on(smooth)) == {"wall friction"}


def test_spins_from_a_file_are_known_once_resolved(scenes):
    scenes.write("x,y,radius,mass,wz\n0,0,1e-3,1e-5,2\n", "b.csv")
    changes = {"bodies": scenes.remove, "bodies_file": "b.csv", "contact.sliding": scenes.remove}
    scene, system = free(scenes, changes)
    assert "rotation" in names(effects(scene, system))


def test_box(scenes):
    scene = scenes.load(scenes.biaxial)
    grid = 2.2e-3 * np.stack(np.meshgrid(np.arange(6), np.arange(6)), -1).reshape(-1, 2) + 1e-3
    system = resolve_biaxial(scene, x=grid, radius=np.full(36, 1e-3), box=(13e-3, 13e-3))
    assert set(effects_on(system)) == {
        "normal contact: linear", "normal damping", "damping attraction", "sliding friction: spring", "rotation",
        "driven walls", "loaded walls",
    }
    assert without_laws(effects_on(system)) == names(effects(scene))


def test_every_effect_says_where_and_why(scenes):
    for found in (effects(scenes.load(scenes.biaxial)), effects(scenes.load(scenes.free))):
        assert [e.name for e in found] == list(EFFECTS)
        assert all(e.place and e.reason and e.brings for e in found)
    places = {e.name: e.place for e in effects(scenes.load(scenes.biaxial))}
    assert places["driven walls"] == "top"
    assert places["loaded walls"] == "side"
