"""The reader alone, on files written here: units, signs, and the place of every damage."""

from __future__ import annotations

import numpy as np
import pytest

from postproc.readers.liggghts import CONTACTS, PARTICLES, SERIES, LiggghtsWall, read_liggghts
from postproc.trajectory import ReadError

FLOOR = LiggghtsWall(
    index=1, name="floor", point=(0.0, 0.0), normal=(0.0, 1.0), moves=False, velocity=None, rough=True, mesh=None
)
HEADER = "    Step    Atoms         motion       floor_fx       floor_fy \n"
ATOMS = """ITEM: TIMESTEP
{step}
ITEM: NUMBER OF ATOMS
2
ITEM: BOX BOUNDS ff ff pp
-9 9
-9 9
-9 9
ITEM: ATOMS id x y vx vy omegaz radius mass {columns}
1 0 0.45 0.1 0.2 3 0.5 2 {one}
2 0.95 0.6 0 0 -1 0.5 4 0 0 0 0
"""
WALL = "f_force_floor_plane[1] f_force_floor_plane[2] f_history_floor_plane[1] f_history_floor_plane[2]"
ENTRIES = " ".join(f"c_pairs[{k}]" for k in range(1, 11))
PAIR = """ITEM: TIMESTEP
{step}
ITEM: NUMBER OF ENTRIES
2
ITEM: BOX BOUNDS ff ff pp
-9 9
-9 9
-9 9
ITEM: ENTRIES {columns}
2 1 0 8 2 0 0.01 -0.02 0 {overlap}
1 2 0 0 0 0 0 0 0 -0.5
"""


@pytest.fixture(name="folder")
def _folder(tmp_path):
    """Two frames of two discs that touch; disc 1 touches the rough floor."""
    (tmp_path / SERIES).write_text(HEADER + "0 2 0 1.5 -2.5\n5 2 0 1 -2\n10 2 0 1.25 -2.25\n")
    overlap = f"{1 - np.hypot(0.95, 0.15):.17g}"
    (tmp_path / PARTICLES).write_text(
        "".join(ATOMS.format(step=s, columns=WALL, one="-1.25 2.25 0.003 0") for s in (0, 10)))
    (tmp_path / CONTACTS).write_text("".join(PAIR.format(step=s, columns=ENTRIES, overlap=overlap) for s in (0, 10)))
    return tmp_path


def read(folder, **changes):
    given = {"dimension": 2, "walls": [FLOOR], "periodic": None, "inertia_factor": np.array([0.5, 0.4]),
             "dt": 0.1, "sample_every": 10, "contacts": True, "history": ("ux", "uy", "uz")} | changes
    return read_liggghts(folder, **given)


def test_series_keeps_samples_and_adds_what_a_still_wall_has(folder):
    series = read(folder).series
    assert series["step"].tolist() == [0, 10]
    assert series["time"].tolist() == [0, 1]
    assert series["floor_fy"].tolist() == [-2.5, -2.25]
    assert series["floor_d"].tolist() == series["floor_v"].tolist() == [0, 0]


def test_contacts_are_told_of_the_lower_id_and_open_ones_are_left_out(folder):
    frame = read(folder).frames[1]
    c = frame.contacts
    assert c["i"].tolist() == [1, 1]
    assert c["j"].tolist() == [2, -1]
    assert c.vector("fx", "fy").tolist() == [[-8, -2], [-1.25, 2.25]]
    assert c.vector("ux", "uy").tolist() == [[-0.01, 0.02], [0.003, 0]]
    n = -np.array([0.95, 0.15]) / np.hypot(0.95, 0.15)
    overlap = 1 - np.hypot(0.95, 0.15)
    assert c["overlap"] == pytest.approx([overlap, 0.05])
    assert [c["px"][0], c["py"][0]] == pytest.approx(np.array([0, 0.45]) - (0.5 - overlap / 2) * n)
    assert [c["px"][1], c["py"][1]] == [0, 0]
    assert frame.particles["inertia"].tolist() == [0.25, 0.4]
    assert frame.walls["fy"].tolist() == [-2.25]


@pytest.mark.parametrize(("file", "old", "new", "complaint"), [
    (SERIES, "10 2 0 1.25 -2.25\n", "", "has no row of step 10"),
    (SERIES, "1.25 -2.25", "nan -2.25", "line 4: expected a finite number"),
    (SERIES, "1.25 -2.25", "-2.25", "line 4: expected 5 numbers"),
    (PARTICLES, "2 0.95 0.6 0 0 -1 0.5 4 0 0 0 0\n", "", "cut short"),
    (PARTICLES, "\n2 0.95", "\n3 0.95", "2 particles, expected ids 1 to 2"),
    (CONTACTS, "ITEM: TIMESTEP\n10", "ITEM: TIMESTEP\n20", "its steps are not those"),
    (CONTACTS, "0.01 -0.02 0 ", "0.01 -0.02 0 1", "off that of"),
])
def test_damage_is_named_with_its_file(folder, file, old, new, complaint):
    text = (folder / file).read_text()
    assert old in text
    (folder / file).write_text(text.replace(old, new))
    with pytest.raises(ReadError, match=complaint) as error:
        read(folder)
    assert str(folder / file) in str(error.value)


@pytest.mark.parametrize("file", [SERIES, PARTICLES, CONTACTS])
def test_a_missing_or_empty_file(folder, file):
    (folder / file).write_text("")
    with pytest.raises(ReadError, match="is empty"):
        read(folder)
    (folder / file).unlink()
    with pytest.raises(ReadError, match="No such file"):
        read(folder)


def test_without_contacts_there_is_no_table(folder):
    (folder / CONTACTS).unlink()
    assert read(folder, contacts=False).frames[0].contacts is None
