"""Cells: the worst run decides what is shown."""

import pytest

from harness.studies.laws.direct import DirectCheck
from harness.studies.laws.judge import CLOSED_FORM, PLAIN_FRAME, STEPPED
from harness.studies.laws.matrix import Answered, direct_cell, make_cell
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


def test_every_part_that_failed_is_named():
    runs = [ran("crashed", "SIGSEGV"), ran(part="pairs in 3D"), ran("timed_out", "after 3 s", "planes in 2D")]
    cell = make_cell("linear", "lammps", runs, [])
    assert cell.note == "pairs in 2D: crashed: SIGSEGV; planes in 2D: timed out: after 3 s"


def test_whole_collisions_count_before_exits():
    checks = [check(STEPPED, 3e-14), check("restitution_jkr", 2e-3)]
    cell = make_cell("jkr", "lammps", [ran()], checks)
    assert (cell.text, cell.against) == ("3.0e-14", STEPPED)


def directly(deviation, verdict="known_difference", what="shear"):
    return DirectCheck(
        level="L0", quantity=f"linear: {what}", left="lammps", right="liggghts", deviation=deviation, tolerance=0.1,
        verdict=verdict, why="of the arms", laws="linear", what=what, reasons=("arms",), off=1e-15,
    )


def test_codes_against_each_other_have_a_cell_of_their_own():
    pair = ("lammps", "liggghts")
    cell = direct_cell("linear", pair, [directly(0.02), directly(0.1, what="roll"), check("kernel:lammps", 1.0)])
    assert (cell.text, cell.engine, cell.note) == ("1.0e-01", "lammps - liggghts", "roll: of the arms")
    assert direct_cell("linear", pair, [directly(0.1, "differs")]).text == "1.0e-01 differs"
    assert direct_cell("hertz", pair, [directly(0.1)]).text == "-"
    own = make_cell("linear", "lammps", [ran()], [directly(0.1, "differs"), check("kernel:lammps", 0.0)])
    assert own.text == "0"
