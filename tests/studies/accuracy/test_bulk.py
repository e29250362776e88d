"""A ladder of a small box from the scene to errors, on the kernel alone; what is shared, kept, refused, failed."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from harness.errors import InputError
from harness.scene.load import load_scene
from harness.studies.accuracy import accuracy
from harness.studies.accuracy.asked import asked_all
from harness.studies.accuracy.bulk_plan import bare_settings, plan
from harness.studies.accuracy.bulk_quantities import BULK, bulk_values
from harness.studies.compare.curves import BiaxialCurves

FOLDER = Path(__file__).resolve().parents[3] / "inputs" / "scenes"
SMALLER = {
    "count = 200 ": "count = 36 ", "normal_stiffness = 1e5": "normal_stiffness = 1e4",
    "normal_damping = 0.5": "normal_damping = 0.158", "shear_stiffness = 2e4": "shear_stiffness = 2e3",
    "shear_damping = 0.125": "shear_damping = 0.04", "duration = 0.06 ": "duration = 0.004 ",
    "samples = 500": "samples = 100", "final_strain = 0.10": "final_strain = 0.05",
    "0.05, 0.1]": "0.05]", "plateau = [0.05, 0.10]": "plateau = [0.02, 0.05]",
}
ENGINES = ("kernel:talk",)


@pytest.fixture(scope="module")
def file(tmp_path_factory):
    text = (FOLDER / "biaxial_quick.toml").read_text()
    for old, new in SMALLER.items():
        assert old in text, old
        text = text.replace(old, new)
    path = tmp_path_factory.mktemp("scene") / "box.toml"
    path.write_text(text)
    return path


@pytest.fixture(scope="module")
def out(tmp_path_factory):
    return tmp_path_factory.mktemp("bulk")


def climb(file, out, **words):
    return accuracy(file, out, engines=ENGINES, packings=3, workers=2, **words)


@pytest.fixture(scope="module")
def climbed(file, out):
    return climb(file, out, knob="rate", ladder=[2.0], quantity="volume_strain")


def test_the_scenes_own_setting_is_on_every_ladder(climbed):
    (ladder,) = climbed.ladders
    assert [(r.value, r.own) for r in ladder.rungs] == [(2.0, False), (1.0, True)]
    assert climbed.exit_status == 0
    assert (climbed.runs, climbed.kept) == (6, 0)
    fast, own = ladder.rungs
    assert fast.steps == pytest.approx(own.steps / 2, rel=0.1)
    assert own.seconds > 0.0
    assert len(own.each) == 3
    assert own.values["volume_strain"].shape == (3, 1)
    assert own.values["stress_strain"].shape == (3, 40)
    assert ladder.limits["volume_strain"].says.startswith(("only two rungs", "the finest 2 rungs"))


def test_errors_are_those_of_the_walls_of_the_runs(climbed, out, file):
    """Formed again by hand, from the places of the walls that the runs left behind."""
    import h5py

    (ladder,) = climbed.ladders
    strains = []
    for folder in (out / "runs").glob("box-*"):
        with h5py.File(folder / "trajectory.h5") as data:
            series = {k: data["series"][k][:] for k in data["series"]}
        strains.append((series["time"][-1], series["top_d"][-1], series["right_d"][-1]))
    assert len(strains) == 6
    duration = load_scene(file).top.duration
    found = sorted(t for t, *_ in strains)
    assert found == pytest.approx([duration / 2] * 3 + [duration] * 3)
    own = ladder.rungs[1].values["volume_strain"][:, 0]
    systems = plan(load_scene(file), file, climbed.asked, 3, out / "packings").settings[1].systems
    expected = []
    for system in systems:
        height = system.wall("top").point[1]
        width = system.wall("right").point[0]
        (right,) = [r for t, d, r in strains if t > 0.75 * duration and d == pytest.approx(0.05 * height, rel=1e-6)]
        expected.append(1.0 - (width - right) * 0.95 * height / (width * height))
    assert own == pytest.approx(expected, rel=1e-6)


def test_width_makes_no_run_and_nothing_is_made_twice(climbed, file, out):
    again = climb(file, out, knob="width", quantity="stress_strain")
    assert (again.runs, again.kept) == (3, 3)
    assert again.own_share is None
    (ladder,) = again.ladders
    assert len({r.seconds for r in ladder.rungs}) == 1
    apart = [np.abs(r.values["stress_strain"] - ladder.rungs[-1].values["stress_strain"]).max() for r in ladder.rungs]
    assert min(apart[:-1]) > 0.0
    assert all(np.array_equal(r.values["volume_strain"], ladder.rungs[0].values["volume_strain"]) for r in ladder.rungs)


def test_a_mean_over_a_width_lifts_a_parabola_by_a_twelfth_of_its_square():
    """The mean of s^2 over s +- w/2 is s^2 + w^2/12."""
    strain = np.linspace(0.0, 0.05, 1001)
    ones = np.ones_like(strain)
    curves = BiaxialCurves(
        step=strain, time=strain, strain=strain, x=ones, z=ones, force_top=1e5 * strain**2, force_bottom=ones,
        force_left=ones, force_right=100.0 * ones, pressure=100.0,
    )
    inner = (strain > 0.02) & (strain < 0.03)
    for width in (0.01013, 0.02013):
        wide = replace(curves, width=width)
        lifted = (wide.smoothed(wide.stress_zz) - curves.stress_zz)[inner]
        assert np.allclose(lifted, 1e5 * width**2 / 12.0, rtol=0.02)


def test_a_failed_rung_has_a_reason_and_no_time(climbed, file, out):
    """Steps far too long: the discs fly apart, on that rung alone."""
    lost = climb(file, out, knob="dt", ladder=[2.0], quantity="volume_strain")
    wild, own = lost.ladders[0].rungs
    assert wild.status == "unstable"
    assert wild.reason
    assert wild.seconds is None
    assert not wild.values
    assert own.good
    assert lost.ladders[0].error(wild, "volume_strain") is None


def test_states_are_not_asked_for_where_walls_tell_all(climbed, file):
    settings = bare_settings(load_scene(file), climbed.asked)
    assert all((s.scene.outputs.frames, s.scene.outputs.contacts) == (1, False) for s in settings)
    ring = FOLDER / "couette_quick.toml"
    scene = load_scene(ring)
    wanted = asked_all(scene, ring, knob="rate", ladder=None, quantity=None)
    assert all(s.scene.outputs == scene.outputs for s in bare_settings(scene, wanted))


def test_every_quantity_of_a_kind_is_known_by_name(climbed, file, out):
    from postproc.trajectory import read_trajectory

    scene = load_scene(file)
    system = plan(scene, file, climbed.asked, 3, out / "packings").settings[1].systems[0]
    names = {b.name for b in BULK[type(scene)]}
    for made in sorted((out / "runs").glob("box-*/trajectory.h5")):
        trajectory = read_trajectory(made)
        if trajectory.frames[0].particles["x"][0] == system.particles.x[0, 0]:
            found = bulk_values(scene, system, trajectory, {0.0: None})[0.0]
            assert set(found) <= names
            assert {"plateau_angle", "stress_ratio", "volume_strain", "stress_strain"} <= set(found)
            angle, ratio = found["plateau_angle"][0], found["stress_ratio"][0]
            assert 0.0 < angle < 90.0
            assert ratio > 1.0
            return
    raise AssertionError("no run of the first packing")


@pytest.mark.parametrize(("words", "says"), [
    ({"packings": 1}, "--packings: expected a number from 2 to 1000, got 1"),
    ({"phases": 4}, "--phases: expected nothing for this kind of scene, got 4; it has --packings"),
    ({"knob": "rate,dt", "ladder": [1.0, 2.0]}, "--ladder: expected one knob whose values are numbers, got rate, dt"),
    ({"knob": "rate", "ladder": [1.0]}, "got one rung"),
])
def test_what_cannot_be_asked_writes_nothing(file, tmp_path, words, says):
    with pytest.raises(InputError) as error:
        accuracy(file, tmp_path / "new", engines=ENGINES, **words)
    assert says in str(error.value)
    assert not (tmp_path / "new").exists()


@pytest.mark.long
def test_a_simpler_law_is_told_against_the_declared_one(climbed, file, out):
    made = climb(file, out, knob="law", quantity="volume_strain")
    (ladder,) = made.ladders
    assert [r.label for r in ladder.rungs] == ["as declared", "viscous sliding", "no sliding"]
    errors = [ladder.error(r, "volume_strain") for r in ladder.rungs]
    assert errors[0].size == 0.0
    own, viscous = (r.values["volume_strain"][:, 0] for r in ladder.rungs[:2])
    assert errors[1].signed == pytest.approx((viscous - own).mean() / 0.05)
    assert errors[1].seen, "without springs the box contracts where it dilates"


@pytest.mark.long
def test_a_ring_is_driven_faster(tmp_path):
    """A tenth of a second of a ring that is sheared for the first time: torque on two packings, at two rates."""
    text = (FOLDER / "couette_quick.toml").read_text().partition("[[compare.windows]]")[0]
    for old, new in {
        "duration = 80.0": "duration = 0.4", "grow = 2.0": "grow = 0.2", "settle = 1.0": "settle = 0.05",
        "samples = 4000": "samples = 100", "frames = 250": "frames = 20", "steady_from = 30.0": "steady_from = 0.1",
    }.items():
        assert old in text, old
        text = text.replace(old, new)
    path = tmp_path / "ring.toml"
    path.write_text(text)
    made = accuracy(path, tmp_path / "out", engines=ENGINES, knob="rate", ladder=[4.0, 2.0], packings=2, workers=2)
    (ladder,) = made.ladders
    assert [r.value for r in ladder.rungs] == [4.0, 2.0, 1.0]
    torque = [np.abs(r.values["torque"]).mean() for r in ladder.rungs]
    assert torque == sorted(torque, reverse=True), "the dashpots' part of the torque grows with the rate"
    assert all("wall_velocity" in r.values for r in ladder.rungs)
    assert ladder.rungs[0].steps == pytest.approx(ladder.rungs[2].steps / 4, abs=100), "whole samples"
