"""What the engines get: the box of the talks, and free scenes with all they can call for."""

import math

import numpy as np
import pytest

from harness.errors import InputError
from harness.scene.resolve import (
    known_system,
    needs_packing,
    resolve,
    resolve_biaxial,
    resolve_free,
    scene_name,
)
from harness.scene.system import Constant, Cosine, Loaded


def packing(count=6, spacing=2.2e-3, radius=1e-3):
    grid = spacing * np.stack(np.meshgrid(np.arange(count), np.arange(count)), -1).reshape(-1, 2) + radius
    side = (count - 1) * spacing + 2 * radius
    return {"x": grid, "radius": np.full(count**2, radius), "box": (side, side)}


def test_box(scenes):
    scene = scenes.load(scenes.biaxial)
    side, height = 14e-3, 13e-3
    system = resolve_biaxial(scene, **packing() | {"box": (side, height)}, name="box")
    assert [(w.index, w.name) for w in system.walls] == [(1, "left"), (2, "bottom"), (3, "right"), (4, "top")]
    assert [w.normal for w in system.walls] == [(1, 0), (0, 1), (-1, 0), (0, -1)]
    assert [w.point for w in system.walls] == [(0, 0), (0, 0), (side, 0), (0, height)]
    assert [w.friction for w in system.walls] == [False] * 4
    assert system.wall("left").motion is system.wall("bottom").motion is None
    assert system.wall("right").motion == Loaded(
        mass=2e-4, load=0.0, stress=100.0, span=("bottom", "top"), damping=0.1
    )
    assert system.wall("top").motion == Cosine(travel=0.1 * height, duration=0.01)
    assert system.dt * system.steps == pytest.approx(0.01, rel=1e-15)
    assert (system.scene_name, system.title, system.contacts) == ("box", "box", True)
    assert system.gravity is system.periodic is system.background is None
    assert (system.normal, system.sliding) == (scene.contact.normal, scene.contact.sliding)


def test_box_starts_at_rest_with_the_declared_masses(scenes):
    particles = resolve_biaxial(scenes.load(scenes.biaxial), **packing()).particles
    assert particles.mass == pytest.approx(np.full(36, 4 / 3 * math.pi * 2000 * 1e-9), rel=1e-15)
    assert np.all(particles.inertia_factor == 0.5)
    assert particles.v.shape == (36, 2)
    assert particles.spin.shape == (36, 1)
    assert not particles.v.any()
    assert not particles.spin.any()


def test_all_packings_of_a_scene_have_one_time_step(scenes):
    scene = scenes.load(scenes.biaxial)
    first, second = resolve_biaxial(scene, **packing()), resolve_biaxial(scene, **packing(radius=1.05e-3))
    assert first.dt == second.dt
    assert first.digest() != second.digest()


def test_digest_forgets_names_and_comparisons(scenes):
    scene = scenes.load(scenes.biaxial)
    other = scenes.load(scenes.biaxial, {"title": "another", "compare.plateau": [0.05, 0.1]})
    assert resolve_biaxial(scene, **packing()).digest() == resolve_biaxial(other, **packing(), name="x").digest()


def test_box_refuses_a_disc_outside(scenes):
    start = packing()
    start["x"][7, 0] = -1e-3
    with pytest.raises(InputError, match='disc 8 of the packing, position: expected .* in front of the wall "left"'):
        resolve_biaxial(scenes.load(scenes.biaxial), **start)


def test_box_refuses_to_get_flat(scenes):
    scene = scenes.load(scenes.biaxial, {"top.final_strain": 0.9})
    with pytest.raises(InputError) as caught:
        resolve_biaxial(scene, **packing(), name="flat")
    assert str(caught.value) == (
        "flat.toml: top.final_strain: expected a strain that leaves twice the largest diameter, 0.006 m of 0.013 m, "
        "got 0.9, which leaves 0.0013 m; take more particles or less strain"
    )


def test_free_scene_with_everything(scenes):
    planes = [
        scenes.floor,
        scenes.lid | {"motion": {"kind": "cosine", "travel": 1e-4, "duration": 1e-4}},
        {"name": "west", "point": [-5e-3, 0.0], "normal": [3.0, 4.0], "friction": False,
         "motion": {"kind": "loaded", "mass": 1e-3, "load": 2.0, "damping": 0.5}},
        {"name": "east", "point": [9e-3, 0.0], "normal": [-1.0, 0.0], "friction": True,
         "motion": {"kind": "constant", "velocity": [0.0, 1.0]}},
    ]
    scene = scenes.load(scenes.free, {
        "planes": planes, "gravity": [0.0, -9.81], "background": {"translational_drag": 1e-3},
    })
    system = resolve_free(scene, scenes.folder, name="all")
    assert [w.index for w in system.walls] == [1, 2, 3, 4]
    assert system.wall("floor").normal == (0.0, 1.0)
    assert system.wall("west").normal == (0.6, 0.8)
    assert [w.motion for w in system.walls] == [
        None,
        Cosine(travel=1e-4, duration=1e-4),
        Loaded(mass=1e-3, load=2.0, stress=0.0, span=None, damping=0.5),
        Constant(velocity=(0.0, 1.0)),
    ]
    assert [w.friction for w in system.walls] == [True, False, False, True]
    assert system.gravity == (0.0, -9.81)
    assert system.background.translational_drag == 1e-3
    assert system.particles.v.tolist() == [[0.1, 0.0], [0.0, 0.0]]
    assert system.particles.spin.tolist() == [[3.0], [0.0]]
    assert system.particles.inertia_factor.tolist() == [0.4, 0.5]
    assert system.scene_name == "all"


def test_space(scenes):
    bodies = [{"position": [0.0, 0.0, 0.0], "radius": 1e-3, "mass": 1e-5}]
    scene = scenes.load(scenes.free, {"dimension": 3, "bodies": bodies, "periodic": [0.0, 0.0, 1.0]})
    system = resolve(scene, scenes.file)
    assert system.particles.x.shape == system.particles.spin.shape == (1, 3)
    assert system.periodic == (0.0, 0.0, 1.0)


def test_registry(scenes):
    """`resolve` finds the function of the kind; a box is not resolved without a packing."""
    box, free = scenes.load(scenes.biaxial), scenes.load(scenes.free)
    assert (needs_packing(box), needs_packing(free)) == (True, False)
    assert known_system(box, scenes.file) is None
    assert known_system(free, scenes.file).digest() == resolve(free, scenes.file).digest()
    with pytest.raises(TypeError, match="around a packing"):
        resolve(box, scenes.file)

    class Packing:
        x, radius, box = packing().values()

    assert resolve(box, scenes.file, Packing()).digest() == resolve_biaxial(box, **packing()).digest()


def test_scene_names_are_safe():
    assert scene_name("head_on-2") == "head_on-2"
    assert scene_name("a b;\n$(rm)") == "a_b_rm"
    assert scene_name("..") == "scene"
    assert scene_name("\u00e4" * 5) == "scene"
    assert len(scene_name("x" * 300)) == 60
