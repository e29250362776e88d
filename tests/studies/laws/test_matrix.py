"""Cells: the worst run decides what is shown."""

import pytest

from harness.studies.laws.judge import CLOSED_FORM, PLAIN_FRAME
from harness.studies.laws.matrix import Answered, make_cell
from harness.studies.verdict import Check


def check(right, deviation, verdict="agrees", quantity="linear: load"):
    return Check(level="L0", quantity=quantity, left="lammps", right=right, deviation=deviation, tolerance=1e-12,
                 verdict=verdict, why="somewhere")


def ran(status="completed", reason="", part="pairs in 2D"):
    return Answered(part=part, status=status, reason=reason)


def test_a_code_is_shown_against_the_kernel_and_frames_do_not_count():
    checks = [check("kernel:lammps", 3e-16), check("kernel:lammps", 5e-15), check(CLOSED_FORM, 1e-3),
              check(PLAIN_FRAME, 0.5, "known_difference")]
    cell = make_cell("linear", "lammps", [ran(), ran()], checks)
    assert (cell.text, cell.against, cell.differs) == ("5.0e-15", "kernel:lammps", False)


def test_without_a_kernel_the_closed_form_is_shown():
    checks = [check("kernel:lammps", None, "not_checked"), check(CLOSED_FORM, 2e-15)]
    assert make_cell("jkr", "lammps", [ran()], checks).text == "2.0e-15"


def test_what_differs_is_marked_even_where_it_is_not_shown():
    checks = [check("kernel:lammps", 3e-16), check(CLOSED_FORM, 1e-3, "differs")]
    assert make_cell("linear", "lammps", [ran()], checks).text == "3.0e-16 differs"
    nan = make_cell("linear", "lammps", [ran()], [check("kernel:lammps", float("nan"), "differs")])
    assert nan.text == "nan differs"


@pytest.mark.parametrize(("runs", "shown", "note"), [
    ([ran("unsupported", "laws: unsupported: no")], "unsupported", "laws: unsupported: no"),
    ([ran("unsupported", "walls: known wrong: see")], "known wrong", "walls: known wrong: see"),
    ([ran("unavailable", "not here")], "unavailable", "not here"),
    ([ran(), ran("crashed", "SIGSEGV")], "failed", "pairs in 2D: crashed: SIGSEGV"),
    ([ran()], "-", ""),
])
def test_why_there_is_no_number(runs, shown, note):
    cell = make_cell("linear", "lammps", runs, [])
    assert (cell.text, cell.note, cell.deviation) == (shown, note, None)
    assert cell.differs == (shown == "failed")


def test_a_part_that_is_missing_gets_a_star():
    runs = [ran(), ran("unsupported", "walls", "planes in 2D")]
    cell = make_cell("jkr", "lammps", runs, [check("kernel:lammps", 0.0)])
    assert cell.text == "0*"
    assert cell.missing == ("planes in 2D: walls",)
