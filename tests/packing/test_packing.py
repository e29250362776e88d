"""Packings: balance at the pressure asked for, same bytes for one seed, and a cache that notices damage."""

import json

import numpy as np
import pytest

from harness.errors import InputError
from harness.packing import make_packing
from harness.packing.insertion import LOOSE, insert_loose
from harness.scene.model import Preparation, RandomParticles, SphereMass, UniformRadius
from reference.kernel import relax

STIFFNESS = 1e5
PREPARATION = Preparation(pressure=100.0, residual_tolerance=1e-7)


def discs(count=30, **changes):
    given = {"count": count, "radius": UniformRadius(min=0.5e-3, max=1.5e-3), "seed": 1} | changes
    return RandomParticles(mass=SphereMass(density=2000.0), inertia="disc", **given)


def from_file(name="start.csv"):
    return discs(count=None, radius=None, seed=None, packing=name)


FEW = discs(8)


def make(folder, particles=None, *, seed=1, preparation=PREPARATION, stiffness=STIFFNESS):
    return make_packing(particles or discs(), preparation, stiffness=stiffness, seed=seed, cache=folder / "cache",
                        scene_folder=folder)


@pytest.fixture
def count_relaxations(monkeypatch):
    calls, real = [], relax.relax_in_box

    def counted(*arguments, **options):
        calls.append(options["pressure"])
        return real(*arguments, **options)

    monkeypatch.setattr(relax, "relax_in_box", counted)
    return calls


def wall_forces(packing):
    """Pushes on left, bottom, right and top, from positions alone."""
    gaps = [packing.x[:, 0], packing.x[:, 1], packing.box[0] - packing.x[:, 0], packing.box[1] - packing.x[:, 1]]
    return [STIFFNESS * np.maximum(packing.radius - gap, 0.0).sum() for gap in gaps]


# --- insertion -------------------------------------------------------------------------------------


@pytest.mark.parametrize("count", [1, 2, 3, 4, 5, 40])
@pytest.mark.parametrize("seed", range(8))
def test_inserted_discs_do_not_overlap_however_few(count, seed):
    """Two or three discs can leave each other no place: the box then grows instead of the search going on."""
    rng = np.random.default_rng(seed)
    radius = rng.uniform(0.5, 1.5, count)
    x, side = insert_loose(radius, rng)
    assert (x >= radius).all()
    assert (x <= side - radius).all()
    distance = np.hypot(*(x[:, :, None] - x[:, None, :]))
    np.fill_diagonal(distance, np.inf)
    assert (distance > radius[:, None] + radius).all()
    assert LOOSE / 2 < np.pi * (radius**2).sum() / side**2 < LOOSE * (1 + 1e-12)


# --- the packing itself ----------------------------------------------------------------------------


def test_the_packing_is_in_balance_at_its_pressure(tmp_path):
    packing = make(tmp_path)
    assert packing.x.shape == (30, 2)
    assert packing.residual < 1e-7
    assert packing.contacts >= 2 * 30 * 0.8
    assert 0.7 < packing.area_fraction < 0.9
    width, height = packing.box
    left, bottom, right, top = wall_forces(packing)
    np.testing.assert_allclose([left, right], 100.0 * height, rtol=1e-5)
    np.testing.assert_allclose([bottom, top], 100.0 * width, rtol=1e-5)
    assert (packing.x > 0).all()
    assert (packing.x < packing.box).all()


@pytest.mark.parametrize("count", [1, 2, 5])
def test_a_few_discs_are_packed_as_well(tmp_path, count):
    assert make(tmp_path, discs(count)).residual < 1e-7


def test_one_seed_one_packing(tmp_path):
    first, second = (make(tmp_path / name) for name in ("a", "b"))
    assert first.path.read_bytes() == second.path.read_bytes()
    assert first.box == second.box
    other = make(tmp_path / "a", seed=2)
    assert other.path != first.path
    assert not np.array_equal(other.radius, first.radius)


def test_the_file_holds_the_same_numbers(tmp_path):
    packing = make(tmp_path)
    table = np.loadtxt(packing.path, delimiter=",", skiprows=1)
    assert table[:, 0].tolist() == list(range(1, 31))
    assert np.array_equal(table[:, 1:3], packing.x)
    assert np.array_equal(table[:, 3], packing.radius)


# --- cache -----------------------------------------------------------------------------------------


def test_the_second_call_reads_the_cache(tmp_path, count_relaxations):
    first = make(tmp_path, FEW)
    made = len(count_relaxations)
    assert made == 2
    second = make(tmp_path, FEW)
    assert len(count_relaxations) == made
    assert np.array_equal(first.x, second.x)
    assert (first.box, first.residual, first.contacts) == (second.box, second.residual, second.contacts)


@pytest.mark.parametrize("change", [
    {"particles": discs(9)}, {"particles": discs(8, radius=UniformRadius(min=0.5e-3, max=1.4e-3))}, {"seed": 2},
    {"stiffness": 2e5}, {"preparation": Preparation(pressure=101.0, residual_tolerance=1e-7)},
    {"preparation": Preparation(pressure=100.0, residual_tolerance=2e-7)},
])
def test_whatever_decides_the_packing_is_in_the_key(tmp_path, change):
    assert make(tmp_path, **({"particles": FEW} | change)).path != make(tmp_path, FEW).path


def first_digit_changed(text):
    place = next(k for k in range(len(text) - 1, 0, -1) if text[k].isdigit() and text[k - 1].isdigit())
    return text[:place] + str((int(text[place]) + 1) % 10) + text[place + 1:]


def box_changed(text):
    facts = json.loads(text)
    facts["box"][0] *= 1.0 + 1e-12
    return json.dumps(facts)


@pytest.mark.parametrize(("suffix", "damage"), [
    (".csv", lambda text: text[: len(text) // 2]),
    (".csv", first_digit_changed),
    (".csv", lambda text: ""),
    (".csv", None),
    (".json", lambda text: text[: len(text) // 2]),
    (".json", box_changed),
    (".json", lambda text: "[]"),
    (".json", lambda text: "{}"),
    (".json", lambda text: "\x00\udcff"),
    (".json", None),
])
def test_a_damaged_cache_is_said_and_made_anew(tmp_path, count_relaxations, caplog, suffix, damage):
    first = make(tmp_path, FEW)
    whole = first.path.read_bytes(), first.path.with_suffix(".json").read_bytes()
    file = first.path.with_suffix(suffix)
    if damage is None:
        file.unlink()
    else:
        file.write_bytes(damage(file.read_text()).encode("utf-8", "surrogateescape"))
    again = make(tmp_path, FEW)
    assert len(count_relaxations) == 4
    (line,) = caplog.messages
    assert line == f"{first.path.name}: it or its .json is not what was written; the packing is made again"
    assert (first.path.read_bytes(), first.path.with_suffix(".json").read_bytes()) == whole
    assert again.box == first.box
    assert np.array_equal(again.x, first.x)


# --- a packing file --------------------------------------------------------------------------------

LATTICE = "id,x,y,radius\n" + "".join(
    f"{k + 1},{2.02e-3 * (k % 4) + 5e-3:.17g},{2.01e-3 * (k // 4) - 7e-3:.17g},1e-3\n" for k in range(12))


def test_a_packing_file_is_shifted_and_relaxed(tmp_path, count_relaxations):
    (tmp_path / "start.csv").write_text(LATTICE)
    packing = make(tmp_path, from_file())
    assert count_relaxations == [100.0]
    assert packing.radius.tolist() == [1e-3] * 12
    assert packing.residual < 1e-7
    left, bottom, right, top = wall_forces(packing)
    assert left == pytest.approx(100.0 * packing.box[1], rel=1e-5)
    assert top == pytest.approx(100.0 * packing.box[0], rel=1e-5)
    make(tmp_path, from_file())
    assert len(count_relaxations) == 1


def test_rows_in_any_order_are_the_same_packing_and_other_numbers_are_not(tmp_path):
    header, *rows = LATTICE.splitlines()
    texts = {"a.csv": LATTICE, "b.csv": "\n".join([header, *reversed(rows)]) + "\n",
             "c.csv": LATTICE.replace(",1e-3", ",1.0001e-3", 1)}
    for name, text in texts.items():
        (tmp_path / name).write_text(text)
    a, b, c = (make(tmp_path, from_file(name)) for name in texts)
    assert a.path == b.path != c.path


@pytest.mark.parametrize(("text", "message"), [
    (None, "start.csv"),
    ("", "start.csv"),
    ("id,x,y\n1,0,0\n", "start.csv"),
    ("id,x,y,radius\n1,0,0,1e-3\n1,1,1,1e-3\n", "line 3"),
    ("id,x,y,radius\n1,0,0,-1e-3\n", "line 2"),
    ("id,x,y,radius\n1,0,zero,1e-3\n", "line 2"),
    ("id,x,y,radius\n1,0,nan,1e-3\n", "line 2"),
    ("id,x,y,radius\n1,0,0\n", "line 2"),
    ("id,x,y,radius\n1,0,0,1e-3\n2,0,0,1e-3\n", "preparation"),
])
def test_a_broken_packing_file_is_one_line(tmp_path, text, message):
    if text is not None:
        (tmp_path / "start.csv").write_text(text)
    with pytest.raises(InputError, match=message) as caught:
        make(tmp_path, from_file())
    assert "\n" not in str(caught.value)
    assert not list(tmp_path.glob("cache/*"))


@pytest.mark.parametrize("name", ["../start.csv", "/etc/hostname", "no\x00name", ""])
def test_a_packing_file_lies_below_the_scene(tmp_path, name):
    with pytest.raises(InputError, match="a file name below the scene's folder"):
        make(tmp_path, from_file(name))


def test_a_packing_that_does_not_come_to_rest_is_one_line(tmp_path, monkeypatch):
    real = relax.relax_in_box
    monkeypatch.setattr(relax, "relax_in_box", lambda *a, **k: real(*a, **k, max_iterations=40))
    with pytest.raises(InputError, match="packing: preparation: expected a packing in balance at this pressure, got "
                                         "residual .* after 40 iterations") as caught:
        make(tmp_path)
    assert "\n" not in str(caught.value)
    assert not list(tmp_path.glob("cache/*"))
