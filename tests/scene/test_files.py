"""Files beside the scene: none outside its folder, and every wrong cell named with its line."""

import os

import numpy as np
import pytest

from harness.errors import InputError
from harness.scene.bodies import read_packing_file
from harness.scene.resolve import resolve

REFUSED_NAMES = [
    "/etc/passwd", "../outside.csv", "sub/../../outside.csv", "sub/../scene.toml", "a\nshell rm", "a\x00b",
    "\x1b[2J", "a\\b", "", " ",
]


def with_file(scenes, name):
    return scenes.refusal(scenes.free, {"bodies": scenes.remove, "bodies_file": name})


@pytest.mark.parametrize("name", REFUSED_NAMES)
def test_files_outside_the_folder_are_refused(scenes, name):
    (scenes.folder.parent / "outside.csv").write_text("x,y,radius,mass\n0,0,1,1\n")
    message = with_file(scenes, name)
    assert message.startswith("scene.toml: bodies_file: expected a file name below the scene's folder, got ")


def test_links_out_of_the_folder_are_refused(scenes):
    (scenes.folder.parent / "outside.csv").write_text("x,y,radius,mass\n0,0,1,1\n")
    (scenes.folder / "link.csv").symlink_to("../outside.csv")
    (scenes.folder / "circle.csv").symlink_to("circle.csv")
    assert '"link.csv", a link that leads out of it' in with_file(scenes, "link.csv")
    assert "circle.csv" in with_file(scenes, "circle.csv")


def test_packing_names_obey_the_same_rule(scenes):
    drawn = {f"particles.{k}": scenes.remove for k in ("count", "radius", "seed")}
    message = scenes.refusal(scenes.biaxial, {**drawn, "particles.packing": "../p.csv"})
    assert message.startswith("scene.toml: particles.packing: expected a file name below the scene's folder")
    with pytest.raises(InputError, match="below the scene's folder"):
        read_packing_file(scenes.folder, "../p.csv")


def test_missing_folder_and_pipe(scenes):
    (scenes.folder / "sub").mkdir()
    os.mkfifo(scenes.folder / "pipe")
    assert with_file(scenes, "none.csv") == (
        "none.csv: expected a CSV file, got no such file or directory; check the name"
    )
    assert with_file(scenes, "sub") == "sub: expected a CSV file, got a folder; name a file in it"
    assert with_file(scenes, "pipe") == "pipe: expected a CSV file, got something that is no regular file"


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", "expected a header x,y,radius,mass and rows, got an empty file"),
        ("# only this\n\n", "expected a header x,y,radius,mass and rows, got an empty file"),
        ("x,y,radius,mass\n", "expected a header x,y,radius,mass and rows, got no row of data"),
        ("x,y,radius\n0,0,1\n", "line 1: expected the columns x,y,radius,mass, got x,y,radius; add the column mass"),
        ("x,y,radius,mas\n0,0,1,1\n", "line 1: expected the columns x,y,radius,mass, got the unknown column"
         ' "mas"; did you mean mass?'),
        ("x,y,z,radius,mass\n0,0,0,1,1\n", "line 1: expected the columns x,y,radius,mass, got the unknown column"),
        ("x,y,radius,mass,x\n0,0,1,1,0\n", "line 1: expected the columns x,y,radius,mass, got the column x twice"),
        ("x,y,radius,mass\n0,0,1,1\n# c\n0,0,1\n", "line 4: expected 4 cells, got 3"),
        ("x,y,radius,mass\n0,0,1,one\n", 'line 2, column mass: expected a number, got "one"'),
        ("x,y,radius,mass\n0,0,1,\n", 'line 2, column mass: expected a number, got ""'),
        ("x,y,radius,mass\n0,nan,1,1\n", "line 2, column y: expected a finite number, got nan"),
        ("x,y,radius,mass\n0,1e99,1,1\n", "line 2, column y: expected a magnitude of at most 1e+30 in SI"),
        ("x,y,radius,mass\n0,0,0,1\n", 'line 2, column radius: expected a number > 0, got "0"'),
        ("x,y,radius,mass\n0,0,1,-1\n", 'line 2, column mass: expected a number > 0, got "-1"'),
        ("x,y,radius,mass,inertia\n0,0,1,1,2\n", 'line 2, column inertia: expected "sphere", "disc", "ring" or a'),
        ("x,y,radius,mass,vy\n0,0,1,1,2\n", "header: expected all of vx,vy or none, got vy; add the column vx"),
        ('x,y,radius,mass\n"0,0,1,1\n', "expected a CSV file, got an error: unexpected end of data"),
        ("x,y,radius,mass\n0,0,1,1e-5\n0,0,1,1e-5\n", "line 3, position: expected an overlap with line 2 of"),
        (b"x,y,radius,mass\n0,\xe4,1,1\n", "line 2: expected UTF-8 text, got the byte 0xe4"),
    ],
)
def test_wrong_tables(scenes, text, message):
    scenes.write(text, "b.csv")
    assert with_file(scenes, "b.csv").startswith(f"b.csv: {message}")


def test_bodies_file_reads_as_inline_bodies(scenes):
    """The same numbers inline and in a file give the same system."""
    inline = [
        {"position": [0.0, 2e-3], "radius": 1e-3, "mass": 1e-5, "velocity": [0.1, -0.2], "spin": [3.0],
         "inertia": "disc"},
        {"position": [3e-3, 2e-3], "radius": 1e-3, "mass": 2e-5, "inertia": 0.3},
    ]
    scenes.write(
        "# two discs\nmass,x,y,radius,vx,vy,wz,inertia\n1e-5,0,2e-3,1e-3,0.1,-0.2,3,disc\n"
        "2e-5, 3e-3, 2e-3, 1e-3, 0, 0, 0, 0.3\n", "b.csv",
    )
    here = scenes.load(scenes.free, {"bodies": inline})
    beside = scenes.load(scenes.free, {"bodies": scenes.remove, "bodies_file": "b.csv"})
    assert resolve(here, scenes.file).digest() == resolve(beside, scenes.file).digest()


def test_bodies_file_in_space(scenes):
    scenes.write("x,y,z,radius,mass,wx,wy,wz\n0,0,1,1e-3,1e-5,1,2,3\n", "b.csv")
    scene = scenes.load(scenes.free, {"dimension": 3, "bodies": scenes.remove, "bodies_file": "b.csv"})
    particles = resolve(scene, scenes.file).particles
    assert particles.x.tolist() == [[0.0, 0.0, 1.0]]
    assert particles.spin.tolist() == [[1.0, 2.0, 3.0]]
    assert particles.v.tolist() == [[0.0, 0.0, 0.0]]
    assert particles.inertia_factor.tolist() == [0.4]


def test_packing_file_comes_in_order_of_id(scenes):
    scenes.write("id,x,y,radius\n2,3e-3,0,1e-3\n1,0,0,2e-3\n", "p.csv")
    x, radius = read_packing_file(scenes.folder, "p.csv")
    assert np.array_equal(x, [[0.0, 0.0], [3e-3, 0.0]])
    assert np.array_equal(radius, [2e-3, 1e-3])


@pytest.mark.parametrize(
    ("rows", "message"),
    [
        ("1,0,0,1\n1,3,0,1", 'line 3, column id: expected an id of its own .line 2 has it., got "1"'),
        ("1,0,0,1\n3,3,0,1", "line 3, column id: expected an integer from 1 to 2, the number of rows, got"),
        ("1.5,0,0,1\n2,3,0,1", "line 2, column id: expected an integer from 1 to 2"),
        ("1,0,0,0\n2,3,0,1", "line 2, column radius: expected a number > 0"),
    ],
)
def test_wrong_packing_files(scenes, rows, message):
    scenes.write(f"id,x,y,radius\n{rows}\n", "p.csv")
    with pytest.raises(InputError, match=message):
        read_packing_file(scenes.folder, "p.csv")


def test_scene_with_a_packing_file(scenes):
    """Its particles set the time step; two at one place are found when the scene is loaded."""
    drawn = {f"particles.{k}": scenes.remove for k in ("count", "radius", "seed")}
    row = "".join(f"{k + 1},{2e-3 * (k % 10)},{2e-3 * (k // 10)},1e-3\n" for k in range(100))
    scenes.write(f"id,x,y,radius\n{row}", "p.csv")
    scenes.load(scenes.biaxial, {**drawn, "particles.packing": "p.csv"})
    scenes.write(f"id,x,y,radius\n{row}101,0,0,1e-3\n", "p.csv")
    message = scenes.refusal(scenes.biaxial, {**drawn, "particles.packing": "p.csv"})
    assert "disc 101 of the packing, position: expected a centre apart from that of disc 1 of the packing" in message
