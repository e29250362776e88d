"""What the command shows: every value of the scene, what follows from it, and JSON of the same."""

import json

import pytest

from harness.scene.explain import Row, as_json, explain
from harness.scene.resolve import known_system


def rows(sections):
    return {(title, row.name): row for title, lines in sections for row in lines}


def test_box(scenes):
    scene = scenes.load(scenes.biaxial, {"compare.plateau": [0.05, 0.1]})
    found = rows(explain(scene, None, {"kernel:talk": 2.5}))
    assert found["scene", "contact.sliding.shear_friction"].value == 0.5
    assert found["scene", "particles.radius.kind"].value == "uniform"
    assert found["scene", "compare.plateau"].value == "[0.05, 0.1]"
    assert found["particles", "mean mass"].note == "of the declared distribution"
    assert found["contacts", "restitution, mean radius pair, attraction allowed"].note == "as in the scene"
    assert found["time step", "stability margin"].value > 1
    assert found["drive", "inertial number, peak"].unit == ""
    assert found["effects", "gravity"].value == "off"
    assert found["effects", "sliding friction"].note.startswith("contact.sliding: mu = 0.5; ")
    assert found["expected run time", "kernel:talk"].text == "2.5 min"


def test_free(scenes):
    scene = scenes.load(scenes.free, {"planes": [scenes.floor]})
    sections = explain(scene, known_system(scene, scenes.file))
    found = rows(sections)
    assert found["scene", "bodies"].value == 2
    assert found["scene", "planes[0].name"].value == "floor"
    assert found["particles", "mean mass"].value == pytest.approx(1e-5)
    assert [title for title, _ in sections] == ["scene", "particles", "contacts", "time step", "effects"]


def test_overdamped_pairs_say_that_they_have_no_contact_time(scenes):
    scene = scenes.load(scenes.biaxial, {"contact.normal.normal_damping": 2.0, "numerics.dt_fraction": 1e-3})
    note = rows(explain(scene))["contacts", "contact time, smallest pair"].note
    assert note.startswith("pi/sqrt(k/m*), as the pair is overdamped (b/omega_0 = 4.37): no contact time")


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
