"""Other drives of the cohesion study: what is varied, and what is said of stresses that are put in."""

import pytest

from harness.scene.grains import grains_of
from harness.studies.reproduce.boxes import LARGEST, SIDE
from harness.studies.reproduce.cohesion import declared, drives

TALK = {100.0: 183.0, 500.0: 798.0}


@pytest.fixture
def scenes(ask):
    return declared.without_adhesion(declared.main_tests(ask("paper")))


def stresses(plateau, top, side):
    return {drives.PLATEAU: plateau, LARGEST: top, SIDE: side}


def measured(made, box_run, numbers):
    """All settings alike but one: (wall, duration) -> what its top of the curve is at both pressures."""
    found = []
    for wall in drives.WALLS:
        for duration in drives.DURATIONS:
            top = numbers.get((wall, duration), {100.0: 150.0, 500.0: 690.0})
            found += [
                made(drives._name(p, wall, duration), "e", 0, box_run(stresses(125.0, top[p], p))) for p in TALK
            ]
    return found


def test_the_tests_without_adhesion_are_varied(scenes):
    assert set(scenes) == set(declared.PRESSURES)
    assert all(s.contact.normal.adhesion_stiffness == 0.0 for s in scenes.values())
    assert all(s.preparation.pressure == p == s.side.pressure for p, s in scenes.items())


def test_only_drive_and_wall_change(scenes, ask):
    planned = [c for c in declared.cases(ask("paper")) if c.name.startswith("another drive")]
    assert len(planned) == len(drives.WALLS) * len(drives.DURATIONS) * len(TALK) == 12
    assert {c.packings for c in planned} == {1}
    assert len({c.scene.title for c in planned}) == 12
    for c in planned:
        own = scenes[c.scene.side.pressure]
        for same in ("contact", "particles", "preparation"):
            assert getattr(c.scene, same) == getattr(own, same)
        assert c.scene.top.duration in drives.DURATIONS
        assert c.scene.side.mass in (own.side.mass, grains_of(own).total_mass)
    masses = {c.scene.side.mass for c in planned}
    assert len(masses) == 2
    assert max(masses) == pytest.approx(0.02042, rel=2e-3)  # 1950 spheres of the talk's radii: 0.0204 kg


def test_rows_have_stresses_and_the_line(scenes, made, box_run):
    rows = drives.drive_rows(measured(made, box_run, {}), scenes, TALK)
    assert len(rows) == 12
    top = next(r for r in rows if r["read"] == "top" and r["T (s)"] == 0.02)
    assert top["sigma_zz at p_x = 500 N/m (N/m)"] == 690.0
    K = (690.0 - 150.0) / 400.0
    assert top["c, from p_x (N/m)"] == pytest.approx((150.0 - 100.0 * K) / (2.0 * K**0.5), rel=1e-10)
    assert top["off the talk"] == pytest.approx(1.0 - 150.0 / 183.0)
    inertia = {r["T (s)"]: r["I at p_x = 100 N/m"] for r in rows}
    assert inertia[0.01] == pytest.approx(4.0 * inertia[0.04], rel=1e-12)


def test_words_name_the_nearest_and_its_line(scenes, made, box_run):
    heavy = "as heavy as the sample"
    rows = drives.drive_rows(measured(made, box_run, {(heavy, 0.01): {100.0: 180.0, 500.0: 800.0}}), scenes, TALK)
    words = drives.drive_words(rows, TALK)
    assert f"the top of the curve at T = 0.01 s with a side wall {heavy}: 2 % off at worst" in words
    assert "phi = 12.5 degrees and c = 10 N/m (the talk's two stresses: 12.2 and 12)" in words


def test_no_line_is_said(scenes, made, box_run):
    falling = {100.0: 700.0, 500.0: 690.0}
    numbers = {(w, d): falling for w in drives.WALLS for d in drives.DURATIONS}
    rows = [r for r in drives.drive_rows(measured(made, box_run, numbers), scenes, TALK) if r["read"] == "top"]
    assert "phi = none degrees" in drives.drive_words(rows, TALK)


def test_a_run_that_failed_leaves_its_row_out(scenes, made, box_run):
    found = measured(made, box_run, {})
    assert len(drives.drive_rows(found[1:], scenes, TALK)) == 10
