"""Samples that are shaken by their steps: both looks at them, what is physics in them, and what becomes of a rung."""

from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

from harness.scene.load import load_scene
from harness.studies.accuracy import shaken
from harness.studies.accuracy.asked import asked_all
from harness.studies.accuracy.bulk_plan import bare_settings
from harness.studies.accuracy.bulk_rungs import OWN_WIDTH, Key, Measured, rungs_of
from harness.studies.accuracy.limit import find_limit
from harness.studies.accuracy.shaken import Shaking, shaking_of, why_shaken
from harness.studies.compare.curves import BiaxialCurves

FILE = Path(__file__).resolve().parents[3] / "inputs" / "scenes" / "biaxial_quick.toml"
STILL = [Shaking(balance=0.026 * f, energy=0.02 * g) for f, g in ((0.9, 0.3), (1.0, 1.0), (1.2, 4.0), (1.0, 0.8))]


def times(balance, energy):
    return [replace(s, balance=balance * s.balance, energy=energy * s.energy) for s in STILL]


def test_a_step_that_shakes_is_found_by_either_look():
    assert why_shaken({"dt": 8.0}, times(6.0, 1.0), STILL) == (
        "opposite walls out of balance by 16 %, 6.0 times the finest rung's"
    )
    assert why_shaken({"dt": 8.0}, times(1.0, 40.0), STILL) == "kinetic energy 40 times the finest rung's"
    assert ";" in why_shaken({"dt": 8.0}, times(6.0, 40.0), STILL)
    assert why_shaken({"dt": 4.0}, times(1.9, 9.0), STILL) == ""


@pytest.mark.parametrize(("knob", "x", "balance", "energy"), [
    ("rate", 8.0, 4.3, 9.0), ("rate", 4.0, 2.8, 6.2), ("stiffness", 16.0, 0.42, 9.9), ("size", 2.0, 0.74, 3.0),
])
def test_what_is_physics_is_not_held_against_a_rung(knob, x, balance, energy):
    """The ratios that biaxial_quick was measured to have; the same on the ladder of steps would not be believed."""
    assert why_shaken({knob: x}, times(balance, energy), STILL) == ""
    if balance > 2.0:
        assert why_shaken({"dt": x}, times(balance, energy), STILL)


def test_a_drive_that_is_faster_can_still_be_shaken():
    assert why_shaken({"rate": 2.0}, times(5.0, 1.0), STILL)
    assert why_shaken({"law": 2.0}, times(50.0, 500.0), STILL) == "", "another law moves differently"


def test_packings_that_disagree_leave_a_doubt():
    wild = [replace(s, balance=s.balance * f) for s, f in zip(STILL, (1.0, 1.0, 1.0, 60.0), strict=True)]
    assert why_shaken({"dt": 8.0}, wild, STILL) == ""
    unknown = [replace(s, balance=float("nan"), energy=float("nan")) for s in STILL]
    assert why_shaken({"dt": 8.0}, times(9.0, 90.0), unknown) == ""


def test_numbers_of_a_run_by_hand(monkeypatch):
    """Walls 3 % apart from a strain of 0.5 % on, wilder before; two discs of which one moves at twice the drive."""
    strain = np.linspace(0.0, 0.1, 101)
    ones = np.ones(101)
    top = 100.0 * ones
    bottom = np.where(strain < 0.005, 0.0, 97.0)
    curves = BiaxialCurves(
        step=strain, time=strain, strain=strain, x=ones, z=ones, force_top=top, force_bottom=bottom, force_left=ones,
        force_right=ones, pressure=1.0,
    )
    monkeypatch.setattr(shaken, "biaxial_curves", lambda *_: curves)
    moving = SimpleNamespace(particles=SimpleNamespace(vector=lambda *_: np.array([[0.0, 2.0], [0.0, 0.0]])))
    wild = SimpleNamespace(particles=SimpleNamespace(vector=lambda *_: np.full((2, 2), 99.0)))
    system = SimpleNamespace(particles=SimpleNamespace(mass=np.array([1.0, 3.0])), dimension=2)
    trajectory = SimpleNamespace(frames=(wild, moving), series={"top_v": -ones})
    found = shaking_of(load_scene(FILE), system, trajectory)
    assert found.balance == pytest.approx(0.03)
    assert found.energy == pytest.approx(1.0 * 4.0 / 4.0)


# --- rungs -----------------------------------------------------------------------------------------------


def ladder(shakes):
    """The dt rungs of biaxial_quick, four packings; values 20 but where the sample is shaken."""
    scene = load_scene(FILE)
    (one,) = asked_all(scene, FILE, knob="dt", ladder=None, quantity=None)
    settings, done, measured = [], {}, {}
    for setting in bare_settings(scene, (one,)):
        systems = tuple(
            SimpleNamespace(digest=lambda n=f"{setting.label} {k}": n, particles=range(9), dt=1e-6, steps=100)
            for k in range(4)
        )
        settings.append(replace(setting, systems=systems))
        shake = times(*shakes.get(setting.value, (1.0, 1.0)))
        for k, system in enumerate(systems):
            key = Key("lammps", system.digest())
            done[key] = SimpleNamespace(outcome=SimpleNamespace(
                status="completed", timings={"run": 1.0}, cpu_seconds=2.0, wall_seconds=2.0
            ))
            value = {"friction_angle": np.array([99.0 if setting.value in shakes else 20.0 + 0.1 * k])}
            measured[key] = Measured(values={OWN_WIDTH: value}, shaking=shake[k])
    return rungs_of(settings, "lammps", done, measured)


def test_a_shaken_rung_is_unstable_and_in_no_limit():
    rungs = ladder({0.36: (6.0, 50.0)})
    wild, *rest = rungs
    assert (wild.value, wild.status, wild.seconds, wild.each, wild.good) == (0.36, "unstable", None, (), False)
    assert "opposite walls" in wild.reason
    assert not wild.values
    assert all(r.good and r.seconds == 1.0 for r in rest)
    limit = find_limit([r.x for r in rest], np.array([r.values["friction_angle"] for r in rest]), 1.0)
    assert limit.value[0] == pytest.approx(20.15)


def test_steps_beyond_the_scenes_limit_are_marked_and_stay():
    rungs = ladder({})
    assert [(r.value, r.beyond is not None) for r in rungs] == [
        (0.36, True), (0.18, True), (0.09, True), (0.045, False), (0.0225, False)
    ]
    assert rungs[0].beyond == pytest.approx(0.0536, abs=1e-4)
    assert all(r.good and r.values for r in rungs)
    assert [r.offered for r in rungs] == [False, False, False, True, True]


def test_the_mark_is_what_scene_refuses(tmp_path):
    """Just below the limit the scene is taken, just above it is not."""
    from harness.errors import InputError
    from harness.scene.grains import grains_of
    from harness.scene.resolve import known_system
    from harness.studies.accuracy.turn import largest_fraction, replaced

    scene = load_scene(FILE)
    largest = largest_fraction(scene, grains_of(scene))
    for factor, taken in ((0.9999, True), (1.0001, False)):
        turned = replaced(scene, numerics=replaced(scene.numerics, dt_fraction=factor * largest))
        if taken:
            known_system(turned, FILE)
        else:
            with pytest.raises(InputError, match=r"expected at most 0\.0536"):
                known_system(turned, FILE)
