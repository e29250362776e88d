"""Text dumps and tables: exact numbers in, one clear error out."""

import numpy as np
import pytest

from postproc.readers.dump import read_dump, read_table
from postproc.readers.rows import nearest_image, particle_rows
from postproc.readers.walls import box_from_walls
from postproc.snapshot import Columns
from postproc.trajectory import ReadError

BOX = "ITEM: BOX BOUNDS ff ff pp\n-1.0e+00 2.0e+00\n0 1\n-5e-1 5e-1\n"


def _frame(step, rows, *, kind="ATOMS", columns="id x y", count=None, end=" \n", before=""):
    number = "ATOMS" if kind == "ATOMS" else "ENTRIES"
    lines = "".join(" ".join(f"{v:.17g}" for v in row) + end for row in rows)
    count = len(rows) if count is None else count
    return (
        f"{before}ITEM: TIMESTEP\n{step}\nITEM: NUMBER OF {number}\n{count}\n{BOX}ITEM: {kind} {columns}\n{lines}"
    )


def _write(path, *frames):
    path.write_text("".join(frames))
    return path


@pytest.mark.parametrize("kind", ["ATOMS", "ENTRIES"])
@pytest.mark.parametrize("end", ["\n", " \n", "\t\n", "\r\n"])
def test_many_frames_keep_every_bit(tmp_path, kind, end):
    rng = np.random.default_rng(0)
    tables = [rng.standard_normal((rows, 3)) * 10.0 ** rng.integers(-300, 300, (rows, 3)) for rows in (5, 0, 1, 17)]
    path = _write(tmp_path / "d", *(_frame(10 * k, t, kind=kind, end=end) for k, t in enumerate(tables)))
    frames = read_dump(path, kind=kind)
    assert [step for step, _ in frames] == [0, 10, 20, 30]
    for (_, columns), table in zip(frames, tables, strict=True):
        assert list(columns) == ["id", "x", "y"]
        assert columns.rows == len(table)
        np.testing.assert_array_equal(columns.vector("id", "x", "y"), table)


def test_columns_can_be_chosen_and_renamed(tmp_path):
    path = _write(tmp_path / "d", _frame(0, [[1, 2, 3]], columns="id f_w[1] c_p[2]"))
    ((_, columns),) = read_dump(path, kind="ATOMS", names={"c_p[2]": "force", "id": "id"})
    assert dict(columns) == {"force": [3], "id": [1]}
    with pytest.raises(ReadError, match=r"no column 'radius'; it has id f_w\[1\] c_p\[2\]"):
        read_dump(path, kind="ATOMS", names={"radius": "r"})


def test_items_that_are_not_needed_are_stepped_over(tmp_path):
    extra = "ITEM: UNITS\nsi\nITEM: TIME\n0.25\n"
    path = _write(tmp_path / "d", _frame(0, [[1, 2, 3]]), _frame(5, [[4, 5, 6]]).replace(BOX, extra + BOX))
    assert [step for step, _ in read_dump(path, kind="ATOMS")] == [0, 5]


GOOD = [[1.0, 0.5, 0.25], [2.0, 1.5, 1.25]]
TWO = _frame(0, GOOD) + _frame(10, GOOD)
FIRST_ROW = 10  # of the first frame; a frame has 9 lines of header and 2 rows here

DAMAGES = {
    "missing": (None, "No such file"),
    "empty": ("", "is empty"),
    "cut in a row": (TWO[:-3], "line 22: step 10 is cut short: 2 rows announced, 1 whole rows there"),
    "cut at a row": (TWO[: TWO.rindex("2 1.5")], "step 10 is cut short: 2 rows announced, 1 whole"),
    "cut in a header": (TWO[: TWO.rindex("BOX")], "line 16: cut short in a header"),
    "cut before the rows": (TWO[: TWO.rindex("1 0.5")], "step 10 is cut short"),
    "a row too many": (_frame(0, GOOD, count=1), "1 rows announced, 2 whole rows there"),
    "nan": (TWO.replace("1.25", "nan", 1), f"line {FIRST_ROW + 1}: expected a finite number, got 'nan'"),
    "minus nan": (TWO.replace("1.25", "-nan", 1), "expected a finite number, got '-nan'"),
    "infinite": (TWO.replace("0.25", "inf", 1), f"line {FIRST_ROW}: expected a finite number, got 'inf'"),
    "overflow": (TWO.replace("0.25", "1e999", 1), "expected a finite number, got '1e999'"),
    "garbled": (TWO.replace("0.25", "0.2.5", 1), f"line {FIRST_ROW}: expected a finite number, got '0.2.5'"),
    "bytes": (TWO.replace("0.25", "\x00\x01", 1), f"line {FIRST_ROW}: expected 3 numbers, got 2 words"),
    "umlaut": (TWO.replace("0.25", "ä", 1), f"line {FIRST_ROW}: expected a finite number"),
    "a number too few": (TWO.replace(" 0.25", "", 1), f"line {FIRST_ROW}: expected 3 numbers, got 2 words"),
    "moved to another row": (
        TWO.replace("0.5 0.25", "0.5", 1).replace("2 1.5", "0.25 2 1.5", 1), "expected 3 numbers, got 2 words"
    ),
    "a blank row": (TWO.replace("1 0.5 0.25 ", "", 1), f"line {FIRST_ROW}: expected 3 numbers, got 0 words"),
    "step is no number": (TWO.replace("\n10\n", "\n1o\n"), "line 13: expected a whole number, got '1o'"),
    "steps repeat": (_frame(0, GOOD) + _frame(0, GOOD), "line 12: step 0 follows step 0"),
    "no step": (TWO.replace("ITEM: TIMESTEP\n0\n", "", 1), "without a time step"),
    "other file": ("hello\nworld\n", "line 1: expected 'ITEM: ...', got 'hello'"),
    "other kind": (_frame(0, GOOD, kind="ENTRIES"), "cut short in a header"),
}


@pytest.mark.parametrize("name", DAMAGES)
def test_damage_is_named_with_file_and_line(tmp_path, name):
    text, message = DAMAGES[name]
    path = tmp_path / "frames.dump"
    if text is not None:
        path.write_text(text)
    with pytest.raises(ReadError) as error:
        read_dump(path, kind="ATOMS")
    assert str(error.value).startswith(str(path))
    assert message in str(error.value)


def test_tables_take_their_names_from_the_last_heading(tmp_path):
    (tmp_path / "t").write_text("# Time-averaged data\n# step a b\n0 1 2\n10 3.0000000000000004 -4e-320\n")
    table = read_table(tmp_path / "t")
    assert list(table) == ["step", "a", "b"]
    np.testing.assert_array_equal(table.vector("step", "a", "b"), [[0, 1, 2], [10, 3.0000000000000004, -4e-320]])


@pytest.mark.parametrize(("text", "message"), [
    ("0 1\n", "line 1: expected a '#' line"),
    ("# step a", "line 1: cut short in its header"),
    ("# step a\n", "holds no row"),
    ("# x\n# step a\n0 1\n1 2\n2", "line 5: cut short"),
    ("# x\n# step a\n0 1\n1\n", "line 4: expected 2 numbers, got 1 words"),
    ("# step a\n0 1\n1 -nan\n", "line 3: expected a finite number, got '-nan'"),
    ("", "is empty"),
])
def test_damaged_tables(tmp_path, text, message):
    (tmp_path / "t").write_text(text)
    with pytest.raises(ReadError) as error:
        read_table(tmp_path / "t")
    assert message in str(error.value)


# --- box ------------------------------------------------------------------------------------------


def _walls(*rows):
    names = ["px", "py", "nx", "ny"]
    return Columns(dict(zip(names, np.array(rows, float).T, strict=True)), "walls")


LEFT, RIGHT, BOTTOM, TOP = (0, 7, 1, 0), (3, 1, -1, 0), (5, -1, 0, 1), (2, 4, 0, -1)


@pytest.mark.parametrize(("walls", "periodic", "box"), [
    (_walls(LEFT, RIGHT, BOTTOM, TOP), None, [[0, 3], [-1, 4]]),
    (_walls(LEFT, RIGHT, BOTTOM, TOP, (1, 0, 1, 0)), None, [[1, 3], [-1, 4]]),
    (_walls(LEFT, RIGHT, BOTTOM), None, None),
    (_walls(LEFT, RIGHT, BOTTOM, (2, 4, -0.6, -0.8)), None, None),
    (_walls(BOTTOM, TOP), (2.5, 0.0), [[0, 2.5], [-1, 4]]),
    (_walls(BOTTOM, TOP), (0.0, 0.0), None),
    (None, (2.5, 1.5), [[0, 2.5], [0, 1.5]]),
    (None, None, None),
])
def test_walls_and_periodic_axes_make_a_box(walls, periodic, box):
    found = box_from_walls(walls, 2, periodic)
    assert (found is None) == (box is None)
    if box is not None:
        np.testing.assert_array_equal(found, box)


def test_nearest_image_only_along_periodic_axes():
    vectors = np.array([[0.9, 0.9], [-0.6, 0.2], [2.2, -3.0]])
    np.testing.assert_allclose(nearest_image(vectors, (1.0, 0.0)), [[-0.1, 0.9], [0.4, 0.2], [0.2, -3.0]])
    assert nearest_image(vectors, None) is vectors


def test_particles_of_a_dump_must_all_be_there(tmp_path):
    names = ["id", "xu", "yu", "vx", "vy", "omegaz", "radius", "mass"]
    atoms = Columns({n: np.arange(1.0, 4.0) for n in names}, "atoms")
    particles = particle_rows(tmp_path, atoms, 2, np.array([0.4, 0.5, 1.0]), "u")
    np.testing.assert_array_equal(particles["inertia"], [0.4, 4.0, 27.0])
    assert list(particles) == ["id", "x", "y", "vx", "vy", "wz", "radius", "mass", "inertia"]
    with pytest.raises(ReadError, match="3 particles, expected ids 1 to 4"):
        particle_rows(tmp_path, atoms, 2, np.ones(4), "u")


@pytest.mark.parametrize("form", ["{:.17g}", "{:.17e}", "{:.6g}", "{:.25g}"])
def test_every_number_has_the_bits_that_the_c_library_reads(tmp_path, form):
    """Any double, and those that JSON, in which most are read, does not have or has without a sign."""
    bits = np.random.default_rng(1).integers(0, 2**64, size=30_000, dtype=np.uint64).view(np.float64)
    values = np.concatenate([bits[np.isfinite(bits)], [0.0, -0.0, 5e-324, -5e-324, 1e22, 9007199254740993.0, -12.0]])
    words = [form.format(v) for v in values]
    rows = "".join(f"-0 {word} -0{end}" for word, end in zip(words, [" \n", "\n"] * len(words), strict=False))
    _same_bits(tmp_path, rows, words, [-0.0] * len(words))
    _same_bits(tmp_path, rows.replace(" \n", "\n"), words, [-0.0] * len(words))


def test_spellings_that_json_does_not_have_are_read(tmp_path):
    words = ["+1", "1.", ".5", "007", "1e5", "1E-5", "-0.", "5e-0"]
    _same_bits(tmp_path, "".join(f"1 {word}  2\n" for word in words), words, [1.0] * len(words))


def _same_bits(tmp_path, rows, words, first):
    count = rows.count("\n")
    head = f"ITEM: TIMESTEP\n0\nITEM: NUMBER OF ATOMS\n{count}\n{BOX}ITEM: ATOMS id x y\n"
    ((_, columns),) = read_dump(_write(tmp_path / "d", head + rows), kind="ATOMS")
    assert columns["x"].tobytes() == np.array([float(w) for w in words]).tobytes()
    assert columns["id"].tobytes() == np.array(first).tobytes()
