"""An effect is on because a table says so, and only then."""

import numpy as np
import pytest

from harness.scene.effects import EFFECTS, effects, effects_on
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
    assert set(effects_on(system)) == {"normal contact"} | added
    assert names(effects(scene, system)) == names(effects(scene)) == set(effects_on(system))


def test_friction_brings_rotation_and_walls_only_if_they_say_so(scenes):
    _, smooth = free(scenes, {"planes": [scenes.lid]})
    _, rough = free(scenes, {"planes": [scenes.floor]})
    assert {"sliding friction", "rotation"} <= set(effects_on(smooth))
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
    assert set(effects_on(system)) == names(effects(scene)) == {
        "normal contact", "normal damping", "damping attraction", "sliding friction", "rotation", "driven walls",
        "loaded walls",
    }


def test_every_effect_says_where_and_why(scenes):
    for found in (effects(scenes.load(scenes.biaxial)), effects(scenes.load(scenes.free))):
        assert [e.name for e in found] == list(EFFECTS)
        assert all(e.place and e.reason and e.brings for e in found)
    places = {e.name: e.place for e in effects(scenes.load(scenes.biaxial))}
    assert places["driven walls"] == "top"
    assert places["loaded walls"] == "side"
