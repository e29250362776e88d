"""Materials: numbers by pair, refused with one clear line where they mean nothing, and nothing at all without them."""

import math
from dataclasses import replace

import numpy as np
import pytest

from harness.errors import InputError
from harness.scene.contact import LinearNormal, SpringSliding
from harness.scene.derived import derive
from harness.scene.effects import effects, effects_on
from harness.scene.explain import explain
from harness.scene.frontier import late_springs
from harness.scene.load import load_scene
from harness.scene.materials import by_law, contact_of, laws_between, stiffness_of_contacts
from harness.scene.numerics import particle_limit
from harness.scene.resolve import resolve
from harness.scene.write import scene_text
from harness.studies.frontier.formula import formula_limit

STIFF = {"materials": ["stiff", "stiff"], "normal": {"normal_stiffness": 1e7, "normal_damping": 2.0}}
MIXED = {
    "materials": ["soft", "stiff"], "normal": {"normal_stiffness": 2e3, "normal_damping": 0.0},
    "sliding": {"shear_friction": 0.2, "shear_stiffness": 5e2, "shear_damping": 0.01},
}
BODIES = [
    {"position": [0.0, 2e-3], "radius": 1e-3, "mass": 1e-5, "inertia": "disc", "material": "stiff"},
    {"position": [2.1e-3, 2e-3], "radius": 1e-3, "mass": 2e-5, "inertia": "disc", "material": "soft"},
    {"position": [4.2e-3, 2e-3], "radius": 1e-3, "mass": 3e-5, "inertia": "disc", "material": "stiff"},
    {"position": [6.3e-3, 2e-3], "radius": 1e-3, "mass": 4e-5, "inertia": "disc"},
]
THREE = {"bodies": BODIES, "contact.between": [STIFF, MIXED], "outputs.contacts": True}

REFUSALS = [
    (
        {"bodies.0.material": "stif"},
        'bodies[0].material: expected one of soft, stiff, got "stif"; did you mean stiff?',
    ),
    ({"bodies.0.material": "Stiff"}, "bodies[0].material: expected a word of up to 24 lower-case letters"),
    ({"bodies.0.material": 3}, "bodies[0].material: expected a word of up to 24 lower-case letters"),
    (
        {"contact.between": [STIFF, MIXED, {**MIXED, "materials": ["stiff", "soft"]}]},
        "contact.between[2].materials: expected a pair without an entry so far, got [\"stiff\", \"soft\"]; "
        "contact.between[1] has it; remove one",
    ),
    (
        {"contact.between": [STIFF, {**MIXED, "materials": ["stiff", "softer"]}]},
        "bodies[1].material: expected one of softer, stiff, got \"soft\"; did you mean softer?",
    ),
    (
        {"contact.between": [STIFF, MIXED, {**STIFF, "materials": ["stiff", "rubber"]}]},
        "contact.between[2].materials: expected materials that bodies or planes have, got \"rubber\"; "
        "write material = \"rubber\" in a body",
    ),
    (
        {"contact.between": [{**STIFF, "materials": ["stiff"]}]},
        "contact.between[0].materials: expected an array of 2 words",
    ),
    (
        {"contact.between": [{**STIFF, "normal": {"normal_stiffness": 1e7}}]},
        "contact.between[0].normal.normal_damping: expected a number >= 0, got nothing; add normal_damping",
    ),
    (
        {"contact.between": [{**STIFF, "normal": {"normal_stiffness": 0.0, "normal_damping": 0.0}}]},
        "contact.between[0].normal.normal_stiffness: expected a number > 0, got 0.0",
    ),
    (
        {"contact.between": [{**STIFF, "normal": {"law": "hertz", "normal_stiffness": 1.0, "normal_damping": 0.0}}]},
        "contact.between[0].normal.law: expected one of normal_stiffness, normal_damping, got the unknown key \"law\"",
    ),
    (
        {"contact.between.1.sliding.shear_friction": 0.0},
        "contact.between[1].sliding.shear_friction: expected a number > 0, got 0.0",
    ),
    (
        {"contact.sliding.dynamic_friction": 0.1},
        "contact.between: expected no table beside contact.sliding.dynamic_friction, got a table; "
        "remove it, or the dynamic coefficient",
    ),
    (
        {"contact.sliding": {"law": "viscous", "shear_friction": 0.5, "shear_damping": 0.1}},
        "contact.between: expected no table beside contact.sliding.law = \"viscous\", got a table; "
        "take contact.sliding.law = \"spring\", or remove it",
    ),
    (
        {"contact.rolling": {"law": "constant", "rolling_friction": 0.1}},
        "contact.between: expected no table beside a table contact.rolling, got a table; remove it, or contact.rolling",
    ),
]


@pytest.fixture
def three(scenes):
    """A scene of two stiff bodies, a soft one and one without a word, with its system."""
    def make(changes=None):
        scene = scenes.load(scenes.edited(scenes.free, THREE), changes)
        return scene, resolve(scene, scenes.file)

    return make


@pytest.mark.parametrize(("changes", "message"), REFUSALS)
def test_refused(scenes, changes, message):
    assert scenes.refusal(scenes.edited(scenes.free, THREE), changes).startswith(f"scene.toml: {message}")


def test_sliding_numbers_need_a_sliding_law(scenes):
    message = scenes.refusal(scenes.edited(scenes.free, THREE), {"contact.sliding": scenes.remove})
    assert message == (
        "scene.toml: contact.between[1].sliding: expected no table, as there is no contact.sliding, got a table; "
        "remove it, or add contact.sliding with the numbers of all other pairs"
    )


@pytest.mark.parametrize("law", ["hertz", "hysteretic", "hysteretic_variable", "dmt", "jkr"])
def test_other_normal_laws_have_one_set_of_numbers(scenes, law):
    changes = {"contact.normal": scenes.normals[law], "contact.between": [STIFF], "contact.sliding": scenes.remove}
    assert scenes.refusal(scenes.edited(scenes.free, THREE), changes).startswith(
        f'scene.toml: contact.between: expected no table beside contact.normal.law = "{law}"'
    )


@pytest.mark.parametrize("kind", ["biaxial", "ring"])
def test_other_kinds_of_scenes_have_one_material(scenes, kind):
    message = scenes.refusal(getattr(scenes, kind), {"contact.between": [STIFF]})
    assert message.startswith("scene.toml: contact.between: expected no such table in a scene with kind = ")
    assert message.endswith('got a table; remove it, or take kind = "free"')


def test_a_material_without_a_table_is_refused(scenes):
    assert scenes.refusal(scenes.free, {"bodies.0.material": "soft"}) == (
        'scene.toml: bodies[0].material: expected no material, as there is no table contact.between, got "soft"; '
        'add [[contact.between]] with materials = ["soft", "soft"]'
    )
    assert scenes.refusal(scenes.free, {"planes": [{**scenes.floor, "material": "soft"}]}).startswith(
        "scene.toml: planes[0].material: expected no material"
    )


def test_materials_of_a_file(scenes, three):
    """They are those of the scene, and a wrong one is named with its line."""
    scene, system = three()
    rows = [f"{b['position'][0]},{b['position'][1]},1e-3,{b['mass']},disc,{b.get('material', '')}" for b in BODIES]
    header = "x,y,radius,mass,inertia,material"
    scenes.write("\n".join([header, *rows, ""]), name="bodies.csv")
    changes = {"bodies": scenes.remove, "bodies_file": "bodies.csv"}
    again = scenes.load(scenes.edited(scenes.free, THREE), changes)
    assert resolve(again, scenes.file).digest() == system.digest()
    assert [e.on for e in effects(again) if e.name == "materials"] == [True]
    scenes.write("\n".join([header, *rows, rows[0].replace("stiff", "hard"), ""]), name="bodies.csv")
    with pytest.raises(InputError, match=r"bodies.csv: line 6, material: expected one of soft, stiff, got .hard"):
        load_scene(scenes.file)
    scenes.write("\n".join([header, rows[0].replace("stiff", "St!ff"), ""]), name="bodies.csv")
    with pytest.raises(InputError, match=r"bodies.csv: line 2, column material: expected a material"):
        load_scene(scenes.file)


def test_every_pair_has_its_entry_or_the_numbers_of_the_contact(scenes, three):
    scene, system = three({"planes": [{**scenes.floor, "material": "soft"}]})
    stiff = LinearNormal(normal_stiffness=1e7, normal_damping=2.0, attraction="allowed")
    base = scene.contact.normal
    assert system.materials.names == ("", "soft", "stiff")
    assert system.particles.material.tolist() == ["stiff", "soft", "stiff", ""]
    assert system.walls[0].material == "soft"
    assert system.between("stiff", "stiff").normal == stiff
    assert system.between("stiff", "stiff").sliding == scene.contact.sliding
    mixed = system.between("soft", "stiff")
    assert (mixed.normal.normal_stiffness, mixed.normal.normal_damping) == (2e3, 0.0)
    assert mixed.sliding == SpringSliding(shear_friction=0.2, shear_stiffness=5e2, shear_damping=0.01)
    assert system.between("stiff", "soft").normal == mixed.normal
    for one, other in [("", ""), ("", "soft"), ("", "stiff"), ("soft", "soft")]:
        assert system.between(one, other).normal == base
    assert system.materials.table("normal", "normal_stiffness").tolist() == [
        [1e5, 1e5, 1e5], [1e5, 1e5, 2e3], [1e5, 2e3, 1e7],
    ]
    first, second = np.array([0, 0, 1, 0, 1]), np.array([1, 2, 3, -1, -1])
    assert stiffness_of_contacts(system, first, second).tolist() == [2e3, 1e7, 1e5, 2e3, 1e5]
    assert sorted(k for _, which in by_law(system, first, second) for k in which) == [0, 1, 2, 3, 4]


def test_without_materials_nothing_changes(scenes):
    """No array, no key of the hash, no law of its own."""
    system = resolve(scenes.load(scenes.free), scenes.file)
    assert system.materials is system.particles.material is None
    assert not {"materials", "material"} & {*system.identity(), *(k for w in system.identity()["walls"] for k in w)}
    assert system.between(None, None) is system
    assert system.of_pairs == (system,)
    assert [(pair is system, which) for pair, which in by_law(system, np.arange(3), np.arange(3))] == [
        (True, slice(None))
    ]
    assert "materials" not in effects_on(system)


def test_numbers_and_materials_decide_on_the_hash(three):
    scene, system = three()
    other = three({"contact.between.0.normal.normal_stiffness": 1.1e7})[1]
    moved = replace(system.particles, material=system.particles.material[::-1])
    assert len({system.digest(), other.digest(), system.with_(particles=moved).digest()}) == 3


def test_written_and_read_again(scenes, three):
    scene, system = three({"planes": [{**scenes.floor, "material": "soft"}]})
    scenes.write(scene_text(scene))
    again = load_scene(scenes.file)
    assert again == scene
    assert resolve(again, scenes.file).digest() == system.digest()


def test_the_step_follows_the_pair_with_the_shortest_time(three):
    """Of the lightest bodies of each two materials: the two stiff ones, 1e-5 and 3e-5 kg."""
    scene, system = three()
    derived = derive(scene, system)
    mass = 1e-5 * 3e-5 / 4e-5
    exact = math.pi / math.sqrt(1e7 / mass - (2.0 / (2 * mass)) ** 2)
    assert [p.pair.name for p in derived.pairs][0] == "stiff-stiff"
    assert derived.pairs[0].met.time_scale == pytest.approx(exact, rel=1e-14)
    assert 0.9 * 0.05 * exact < derived.plan.dt <= 0.05 * exact
    assert {p.pair.materials for p in derived.pairs} == {
        ("stiff", "stiff"), ("soft", "stiff"), ("", "soft"), ("", "stiff")
    }


def test_a_stiff_wall_sets_the_step_too(scenes, three):
    """A soft body alone on it meets it with its own mass; pairs that nobody makes are not asked."""
    walls = {"planes": [{**scenes.floor, "material": "stiff"}], "bodies": BODIES[1:2], "contact.between": [MIXED]}
    walls["duration"] = 1e-2
    scene, system = three(walls)
    (only,) = derive(scene, system).pairs
    assert (only.pair.name, only.pair.at_wall, only.pair.reduced_mass) == ("soft-wall of stiff", True, 2e-5)
    assert only.met.time_scale == pytest.approx(math.pi / math.sqrt(2e3 / 2e-5), rel=1e-14)


def test_the_stability_limit_is_that_of_the_worst_material(scenes, three):
    """w^2 = 6 k/m of the stiff ones, whatever the soft ones weigh, until these are so light that they count."""
    undamped = {"normal_stiffness": 1e7, "normal_damping": 0.0}
    entries = [STIFF | {"normal": undamped}, {k: MIXED[k] for k in ("materials", "normal")}]
    smooth = {"contact.sliding": scenes.remove, "contact.between": entries, "contact.normal.normal_damping": 0.0}
    for soft, square in ((1e-7, 6 * 1e7 / 1e-5), (1e-5, 6 * 1e7 / 1e-5), (1e-9, 6 * 1e5 / 1e-9)):
        scene, system = three(smooth | {"bodies.1.mass": soft, "numerics.dt_fraction": 0.01})
        limit = particle_limit(scene.contact, derive(scene, system).grains)
        assert limit.dt == pytest.approx(2 / math.sqrt(square), rel=1e-12)


@pytest.mark.parametrize("wall", [None, "stiff"])
def test_the_limit_of_a_system_is_that_of_its_scene(scenes, three, wall):
    """`formula_limit` makes the laws of the scene of the system's again; a stiff wall under soft bodies counts."""
    planes = [{**scenes.floor, "material": wall}] if wall else []
    bodies = [b | {"material": "soft"} if wall else b for b in BODIES]
    changes = {"planes": planes, "bodies": bodies, "contact.between": [MIXED] if wall else [STIFF, MIXED]}
    scene, system = three(changes)
    limit = particle_limit(scene.contact, derive(scene, system).grains)
    assert formula_limit(system) == pytest.approx(limit.dt, rel=1e-14)
    assert contact_of(system.between("soft", "stiff")) == laws_between(scene.contact, "soft", "stiff")


def test_what_scene_says_names_every_pair(three):
    scene, system = three()
    rows = {r.name: r for r in dict(explain(scene, system))["contacts"]}
    assert rows["stiffness, soft-stiff pair"].value == 2e3
    assert rows["stiffness, soft-stiff pair"].note.startswith("contact.between[1]; m* = 6.667e-06 kg")
    assert rows["stiffness, without material-soft pair"].note.startswith("contact.normal; ")
    assert rows["restitution, soft-stiff pair, attraction allowed"].value == 1.0
    e = math.exp(-1.0 / 7.5e-6 * rows["contact time, stiff-stiff pair"].value)
    assert rows["restitution, stiff-stiff pair, attraction allowed"].value == pytest.approx(e, rel=1e-12)
    time = {r.name: r for r in dict(explain(scene, system))["time step"]}
    assert "stiff-stiff pair" in time["steps per contact"].note


def test_dashpots_of_pairs_are_effects(three):
    """A contact without damping that has it between two materials has normal damping."""
    scene, system = three({"contact.normal.normal_damping": 0.0})
    assert {"materials", "normal damping", "damping attraction"} <= set(effects_on(system))
    found = {e.name: e for e in effects(scene)}
    assert found["normal damping"].reason == "2 kg/s"
    assert found["materials"].reason == "numbers by pair of soft, stiff"


def test_late_springs_are_those_of_the_pair_that_is_held_least(three):
    scene, system = three()
    (late,) = late_springs(scene.contact, derive(scene, system))
    assert late.held == pytest.approx(0.025 / 2e4)
    assert late.at == " of the stiff-stiff pair"
