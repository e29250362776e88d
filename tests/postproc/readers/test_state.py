"""Neutral state files: equal bits back in every format, and one clear line for every damage."""

import json

import h5py
import numpy as np
import pytest

from postproc.average import average
from postproc.geometry import ring_walls
from postproc.readers.state import column_names, read_state, write_state
from postproc.trajectory import ReadError, Trajectory, write_trajectory

FORMATS = ("state.h5", "state.json", "state")


def same(a, b):
    """Two snapshots, bit by bit (NaN equals NaN)."""
    for group in ("particles", "contacts", "walls"):
        one, other = getattr(a, group), getattr(b, group)
        assert (one is None) == (other is None), group
        if one is not None:
            assert set(one) == set(other)
            for name in one:
                np.testing.assert_array_equal(one[name], other[name], err_msg=f"{group}.{name}")
    assert (a.dimension, a.periodic, a.thickness) == (b.dimension, b.periodic, b.thickness)
    np.testing.assert_array_equal(a.time, b.time)
    np.testing.assert_array_equal(a.box, b.box)
    return True


@pytest.mark.parametrize("name", FORMATS)
@pytest.mark.parametrize("dim", [2, 3])
def test_round_trip(tmp_path, states, name, dim):
    state = states.replace(states.random_contacts(7, dim), time=0.1 + 0.2, thickness=1 / 3)
    write_state(tmp_path / name, state)
    assert same(read_state(tmp_path / name), state)


@pytest.mark.parametrize("name", FORMATS)
def test_not_recorded_and_none_and_unknown_are_three_things(tmp_path, states, name):
    lattice = states.lattice("square")
    c = lattice.contacts
    unknown = {**c, "ux": np.where(np.arange(c.rows) == 2, np.nan, 1.0), "uy": np.zeros(c.rows)}
    empty = {k: np.empty(0) for k in c}
    # one after the other under one name: nothing of the state before may be left
    for change in ({"time": np.nan}, {"contacts": unknown}, {"contacts": None}, {"contacts": empty}):
        state = states.replace(lattice, **change)
        write_state(tmp_path / name, state)
        assert same(read_state(tmp_path / name), state)


def test_csv_is_named_by_the_particles_file_too(tmp_path, states):
    write_state(tmp_path / "a.b", states.lattice("square"))
    assert same(read_state(tmp_path / "a.b.particles.csv"), read_state(tmp_path / "a.b"))


def test_hand_written_csv_needs_no_attributes(tmp_path):
    """Dimension from the columns, box from the walls, unknown columns left aside."""
    (tmp_path / "s.particles.csv").write_text("id, x, y, radius, colour\n2,0.5,0.5,0.25,7\n5,1.5,0.5,0.25,8\n\n")
    (tmp_path / "s.walls.csv").write_text(
        "id,px,py,nx,ny,fx,fy\n1,0,0,1,0,0,0\n2,0,0,0,1,0,0\n3,2,0,-1,0,0,0\n4,0,1,0,-1,0,0\n"
    )
    state = read_state(tmp_path / "s")
    assert state.dimension == 2
    assert state.box.tolist() == [[0.0, 2.0], [0.0, 1.0]]
    assert state.contacts is None
    assert np.isnan(state.time)
    assert list(state.particles) == ["id", "x", "y", "radius"]


def test_a_flat_z_column_may_stand_in_a_2d_state(tmp_path):
    def write(z):
        data = {"attributes": {"dimension": 2},
                "particles": {"id": [1, 2], "x": [0, 1], "y": [0, 0], "z": z, "radius": [1, 1]}}
        (tmp_path / "s.json").write_text(json.dumps(data))
        return tmp_path / "s.json"

    assert read_state(write([0.5, 0.5])).dimension == 2
    with pytest.raises(ReadError, match="particles.z: expected one value, as the dimension is 2, got several"):
        read_state(write([0.0, 0.1]))


def _particles(**changes):
    return {"particles": {"id": [1, 2, 3], "x": [0, 1, 2], "y": [0, 0, 0], "radius": [1, 1, 1]} | changes}


def _wall(**changes):
    plain = {"id": [1], "px": [0], "py": [0], "nx": [1], "ny": [0], "fx": [0], "fy": [0]}
    return {**_particles(), "walls": plain | changes}


def _contacts(**changes):
    plain = {"i": [1, 2], "j": [2, -1], "px": [0, 0], "py": [0, 0], "fx": [0, 0], "fy": [0, 0]}
    walls = {"id": [1], "px": [0], "py": [0], "nx": [1], "ny": [0], "fx": [0], "fy": [0]}
    return {**_particles(), "contacts": plain | changes, "walls": walls}


DAMAGES = {
    "nan": (_particles(x=[0, None, 2]), "particles.x: row 2: expected a finite number, got nan"),
    "infinite": (_particles(y=[0, 0, 1e999]), "particles.y: row 3: expected a finite number, got inf"),
    "word": (_particles(x=[0, "one", 2]), "particles.x: expected a list of numbers, got <U21 of shape (3,)"),
    "ragged": (_particles(x=[0, [1], 2]), "particles.x: expected a list of numbers, got object of shape ()"),
    "number": (_particles(x=5), "particles.x: expected a list of numbers, got int64 of shape ()"),
    "short": (_particles(x=[0, 1]), "particles.x: expected 3 values like id, got 2"),
    "no radius": (
        {"particles": {"id": [1], "x": [0], "y": [0]}}, "particles: expected a column radius, got only id, x, y",
    ),
    "no particles": ({"contacts": {}}, "particles: expected a group of columns, got none"),
    "not a group": ({"particles": [1]}, "particles: expected an object, got list"),
    "duplicate id": (_particles(id=[1, 2, 1]), "particles.id: row 3: expected every id once, got 1"),
    "id": (_particles(id=[1, 2.5, 3]), "particles.id: row 2: expected a whole number >= 0, got 2.5"),
    "negative id": (_particles(id=[1, -2, 3]), "particles.id: row 2: expected a whole number >= 0, got -2"),
    "radius": (_particles(radius=[1, 0, 1]), "particles.radius: row 2: expected a number > 0, got 0"),
    "mass": (_particles(mass=[1, 1, -1]), "particles.mass: row 3: expected a number > 0, got -1"),
    "unknown i": (_contacts(i=[1, 9]), "contacts.i: row 2: expected the id of a particle, got 9"),
    "wall as i": (_contacts(i=[1, -1]), "contacts.i: row 2: expected the id of a particle, got -1"),
    "unknown j": (
        _contacts(j=[0, -1]), "contacts.j: row 1: expected the id of a particle, or of a wall with a minus sign "
        "before it, got 0",
    ),
    "unknown wall": (
        _contacts(j=[2, -2]), "contacts.j: row 2: expected the id of a wall with a minus sign before it (-1), got -2",
    ),
    "itself": (_contacts(j=[1, -1]), "contacts: row 1: expected two different particles, got 1"),
    "twice": (_contacts(j=[2, 1]), "contacts: row 2: expected every pair of particles once, got 2 and 1 again"),
    "point on a centre": (
        _contacts(px=[0, 0], py=[0, 0]), "contacts.p: row 1: expected a point beside the centre of particle i, got 1",
    ),
    "huge": (_particles(radius=[1, 1e150, 1]), "particles.radius: row 2: expected less than 1e+30, got "),
    "beyond all numbers": (_particles(x=[0, 10**400, 1]), "particles.x: expected a list of numbers, got object"),
    "zero normal": (_wall(nx=[0]), "walls.n: row 1: expected a normal of length 1, got 0"),
    "neither flat nor ring": (
        _wall(nx=[None], radius=[None]), "walls: row 1: expected either a normal or a radius in every row, got 0",
    ),
    "flat and ring": (_wall(radius=[1.0]), "walls: row 1: expected either a normal or a radius in every row, got 2"),
    "ring without size": (_wall(nx=[None], radius=[0.0]), "walls.radius: row 1: expected a number > 0, got 0"),
    "dimension": ({**_particles(), "attributes": {"dimension": 4}}, "attributes.dimension: expected 2 or 3, got 4"),
    "no z": ({**_particles(), "attributes": {"dimension": 3}}, "particles: expected a column z, got only"),
    "thickness": (
        {**_particles(), "attributes": {"thickness": 0}}, "attributes.thickness: expected a number > 0, got 0",
    ),
    "time": ({**_particles(), "attributes": {"time": "now"}}, "attributes.time: expected a number, got now"),
    "box": (
        {**_particles(), "attributes": {"box": [[0, 1]]}},
        "attributes.box: expected one [lower, upper] an axis, numbers, got [[0, 1]]",
    ),
    "inverted box": (
        {**_particles(), "attributes": {"box": [[0, 1], [1, 0]]}},
        "box: row 2: expected upper bounds above lower bounds, got -1",
    ),
    "misplaced box": (
        {**_particles(), "box": [[0, 1], [0, 1]]},
        "top level: expected only particles, contacts, walls, attributes, got the unknown 'box'; move it into attrib",
    ),
    "unknown group": ({**_particles(), "grains": {}}, "top level: expected only particles, contacts, walls, attrib"),
    "unknown attribute": (
        {**_particles(), "attributes": {"thicknes": 1.0}},
        "attributes: expected only dimension, thickness, time, periodic, box, got the unknown 'thicknes'",
    ),
    "periodic": (
        {**_particles(), "attributes": {"periodic": [1, 0]}},
        "attributes.periodic: expected one boolean an axis, got [1, 0]",
    ),
}


def test_normals_are_brought_to_length_one_and_no_wall_is_passed_over(tmp_path):
    """Normals in any length, or in four decimals; a wall that is askew has no stress of 0 but none."""
    def write(**walls):
        table = {"id": [1, 2, 3, 4], "px": [0, 2, 0, 0], "py": [0, 0, 0, 1], "fx": [-3, 3, 0, 0], "fy": [0, 0, -5, 5],
                 "nx": [1, -1, 0, 0], "ny": [0, 0, 1, -1], **walls}
        data = {"particles": {"id": [1], "x": [0.5], "y": [0.5], "radius": [0.2]}, "walls": table,
                "attributes": {"box": [[0, 2], [0, 1]]}}
        (tmp_path / "s.json").write_text(json.dumps(data))
        return average(read_state(tmp_path / "s.json")).of_state["stress_from_walls"]

    expected = [[[3.0, 0.0], [0.0, 2.5]]]
    np.testing.assert_allclose(write().values, expected)
    np.testing.assert_allclose(write(nx=[2, -0.5, 0, 0], ny=[0, 0, 0.999, -1e-3]).values, expected)
    assert write(nx=[0.6, -1, 0, 0], ny=[0.8, 0, 1, -1]).reason == "wall 1 is not normal to an axis"
    assert write(nx=[1, 1, 0, 0]).reason == "there is no wall at the upper end of x"


def test_files_of_excel_begin_with_a_mark(tmp_path):
    text = "id,x,y,radius\n1,0,0,0.5\n"
    (tmp_path / "s.particles.csv").write_text(text, encoding="utf-8-sig")
    (tmp_path / "s.attributes.json").write_text('{"time": 2.0}', encoding="utf-8-sig")
    state = read_state(tmp_path / "s")
    assert list(state.particles) == ["id", "x", "y", "radius"]
    assert state.time == 2.0


def test_flat_walls_and_rings_in_one_table(tmp_path):
    walls = {"id": [1, 2], "px": [0, 0], "py": [0, 0], "fx": [0, 0], "fy": [0, 0], "nx": [1, None], "ny": [0, None],
             "radius": [None, 0.5], "torque": [None, 2.0]}
    (tmp_path / "s.json").write_text(json.dumps({**_particles(), "walls": walls}))
    state = read_state(tmp_path / "s.json")
    assert ring_walls(state).tolist() == [1]
    assert state.box is None


@pytest.mark.parametrize("name", DAMAGES)
def test_damage_gives_one_clear_line(tmp_path, name):
    data, message = DAMAGES[name]
    path = tmp_path / "s.json"
    path.write_text(json.dumps(data))
    _fails(path, f"{path}: {message}")


def _fails(path, start):
    with pytest.raises(ReadError) as caught:
        read_state(path)
    line = str(caught.value)
    assert line.startswith(start), line
    assert "\n" not in line


def test_two_images_of_a_pair_may_touch_in_a_periodic_box(tmp_path, states):
    state = states.lattice("square", repeats=4)
    c = {k: np.concatenate([v, v[:1]]) for k, v in state.contacts.items()}
    write_state(tmp_path / "s.h5", states.replace(state, contacts=c))
    assert read_state(tmp_path / "s.h5").contacts.rows == state.contacts.rows + 1


@pytest.mark.parametrize("kept", [0, 10, 500, 0.5, 0.99])
def test_truncated_hdf5(tmp_path, states, kept):
    path = tmp_path / "s.h5"
    write_state(path, states.lattice("square"))
    data = path.read_bytes()
    path.write_bytes(data[: int(kept if kept >= 1 else kept * len(data))])
    _fails(path, f"{path}: file: expected a whole HDF5 file")


def test_hdf5_that_is_something_else(tmp_path):
    path = tmp_path / "s.h5"
    with h5py.File(path, "w") as f:
        f["particles"] = np.zeros(3)
    _fails(path, f"{path}: file: expected a whole HDF5 file with groups of datasets, got")


def test_unknown_things_in_hdf5(tmp_path, states):
    path = tmp_path / "s.h5"
    write_state(path, states.lattice("square"))
    with h5py.File(path, "r+") as f:
        f["box"] = np.zeros((2, 2))
    _fails(path, f"{path}: top level: expected only particles, contacts, walls, got the unknown 'box'; make it an attr")
    with h5py.File(path, "r+") as f:
        del f["box"]
        f.attrs["unit"] = "mm"
    _fails(path, f"{path}: attributes: expected only dimension, thickness, time, periodic, box, got the unknown 'unit'")


def test_truncated_json(tmp_path, states):
    path = tmp_path / "s.json"
    write_state(path, states.lattice("square"))
    path.write_text(path.read_text()[:200])
    _fails(path, f"{path}: line ")


@pytest.mark.parametrize(("text", "message"), [
    ("id,x,y,radius\n1,0,0,1\n2,0,0\n", "row 2: expected 4 fields, got 3"),
    ("id,x,y,radius\n1,0,zero,1\n", "row 1, column y: expected a number, got 'zero'"),
    ("id,x,x,radius\n1,0,0,1\n", "line 1: expected every column name once, got id, x, x, radius"),
    ("", "line 1: expected a line of column names, got an empty file"),
])
def test_damaged_csv(tmp_path, text, message):
    path = tmp_path / "s.particles.csv"
    path.write_text(text)
    _fails(path, f"{path}: {message}")


@pytest.mark.parametrize("name", ["no.h5", "no.json", "no"])
def test_missing_file(tmp_path, name):
    _fails(tmp_path / name, f"{tmp_path / name}: file: expected")


@pytest.fixture
def trajectory(tmp_path, states):
    frames = tuple(states.replace(states.lattice("square"), time=float(k)) for k in range(3))
    path = tmp_path / "trajectory.h5"
    write_trajectory(path, Trajectory(frames=frames, steps=(0, 10, 20), series=None))
    return path


@pytest.mark.parametrize(("frame", "time"), [(None, 2.0), (0, 0.0), (1, 1.0)])
def test_frame_of_a_trajectory(trajectory, frame, time):
    assert read_state(trajectory, frame=frame).time == time


@pytest.mark.parametrize("frame", [3, -1])
def test_frame_that_is_not_there(trajectory, tmp_path, states, frame):
    with pytest.raises(ReadError, match=f"frame: expected a number from 0 to 2 in a trajectory of 3, got {frame}"):
        read_state(trajectory, frame=frame)
    write_state(tmp_path / "s.h5", states.lattice("square"))
    with pytest.raises(ReadError, match="frame: expected a trajectory, which has frames, got a single state"):
        read_state(tmp_path / "s.h5", frame=0)


def test_frames_of_a_trajectory_are_checked(trajectory):
    with h5py.File(trajectory, "r+") as f:
        f["particles/radius"][20] = np.nan
    with pytest.raises(ReadError, match="frame 1: particles.radius: row 5: expected a finite number, got nan"):
        read_state(trajectory, frame=1)
    assert read_state(trajectory, frame=0).time == 0.0


def test_column_names_are_those_of_the_snapshot():
    required, optional = column_names("particles", 2)
    assert required == ("id", "x", "y", "radius")
    assert optional == ("mass", "vx", "vy", "wz", "inertia", "rotation")
    assert column_names("contacts", 3)[1][:6] == ("mx", "my", "mz", "ux", "uy", "uz")


def test_rotations_are_read_in_2d(tmp_path, states):
    """They let displacements and rotations against a reference be averaged from a file."""
    state = states.random_contacts(3, 2)
    turned = states.replace(state, particles={**state.particles, "rotation": np.linspace(-1, 1, 9)})
    for name in ("state.h5", "state.json"):
        write_state(tmp_path / name, turned)
        found = read_state(tmp_path / name)
        np.testing.assert_array_equal(found.particles["rotation"], turned.particles["rotation"])
