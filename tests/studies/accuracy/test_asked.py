"""Requests that a scene cannot answer are refused in one line."""

from pathlib import Path

import pytest

from harness.errors import InputError
from harness.scene.load import load_scene
from harness.studies.accuracy.asked import asked, asked_all

FOLDER = Path(__file__).resolve().parents[3] / "inputs" / "scenes"
FILE = FOLDER / "oblique_impact.toml"


def ask(scene="oblique_impact", **words):
    file = FOLDER / f"{scene}.toml"
    return asked(load_scene(file), file, **({"knob": None, "ladder": None, "quantity": None} | words))


def test_the_usual_request():
    found = ask()
    assert (found.knob.name, found.quantity) == ("dt", "exit")
    assert len(found.values) >= 5
    assert list(found.values) == sorted(found.values, reverse=True)
    assert ask(ladder=[0.01, 0.04, 0.02]).values == (0.04, 0.02, 0.01)


@pytest.mark.parametrize(("words", "says"), [
    ({"ladder": [0.1]}, "--ladder: expected 2 to 40 different values of dt_fraction, got one rung"),
    ({"ladder": [0.1, 0.1]}, "got one rung"),
    ({"ladder": [0.1, 0.2, 0.1]}, "got 3 rungs, 2 of them different"),
    ({"ladder": [0.1, 0.0]}, "numbers > 0 and <= 10 (dt_fraction), got 0"),
    ({"ladder": [0.0]}, "numbers > 0 and <= 10 (dt_fraction), got 0"),
    ({"ladder": [-1.0]}, "numbers > 0 and <= 10 (dt_fraction), got -1"),
    ({"ladder": [0.1, float("nan")]}, "numbers > 0 and <= 10 (dt_fraction), got nan"),
    ({"knob": "size"}, "got size; scenes of kind free do not have it: every body of it was placed by hand"),
    ({"knob": "rate"}, "nothing drives free bodies"),
    ({"knob": "schem"}, "did you mean scheme?"),
    ({"knob": "dt,scheme"}, "--knob: expected one knob of a free scene, got dt,scheme"),
    ({"quantity": "friction_angle"}, "--quantity: expected one of exit, velocity, spin, got friction_angle"),
    ({"scene": "biaxial_quick", "quantity": "exit"}, "--quantity: expected one of friction_angle, plateau_angle"),
    ({"scene": "biaxial_quick", "knob": "stifness"}, "did you mean stiffness?"),
    ({"scene": "biaxial_quick", "knob": ","}, "--knob: expected one of dt, stiffness"),
    ({"scene": "biaxial_quick", "knob": "size", "ladder": [50.5, 100]}, "whole numbers (particles), got 50.5"),
    ({"scene": "biaxial_quick", "knob": "rate,dt", "ladder": [1]}, "one knob whose values are numbers, got rate, dt"),
    ({"scene": "biaxial_quick", "knob": "law", "ladder": [0, 1]}, "one knob whose values are numbers, got law"),
    ({"scene": "couette_quick", "knob": "size"}, "the density decides on a band"),
    ({"scene": "couette_quick", "quantity": "friction_angle"}, "expected one of torque, band_width, wall_velocity"),
    ({"scene": "biaxial_frictionless", "quantity": "friction_angle"}, "expected one of plateau_angle"),
])
def test_what_cannot_be_asked(words, says):
    with pytest.raises(InputError) as error:
        ask(**words)
    assert says in str(error.value)
    assert "\n" not in str(error.value)


def test_numbers_by_pair_of_materials_are_not_turned():
    file = FOLDER.parent / "hard_cases" / "stiff_and_soft_pairs.toml"
    with pytest.raises(InputError, match=r"contact\.between: expected one set of numbers for all contacts"):
        asked(load_scene(file), file, knob=None, ladder=None, quantity=None)


def ask_all(scene, knob):
    file = FOLDER / f"{scene}.toml"
    return asked_all(load_scene(file), file, knob=knob, ladder=None, quantity=None)


def test_boxes_turn_several_knobs_at_once():
    found = ask_all("biaxial_quick", None)
    assert [a.knob.name for a in found] == ["dt", "stiffness", "rate", "size", "width"]
    assert {a.quantity for a in found} == {"friction_angle"}
    dt, stiffness, rate, size, width = (a.values for a in found)
    assert dt == pytest.approx((0.36, 0.18, 0.09, 0.045, 0.0225))
    assert stiffness == (1 / 64, 1 / 16, 1 / 4, 1.0)
    assert rate == (8.0, 4.0, 2.0, 1.0)
    assert size == (50.0, 100.0, 200.0)
    assert width == pytest.approx((0.04, 0.02, 0.01, 0.005, 0.0025))
    assert [a.knob.name for a in ask_all("biaxial_quick", "all")] == ["dt", "stiffness", "rate", "size", "width"]
    assert [a.knob.name for a in ask_all("couette_quick", "all")] == ["dt", "stiffness", "rate", "width"]
    assert [a.knob.name for a in ask_all("biaxial_quick", "rate,dt,rate")] == ["rate", "dt"]


def test_cheap_rungs_come_first_and_the_scenes_own_is_added():
    assert ask("biaxial_quick", knob="stiffness", ladder=[4.0, 0.5]).values == (0.5, 1.0, 4.0)
    assert ask("biaxial_quick", knob="size", ladder=[400, 50]).values == (50.0, 200.0, 400.0)
    assert ask("biaxial_quick", knob="rate", ladder=[2.0]).values == (2.0, 1.0)
    for one in ask_all("biaxial_quick", None):
        assert list(one.x) == sorted(one.x, reverse=True)
