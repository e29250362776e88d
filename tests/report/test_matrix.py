"""The matrix of verdicts: every check in one cell, the worst on top, nothing invented where there is none."""

from typing import get_args

from harness.report.matrix import SEVERITY, matrices
from harness.studies.verdict import Verdict


def shown(matrix):
    return {
        (r.quantity, c): cell and (cell.verdict, cell.note)
        for r in matrix.rows for c, cell in zip(matrix.columns, r.cells, strict=True)
    }


def test_every_verdict_has_its_place():
    assert set(SEVERITY) == set(get_args(Verdict))


def test_pairs_of_codes_and_single_codes_stand_apart(check):
    between, alone = matrices([
        check(quantity="force"), check(quantity="force", left="a", right="c", deviation=0.5, verdict="differs"),
        check(quantity="peak", left="a", right="c", deviation=None, tolerance=None, verdict="not_checked"),
        check(quantity="wall", right="p_x", level="run", deviation=2e-3, tolerance=None),
        check(quantity="sigma", left="c", right="talk", level="L3", deviation=0.3, verdict="known_difference"),
    ], ["a", "b", "c"])
    assert between.columns == (("a", "b"), ("a", "c"))
    assert shown(between) == {
        ("force", ("a", "b")): ("agrees", "0.001 ≤ 0.01"), ("force", ("a", "c")): ("differs", "0.5 > 0.01"),
        ("peak", ("a", "b")): None, ("peak", ("a", "c")): ("not_checked", ""),
    }
    assert alone.columns == (("a",), ("c",))
    assert shown(alone) == {
        ("wall, against p_x", ("a",)): ("agrees", "0.002"), ("wall, against p_x", ("c",)): None,
        ("sigma, against talk", ("a",)): None, ("sigma, against talk", ("c",)): ("known_difference", "0.3 > 0.01"),
    }


def test_of_several_checks_in_a_cell_the_worst_is_shown_and_counted(check):
    verdicts = ("agrees", "inconclusive", "differs", "differs", "not_checked")
    (matrix,) = matrices([check(v, deviation=k / 10) for k, v in enumerate(verdicts)], ["a", "b"])
    assert shown(matrix) == {("force", ("a", "b")): ("differs", "2 of 5, 0.2 > 0.01")}


def test_the_number_of_samples_stands_beside_what_is_the_largest_of_them(check):
    (matrix,) = matrices([check(deviation=1e-3, samples=2)], ["a", "b"])
    assert shown(matrix)["force", ("a", "b")] == ("agrees", "0.001 ≤ 0.01, of 2 samples")


def test_statistics_stand_beside_chance_and_margin(check):
    (matrix,) = matrices([check("inconclusive", deviation=0.1, tolerance=0.05, chance=0.3)], ["a", "b"])
    assert shown(matrix)["force", ("a", "b")] == ("inconclusive", "0.1; chance 0.3, margin 0.05")


def test_a_deviation_that_is_no_number_is_not_within_its_tolerance(check):
    (matrix,) = matrices([check("differs", deviation=float("nan"))], ["a", "b"])
    assert shown(matrix)["force", ("a", "b")] == ("differs", "nan > 0.01")


def test_a_check_declared_for_nobody_is_shown_last(check):
    (matrix,) = matrices([
        check("not_checked", left="-", right="-", deviation=None), check(quantity="other"),
    ], ["a", "b"])
    assert matrix.columns == (("a", "b"), ("-", "-"))
    assert shown(matrix)["force", ("-", "-")] == ("not_checked", "")


def test_codes_alone_stand_in_the_order_in_which_they_ran(check):
    (matrix,) = matrices([check(left=e, right="p_x") for e in ("c", "a")], ["a", "b", "c"])
    assert matrix.columns == (("a",), ("c",))
    assert matrices([], ["a"]) == ()
