"""MDAnalysis, the second reader, agrees with our own to the last bit."""

import numpy as np
import pytest

from postproc.readers.dump import read_dump
from postproc.readers.mdanalysis import COLUMNS, read_with_mdanalysis
from postproc.trajectory import ReadError

HEADER = "ITEM: TIMESTEP\n{step}\nITEM: NUMBER OF ATOMS\n{n}\nITEM: BOX BOUNDS ff ff pp\n"
BOUNDS = "-1 3\n-2 7\n-0.5 0.5\n"


@pytest.fixture
def dump(tmp_path):
    """Three frames of 20 atoms, rows in random order, box origin not at 0, 17 digits."""
    rng = np.random.default_rng(1)
    path, text = tmp_path / "atoms.dump", ""
    for step in (0, 100, 250):
        text += HEADER.format(step=step, n=20) + BOUNDS + f"ITEM: ATOMS type {' '.join(COLUMNS)}\n"
        for number in rng.permutation(20) + 1:
            values = rng.uniform(0, 3, 7)
            text += f"1 {number} " + " ".join(f"{v:.17g}" for v in values) + "\n"
    path.write_text(text)
    return path


def test_agrees_with_our_own_reader(dump):
    """Equal to the last bit: float64, not shifted by the origin of the box."""
    ours, theirs = read_dump(dump, kind="ATOMS"), read_with_mdanalysis(dump)
    assert [step for step, _ in ours] == [step for step, _ in theirs] == [0, 100, 250]
    for (_, own), (_, other) in zip(ours, theirs, strict=True):
        order = np.argsort(own["id"])
        for name in COLUMNS:
            np.testing.assert_array_equal(own[name][order], other[name], err_msg=name)


def test_default_positions_of_mdanalysis_would_not_do(dump):
    """The reason for this reader: float32 and shifted by the box origin (-1, -2, -0.5)."""
    from MDAnalysis.coordinates.LAMMPS import DumpReader

    with DumpReader(str(dump), dt=1.0) as reader:
        shifted = np.array(reader.ts.positions, dtype=np.float64)
    _, first = read_with_mdanalysis(dump)[0]
    difference = shifted - first.vector("x", "y", "z") - [1.0, 2.0, 0.5]
    assert 1e-9 < np.abs(difference).max() < 1e-5


def test_a_2d_dump_has_no_z(tmp_path):
    path = tmp_path / "flat.dump"
    path.write_text(HEADER.format(step=5, n=2) + BOUNDS + "ITEM: ATOMS id xu yu\n2 0.1 0.2\n1 0.3 0.7\n")
    (step, flat), = read_with_mdanalysis(path, ("id", "xu", "yu"))
    assert step == 5
    assert {k: v.tolist() for k, v in flat.items()} == {"id": [1.0, 2.0], "xu": [0.3, 0.1], "yu": [0.7, 0.2]}


def test_the_readers_of_mdanalysis_stay_as_they_are(dump):
    """Our variant is not registered for anybody's Universe, nor does it change the class it comes from."""
    import MDAnalysis
    from MDAnalysis.coordinates.LAMMPS import DumpReader

    read_with_mdanalysis(dump)
    assert MDAnalysis._READERS["LAMMPSDUMP"] is DumpReader
    assert DumpReader._coordtype_column_names["unscaled"] == ["x", "y", "z"]


def test_columns_can_be_chosen(dump):
    _, first = read_with_mdanalysis(dump, ("id", "radius"))[0]
    assert list(first) == ["id", "radius"]
    assert first["id"].tolist() == list(range(1, 21))


@pytest.mark.parametrize(("change", "columns", "message"), [
    (lambda t: t[: int(0.9 * len(t))], COLUMNS, "expected 3 whole frames, as many as it begins, got 2"),
    (lambda t: t[:100], COLUMNS, "expected an atom dump that MDAnalysis reads, got"),
    (lambda t: "", COLUMNS, "expected an atom dump that MDAnalysis reads, got"),
    (lambda t: t.replace("ATOMS\n20", "ATOMS\n21", 1), COLUMNS, "expected"),
    (lambda t: t, ("id", "q"), "step 0: expected a column q, got none"),
])
def test_damage_gives_one_clear_line(dump, change, columns, message):
    dump.write_text(change(dump.read_text()))
    with pytest.raises(ReadError, match=message) as caught:
        read_with_mdanalysis(dump, columns)
    assert "\n" not in str(caught.value)
