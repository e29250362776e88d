"""Which engines are put beside each other, and as what."""

from harness.studies.compare.pairs import Pair, pairs_of


def kinds(engines, friction=True):
    return {(p.left, p.right): p.kind for p in pairs_of(engines, friction=friction)}


def test_each_code_meets_its_own_conventions_and_the_other_codes():
    assert kinds(["lammps", "liggghts", "kernel:lammps", "kernel:liggghts"]) == {
        ("lammps", "kernel:lammps"): "same_conventions", ("liggghts", "kernel:liggghts"): "same_conventions",
        ("lammps", "liggghts"): "codes",
    }


def test_with_friction_other_conventions_are_shown_and_promise_nothing():
    assert kinds(["lammps", "kernel:talk"]) == {("lammps", "kernel:talk"): "other_conventions"}
    assert kinds(["lammps", "kernel:talk", "kernel:lammps"]) == {("lammps", "kernel:lammps"): "same_conventions"}


def test_without_friction_all_conventions_are_one():
    assert kinds(["lammps", "liggghts", "kernel:talk"], friction=False) == {
        ("lammps", "kernel:talk"): "same_conventions", ("liggghts", "kernel:talk"): "same_conventions",
        ("lammps", "liggghts"): "codes",
    }


def test_one_engine_has_nobody_to_meet():
    assert kinds(["lammps"]) == kinds(["kernel:talk"]) == {}


def test_a_pair_knows_what_is_missing_and_which_packings_both_have():
    pair = Pair(left="a", right="b", kind="codes")
    assert pair.missing({"a": 1, "b": 2}) == ""
    assert pair.missing({"b": 2}) == "no completed run of a"
    assert pair.missing({}) == "no completed run of a and b"
    assert pair.both({"a": {0: "p", 2: "q"}, "b": {2: "r", 1: "s"}}) == {2: ("q", "r")}
    assert pair.both({"a": {0: "p"}}) == {}
