"""Points by words and from files, and what is wrong with others."""

import numpy as np
import pytest

from postproc.averaging.registry import WrongSetting, make_cells


@pytest.fixture
def state(states):
    return states.random_contacts(3, 2, count=20)


@pytest.fixture
def write(tmp_path):
    def write(text):
        file = tmp_path / "points.csv"
        file.write_bytes(text if isinstance(text, bytes) else text.encode())
        return f"points:{file}"

    return write


def test_a_grid_lies_in_the_middles_of_rectangles_over_the_box(state):
    cells = make_cells("points:4x2", state)
    (x0, x1), (y0, y1) = state.box
    assert cells.labels[:3] == ("1 1", "1 2", "2 1")
    np.testing.assert_allclose(cells.coordinates["x"][::2], x0 + (x1 - x0) * np.array([1, 3, 5, 7]) / 8, rtol=1e-14)
    np.testing.assert_allclose(cells.coordinates["y"][:2], y0 + (y1 - y0) * np.array([1, 3]) / 4, rtol=1e-14)


def test_a_grid_without_a_box_lies_over_the_particles(states):
    state = states.snapshot(x=[[0.0, 0.0], [3.0, 1.0]], radius=[1.0, 0.5])
    places = make_cells("points:2x1", state).points
    assert places.tolist() == [[-1 + 4.5 / 4, 0.25], [-1 + 3 * 4.5 / 4, 0.25]]
    rings = {"id": [1], "px": [1.0], "py": [2.0], "nx": [np.nan], "ny": [np.nan], "radius": [6.0], "fx": [0], "fy": [0]}
    assert make_cells("points:2x1", states.replace(state, walls=rings)).points.tolist() == [[-2.0, 2.0], [4.0, 2.0]]


def test_a_file_of_points(state, write):
    cells = make_cells(write("name, y ,x\na,1,2\n\nb,-1e-1,0.25\n"), state)
    assert cells.points.tolist() == [[2.0, 1.0], [0.25, -0.1]]
    assert cells.labels == ("1", "2")
    assert list(cells.coordinates) == ["x", "y"]


@pytest.mark.parametrize(("text", "message"), [
    ("", "line 1: expected one column x, got nothing"),
    ("x,z\n1,2\n", "line 1: expected one column y, got x, z"),
    ("x,y,x\n1,2,3\n", "line 1: expected one column x, got x, y, x"),
    ("x,y\n", "rows: expected 1 to 1000000 points, got 0"),
    ("x,y\n1,2\n3,four\n", "line 3, column y: expected a finite number, m, got 'four'"),
    ("x,y\n1,nan\n", "line 2, column y: expected a finite number, m, got 'nan'"),
    ("x,y\n1\n", "line 2, column y: expected a finite number, m, got ''"),
    (b"x,y\n\xff\xfe,1\n", "file: expected points as CSV, got"),
])
def test_wrong_files(state, write, text, message):
    with pytest.raises(WrongSetting) as caught:
        make_cells(write(text), state)
    assert message in str(caught.value)
    assert "points.csv: " in str(caught.value)


@pytest.mark.parametrize(("words", "message"), [
    ("points", "cells points: expected a file FILE.csv or points an axis, as in points:32x32, got nothing"),
    ("points:32", "cells points: expected 2 whole numbers like 32x32, got '32'"),
    ("points:4x4x4", "cells points: expected 2 whole numbers like 32x32, got '4x4x4'"),
    ("points:0x4", "expected a whole number from 1 to 1000000"),
    ("points:9999x9999", "expected at most 1000000 cells"),
    ("points:none.csv", "cells points: none.csv: file: expected points as CSV, got No such file or directory"),
])
def test_wrong_words(state, words, message):
    with pytest.raises(WrongSetting) as caught:
        make_cells(words, state)
    assert message in str(caught.value)


def test_wrong_kernels_and_widths(state, states):
    with pytest.raises(WrongSetting, match="kernel: expected one of lucy, gaussian, heaviside, got 'hat'"):
        make_cells("points:4x4", state, kernel="hat")
    with pytest.raises(WrongSetting, match="weights: expected none for cells of kind 'points', got area"):
        make_cells("points:4x4", state, weights="area")
    with pytest.raises(WrongSetting, match="width: expected none for cells of kind 'box', got 1"):
        make_cells("box", state, width=1.0)
    periodic = states.lattice("triangular")
    length = np.diff(periodic.box)[0, 0]
    make_cells("points:4x4", periodic, width=2 * length)
    with pytest.raises(WrongSetting, match="width: expected a kernel that reaches no farther than 5 periods"):
        make_cells("points:4x4", periodic, width=3 * length)


def test_without_particles_a_width_is_needed(states):
    nothing = states.snapshot(x=np.empty((0, 2)), radius=[], box=np.array([[0.0, 1.0], [0.0, 1.0]]))
    with pytest.raises(WrongSetting, match="width: expected a width in m, as there are no particles to take it from"):
        make_cells("points:4x4", nothing)
    assert make_cells("points:4x4", nothing, width=0.1).density(np.empty(0)).tolist() == [0.0] * 16
