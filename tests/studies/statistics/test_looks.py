"""Looks at more and more replicates: counted, kept, and each at half the level of the one before."""

from pathlib import Path

import pytest

from harness.scene.load import load_scene
from harness.studies.compare.study import at_look
from harness.studies.statistics.looks import FILE, level_of, which_look

SCENE = Path(__file__).parents[3] / "inputs/scenes/biaxial_quick.toml"


def test_looks_are_counted_by_the_number_of_replicates(tmp_path):
    assert which_look(tmp_path, "a", ["lammps", "kernel"], 8) == (8,)
    assert which_look(tmp_path, "a", ["kernel", "lammps"], 16) == (8, 16)
    assert which_look(tmp_path, "a", ["lammps", "kernel"], 8) == (8,), "the same number again is the same look"
    assert which_look(tmp_path, "a", ["lammps", "kernel"], 12) == (8, 16, 12)


def test_another_start_or_other_engines_are_another_comparison(tmp_path):
    which_look(tmp_path, "a", ["lammps", "kernel"], 8)
    assert which_look(tmp_path, "b", ["lammps", "kernel"], 16) == (16,)
    assert which_look(tmp_path, "a", ["lammps", "liggghts"], 16) == (16,)


def test_one_packing_is_no_look(tmp_path):
    assert which_look(tmp_path, "a", ["lammps"], 1) == ()
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize("damage", ["", "{", "[]", '{"looks": {"a lammps": "8"}}'])
def test_a_damaged_file_is_begun_anew(tmp_path, damage):
    (tmp_path / FILE).write_text(damage)
    assert which_look(tmp_path, "a", ["lammps"], 8) == (8,)


def test_all_looks_together_stay_below_twice_the_rate():
    assert sum(level_of(0.05, range(k)) for k in range(1, 30)) < 0.1 + 1e-12


def test_the_scene_is_judged_at_the_rate_of_its_look():
    scene = load_scene(SCENE)
    assert at_look(scene, (8,)) is scene
    assert at_look(scene, (8, 16)).compare.false_alarms == scene.compare.false_alarms / 2
