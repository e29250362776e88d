"""Nonsensical laws are refused with one clear line, and what only looks odd is not."""

import pytest

from harness.scene.model import Biaxial, Free

NOTHING = "an effect that is off does not exist"

REFUSALS = [
    (
        {"contact.normal": ("hysteretic", {"unloading_stiffness": 4e4})},
        "contact.normal.unloading_stiffness: expected a number >= contact.normal.loading_stiffness = 50000, got 40000; "
        "k_2 < k_1 would make energy",
    ),
    (
        {"contact.normal": ("hysteretic_variable", {"largest_unloading_stiffness": 5e4})},
        "contact.normal.largest_unloading_stiffness: expected a number > contact.normal.loading_stiffness = 50000, "
        'got 50000; k_2 grows from k_1 to k_p; for a constant k_2 take law = "hysteretic"',
    ),
    (
        {"contact.normal": ("hysteretic", {"adhesion_stiffness": -1.0})},
        "contact.normal.adhesion_stiffness: expected a number >= 0, got -1.0",
    ),
    (
        {"contact.normal": ("hysteretic_variable", {"plasticity_depth": 1.0})},
        "contact.normal.plasticity_depth: expected a number > 0 and < 1, got 1.0",
    ),
    (
        {"contact.normal": ("hertz", {"restitution": 1.2})},
        "contact.normal.restitution: expected a number > 0 and <= 1, got 1.2",
    ),
    (
        {"contact.normal": ("hertz", {"restitution": 0.0})},
        "contact.normal.restitution: expected a number > 0 and <= 1, got 0.0",
    ),
    (
        {"contact.normal": ("hertz", {"poisson_ratio": 0.6})},
        "contact.normal.poisson_ratio: expected a number > -1 and <= 0.5, got 0.6",
    ),
    (
        {"contact.normal": ("dmt", {"surface_energy": 0.0})},
        "contact.normal.surface_energy: expected a number > 0, got 0.0",
    ),
    (
        {"contact.sliding.dynamic_friction": 0.6},
        "contact.sliding.dynamic_friction: expected a number <= contact.sliding.shear_friction = 0.5, got 0.6",
    ),
    (
        {"contact.sliding": {"law": "mindlin", "shear_friction": 0.5}},
        'contact.sliding.law: expected "spring" or "viscous", as contact.normal.law = "linear", got "mindlin"; '
        "mindlin goes with hertz only",
    ),
    (
        {"contact.sliding": {"law": "viscous", "shear_friction": 0.0, "shear_damping": 0.1}},
        "contact.sliding.shear_friction: expected a number > 0, got 0.0",
    ),
    (
        {"contact.torsion": {"law": "spring", "torsion_friction": 0.1, "torsion_stiffness": 1e4, "torsion_damping": 0}},
        "contact.torsion: expected no table in 2D, where nothing twists, got a table; remove it",
    ),
    (
        {"contact.rolling": {"law": "elastic"}},
        'contact.rolling.law: expected "spring" or "constant", got "elastic"',
    ),
    (
        {"contact.normal": ("hertz", {"impact_speed": 100.0})},
        "contact.normal.impact_speed: expected a speed at which the overlap stays below R*/2 = 0.00025 m, got 100, "
        "which presses the only pair 0.00103 m together; lower it, or make the bodies stiffer",
    ),
]


def with_laws(scenes, changes):
    """Write out (law, changes of its table)."""
    return {p: scenes.normals[v[0]] | v[1] if isinstance(v, tuple) else v for p, v in changes.items()}


@pytest.mark.parametrize(("changes", "message"), REFUSALS)
def test_refused(scenes, changes, message):
    assert scenes.refusal(scenes.free, with_laws(scenes, changes)).startswith(f"scene.toml: {message}")


@pytest.mark.parametrize("law", ["hertz", "dmt", "jkr"])
def test_laws_whose_packing_cannot_be_balanced(scenes, law):
    assert scenes.refusal(scenes.biaxial, {"contact.normal": scenes.normals[law]}) == (
        'scene.toml: contact.normal.law: expected "linear", "hysteretic" or "hysteretic_variable" in a biaxial box, '
        f'whose packing is balanced with linear springs, got "{law}"; '
        'such contacts can be had in a scene with kind = "free"'
    )


@pytest.mark.parametrize("law", ["hysteretic", "hysteretic_variable"])
def test_box_with_memory(scenes, law):
    assert isinstance(scenes.load(scenes.biaxial, {"contact.normal": scenes.normals[law]}), Biaxial)


@pytest.mark.parametrize("normal", ["linear", "hertz", "hysteretic", "hysteretic_variable", "dmt", "jkr"])
@pytest.mark.parametrize("sliding", ["spring", "mindlin", "viscous", None])
@pytest.mark.parametrize("rolling", ["spring", "constant", None])
@pytest.mark.parametrize("torsion", [True, False])
def test_laws_combine_freely(shared_scenes, normal, sliding, rolling, torsion):
    """In space, at particles and at a plane; only Mindlin asks for Hertz."""
    scenes = shared_scenes
    laws = {"normal": scenes.normals[normal]}
    laws |= {"sliding": scenes.slidings[sliding]} if sliding else {}
    laws |= {"rolling": scenes.rollings[rolling]} if rolling else {}
    laws |= {"torsion": scenes.torsion} if torsion else {}
    floor = scenes.floor | {"point": [0.0] * 3, "normal": [0.0, 1.0, 0.0], "friction": len(laws) > 1}
    changes = scenes.balls | {"contact": laws, "planes": [floor], "numerics.dt_fraction": 0.005}
    if sliding == "mindlin" and normal != "hertz":
        assert "mindlin goes with hertz only" in scenes.refusal(scenes.free, changes)
    else:
        assert isinstance(scenes.load(scenes.free, changes), Free)


def test_equal_coefficients_of_friction_are_allowed(scenes):
    assert isinstance(scenes.load(scenes.free, {"contact.sliding.dynamic_friction": 0.5}), Free)


def test_constant_hysteresis_may_have_equal_stiffnesses(scenes):
    equal = scenes.normals["hysteretic"] | {"unloading_stiffness": 5e4}
    assert isinstance(scenes.load(scenes.free, {"contact.normal": equal}), Free)


def test_overdamped_hysteresis_runs_with_a_smaller_step(scenes):
    damped = scenes.normals["hysteretic"] | {"normal_damping": 3.0}
    changes = {"contact.normal": damped, "numerics.dt_fraction": 1e-3}
    assert isinstance(scenes.load(scenes.free, changes), Free)


@pytest.mark.parametrize("place", ["body", "wall"])
def test_bodies_pressed_deeper_than_an_impact_presses_them(scenes, place):
    """The time step is made for that impact; raising its speed is the cure."""
    start = {"bodies.1.position": [1.95e-3, 2e-3]} if place == "body" else {
        "planes": [scenes.floor | {"point": [0.0, 1.05e-3]}]
    }
    changes = start | {"contact.normal": scenes.normals["hertz"]}
    message = scenes.refusal(scenes.free, changes)
    number = 1 if place == "body" else 0
    assert message.startswith(f"scene.toml: bodies[{number}].position: expected an overlap of at most ")
    assert message.endswith(
        "m, that of an impact at contact.normal.impact_speed, got 5e-05 m; move them apart, or raise impact_speed"
    )
    assert isinstance(scenes.load(scenes.free, changes | {"contact.normal.impact_speed": 10.0}), Free)


def test_rotations_need_a_law_that_turns(scenes):
    changes = {"outputs.rotations": True, "contact.sliding": scenes.remove}
    assert scenes.refusal(scenes.free, changes) == (
        "scene.toml: outputs.rotations: expected false without contact.sliding or contact.rolling, as nothing turns "
        "the particles, got true; remove it"
    )
    assert isinstance(scenes.load(scenes.free, changes | {"contact.rolling": scenes.rollings["constant"]}), Free)


@pytest.mark.parametrize("table", ["rolling", "torsion"])
def test_rough_plane_with_any_law_that_turns(scenes, table):
    law = scenes.torsion if table == "torsion" else scenes.rollings["spring"]
    floor = scenes.floor | {"point": [0.0] * 3, "normal": [0.0, 1.0, 0.0]}
    changes = scenes.balls | {"contact.sliding": scenes.remove, f"contact.{table}": law, "planes": [floor]}
    assert isinstance(scenes.load(scenes.free, changes), Free)
