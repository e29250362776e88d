"""What a switch writes, what goes with it, and when it refuses."""

import math
from pathlib import Path

import pytest
from msgspec.structs import replace

from harness.scene.grains import grains_of
from harness.scene.load import load_scene
from harness.scene.resolve import resolve
from harness.studies.effects.of_normal import RESTITUTION, damping_for
from harness.studies.effects.switches import SWITCHES
from harness.studies.effects.turned import NotSwitched, stiffness_of
from harness.studies.effects.variants import variants_of, without
from harness.studies.prepare import Prepared
from reference.analytic.linear_collision import LinearCollision

SCENES = Path(__file__).resolve().parents[3] / "inputs" / "scenes"


def loaded(name):
    file = SCENES / f"{name}.toml"
    scene = load_scene(file)
    system = resolve(scene, file)
    return scene, file, [Prepared(number=0, system=system, packing=None)]


def variants(name):
    scene, file, starts = loaded(name)
    return {v.effect.name: v for v in variants_of(scene, file, starts)}


def test_only_one_effect_changes_and_the_rest_is_told():
    found = variants("oblique")
    assert found["normal damping"].also == ("-damping attraction",)
    assert found["sliding friction"].also == (), "spins that stand in the scene stay"
    assert variants("oblique_impact")["sliding friction"].also == ("-rotation",)
    assert found["background drag"].also == ()
    assert found["adhesion"].also == ("+plastic memory",)


def test_what_cannot_be_switched_says_why():
    found = variants("oblique")
    assert "pass through each other" in found["normal contact"].reason
    assert "plane" in found["torsion resistance"].reason
    assert found["wall friction"].scene is None
    assert found["wall friction"].reason == "there is no plane"


def test_smooth_walls_come_with_the_last_law_that_turns():
    found = variants("spinning_sphere")["torsion resistance"]
    assert found.also == ("-wall friction",), "the spin that stands in the scene stays"
    assert not any(p.friction for p in found.scene.planes)


def test_damping_has_the_stated_restitution():
    scene, _, starts = loaded("oblique_impact")
    grains = grains_of(scene, starts[0].system.particles)
    gamma = damping_for(scene, grains)
    met = LinearCollision(
        stiffness=scene.contact.normal.normal_stiffness, damping=gamma, reduced_mass=grains.pairs[0].reduced_mass
    )
    assert math.isclose(met.restitution("allowed"), RESTITUTION, rel_tol=1e-12)


def test_on_and_off_again_is_the_scene_as_it_was():
    scene, file, starts = loaded("oblique")
    grains = grains_of(scene, starts[0].system.particles)
    for v in variants_of(scene, file, starts):
        if v.scene is not None and not v.effect.on:
            assert SWITCHES[v.effect.name].off(v.scene, grains).scene.contact.sliding == scene.contact.sliding
            back = without(v.scene, [v.effect.name], grains)
            assert resolve(back, file).with_(dt=1.0, steps=1).identity()["background"] == (
                starts[0].system.identity()["background"]
            )


def test_several_go_together_and_one_that_is_gone_stays_gone():
    scene, _, starts = loaded("oblique")
    grains = grains_of(scene, starts[0].system.particles)
    bare = without(scene, ["normal damping", "damping attraction", "sliding friction"], grains)
    assert bare.contact.normal.normal_damping == 0.0
    assert bare.contact.normal.attraction == "allowed", "without a dashpot there was nothing to clip any more"
    assert bare.contact.sliding is None


def test_laws_with_numbers_by_pair_are_not_switched():
    file = SCENES.parent / "hard_cases" / "stiff_and_soft_bodies.toml"
    scene = load_scene(file)
    system = resolve(scene, file)
    start = Prepared(number=0, system=system, packing=None)
    found = {v.effect.name: v for v in variants_of(scene, file, [start])}
    for name in ("normal damping", "damping attraction", "sliding friction", "rolling resistance"):
        assert found[name].scene is None
        assert "contact.between has numbers of its own" in found[name].reason
    assert found["gravity"].scene.contact.between == scene.contact.between
    assert stiffness_of(scene, grains_of(scene, system.particles)) == 1e7, "of the stiffest pair"


def test_a_law_without_the_switch_refuses():
    scene, _, starts = loaded("hysteretic_impact")
    grains = grains_of(scene, starts[0].system.particles)
    with pytest.raises(NotSwitched, match="does not clip"):
        SWITCHES["damping attraction"].off(scene, grains)
    damped = replace(scene, contact=replace(scene.contact, normal=replace(scene.contact.normal, normal_damping=1e-3)))
    assert SWITCHES["normal damping"].off(damped, grains).scene.contact.normal.normal_damping == 0.0
