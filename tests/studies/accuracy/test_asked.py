"""Requests that a scene cannot answer are refused in one line."""

from pathlib import Path

import pytest

from harness.errors import InputError
from harness.scene.load import load_scene
from harness.studies.accuracy.asked import asked

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
    ({"ladder": [0.1, 0.0]}, "dt_fraction > 0 and <= 10, got 0"),
    ({"ladder": [0.1, float("nan")]}, "dt_fraction > 0 and <= 10, got nan"),
    ({"knob": "size"}, "--knob: expected one of dt, scheme, got size; scenes of kind free do not have it"),
    ({"knob": "schem"}, "did you mean scheme?"),
    ({"quantity": "friction_angle"}, "--quantity: expected one of exit, velocity, spin, got friction_angle"),
    ({"scene": "biaxial_quick"}, 'expected a kind of scene with a ladder (free), got "biaxial"'),
])
def test_what_cannot_be_asked(words, says):
    with pytest.raises(InputError) as error:
        ask(**words)
    assert says in str(error.value)
    assert "\n" not in str(error.value)
