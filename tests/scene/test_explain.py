"""What the command shows: every value of the scene, what follows from it, and JSON of the same."""

import json
import math

import pytest

from harness.scene.explain import Row, as_json, explain
from harness.scene.resolve import known_system


def rows(sections):
    return {(title, row.name): row for title, lines in sections for row in lines}


def test_box(scenes):
    scene = scenes.load(scenes.biaxial, {"compare.plateau": [0.05, 0.1]})
    found = rows(explain(scene, None, {"kernel:talk": 150.0, "lammps": 0.25}))
    assert found["scene", "contact.sliding.shear_friction"].value == 0.5
    assert found["scene", "particles.radius.kind"].value == "uniform"
    assert found["scene", "compare.plateau"].value == "[0.05, 0.1]"
    assert found["particles", "mean mass"].note == "of the declared distribution"
    assert found["contacts", "restitution, mean radius pair, attraction allowed"].note == "as in the scene"
    assert found["time step", "stability margin"].value > 1
    assert found["drive", "inertial number, peak"].unit == ""
    assert found["effects", "gravity"].value == "off"
    assert found["effects", "sliding friction"].note.startswith("contact.sliding: spring, mu = 0.5, k_t = 20000 N/m; ")
    assert found["expected run time", "kernel:talk"].text == "2.5 min"
    assert found["expected run time", "lammps"].text == "0.25 s"


def test_free(scenes):
    scene = scenes.load(scenes.free, {"planes": [scenes.floor]})
    sections = explain(scene, known_system(scene, scenes.file))
    found = rows(sections)
    assert found["scene", "bodies"].value == 2
    assert found["scene", "planes[0].name"].value == "floor"
    assert found["particles", "mean mass"].value == pytest.approx(1e-5)
    assert [title for title, _ in sections] == ["scene", "particles", "contacts", "time step", "effects"]


@pytest.mark.parametrize(("x", "count", "note"), [
    (2.1e-3, 0, "nothing touches"), (1.75e-3, 1, "largest 0.00025 m; of bodies with bodies and walls"),
])
def test_initial_overlaps_are_counted(scenes, x, count, note):
    scene = scenes.load(scenes.free, {"bodies.1.position": [x, 2e-3]})
    row = rows(explain(scene, known_system(scene, scenes.file)))["particles", "initial overlaps"]
    assert (row.value, row.note) == (count, note)


def test_overdamped_pairs_say_that_they_have_no_contact_time(scenes):
    scene = scenes.load(scenes.biaxial, {"contact.normal.normal_damping": 2.0, "numerics.dt_fraction": 1e-3})
    note = rows(explain(scene))["contacts", "contact time, smallest pair"].note
    assert note.startswith("pi/sqrt(k/m*), as the pair is overdamped (b/omega_0 = 4.37): no contact time")


def test_what_no_closed_form_gives_is_not_available_and_never_zero(scenes):
    hysteretic = scenes.normals["hysteretic"]
    found = rows(explain(scenes.load(scenes.biaxial, {"contact.normal": hysteretic})))
    row = found["contacts", "restitution, smallest pair"]
    assert (row.value, row.text, row.note) == ("not available",) * 2 + ("no closed form with normal_damping",)
    found = rows(explain(scenes.load(scenes.biaxial, {"contact.normal": hysteretic | {"normal_damping": 0.0}})))
    kept = 0.5 - 2e4 / 5e4 * 5e4**2 / (1e5 * 1.2e5)
    assert found["contacts", "restitution, smallest pair"].value == pytest.approx(math.sqrt(kept))
    assert found["contacts", "time scale, smallest pair"].note == "pi/sqrt(k_2/m* - b^2)"


@pytest.mark.parametrize("law", ["hertz", "dmt", "jkr", "hysteretic_variable"])
def test_other_laws(scenes, law):
    scene = scenes.load(scenes.free, {"contact.normal": scenes.normals[law]})
    found = rows(explain(scene, known_system(scene, scenes.file)))
    names = {name.removesuffix(", only pair") for title, name in found if title == "contacts"}
    assert names >= {
        "hertz": {"contact time", "largest overlap", "restitution, only pair, attraction allowed"},
        "dmt": {"time scale", "largest overlap", "pull-off force", "restitution"},
        "jkr": {"time scale", "largest overlap", "pull-off force", "tearing overlap", "restitution"},
        "hysteretic_variable": {"time scale", "plastic limit delta_max*", "restitution"},
    }[law]
    assert found["time step", "stability margin"].value > 1


def test_json_holds_the_same_rows(scenes):
    scene = scenes.load(scenes.biaxial)
    sections = explain(scene)
    data = json.loads(json.dumps(as_json(sections), allow_nan=False))
    assert [(t, r["name"], r["value"]) for t, lines in data.items() for r in lines] == [
        (t, r.name, r.value) for t, lines in sections for r in lines
    ]


def test_infinite_numbers_are_text_in_json():
    data = as_json([("a", [Row(name="x", value=float("inf"))])])
    assert data["a"][0]["value"] == "inf"


def test_text_of_a_row():
    assert Row(name="dt", value=3.67812e-7, unit="s").text == "3.678e-07 s"
    assert Row(name="steps", value=218000).text == "218000"
    assert Row(name="contacts", value=True).text == "true"
    assert Row(name="law", value="linear").text == "linear"
