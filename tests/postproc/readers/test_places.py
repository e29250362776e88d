"""What lies beyond its box is refused in one line; a centre and a reference are what they say."""

import json

import numpy as np
import pytest

from postproc.average import average, main
from postproc.averaging.words import WrongSetting
from postproc.snapshot import MissingColumn

PILE = {
    "attributes": {"box": [[0.0, 0.04], [0.0, 0.04]]},
    "particles": {"id": [1, 2], "x": [0.010, 0.0299], "y": [0.010, 0.010], "radius": [0.01, 0.01]},
    "contacts": {"i": [1], "j": [2], "px": [0.01995], "py": [0.010], "fx": [-5.0], "fy": [0.0]},
}


def with_value(group: str, column: str, value: float) -> dict:
    state = json.loads(json.dumps(PILE))
    state[group][column][0] = value
    return state


@pytest.mark.parametrize(("group", "column", "value", "said"), [
    ("particles", "y", 5.0, "particles.y: row 1: expected a centre in the box, 0 to 0.04, got 5"),
    ("particles", "x", -1e-6, "particles.x: row 1: expected a centre in the box"),
    ("contacts", "px", 3.0, "contacts.px: row 1: expected a point in the box, 0 to 0.04, got 3"),
])
def test_what_lies_beyond_the_box_is_refused(tmp_path, capsys, group, column, value, said):
    (tmp_path / "pile.json").write_text(json.dumps(with_value(group, column, value)))
    assert main([str(tmp_path / "pile.json")]) == 2
    (line,) = capsys.readouterr().err.splitlines()
    assert said in line


def test_a_reference_of_other_particles_gives_no_displacement(tmp_path, states):
    state = states.random_contacts(2, 2, count=20)
    other = states.random_contacts(5, 2, count=20)
    assert not np.allclose(state.particles["radius"], other.particles["radius"])
    with pytest.raises(MissingColumn, match="have another radius there: not the same particles"):
        _ = average(state, reference=other)["displacement"]


def test_rings_about_a_centre_that_is_given(states):
    state = states.snapshot(x=[[2.0, 3.0], [2.5, 3.0]], radius=[0.1, 0.1])
    found = average(state, cells="rings:0.2,0.7", centre=(2.0, 3.0), fields="particles")
    np.testing.assert_allclose(found["particles"], [1.0])
    assert found.how["centre (m)"] == "2 3"
    assert average(state, cells="rings:1,5", fields="particles").how["centre (m)"] == "0 0"


def test_ring_walls_have_their_own_centre(states):
    from dataclasses import replace

    from postproc.snapshot import Columns

    ring = Columns({"id": [1.0], "px": [0.0], "py": [0.0], "radius": [9.0], "fx": [0.0], "fy": [0.0]}, "walls")
    state = replace(states.snapshot(x=[[1.0, 0.0]], radius=[0.1]), walls=ring)
    with pytest.raises(WrongSetting, match="whose centre it is"):
        average(state, centre=(1.0, 1.0))


def test_a_margin_needs_walls(states):
    box = np.array([[0.0, 1.0], [0.0, 1.0]])
    state = states.snapshot(x=[[0.5, 0.5]], radius=[0.1], box=box, periodic=(True, True))
    with pytest.raises(WrongSetting, match="margin: expected none in a box without walls"):
        average(state, cells="inner", margin=0.1)
