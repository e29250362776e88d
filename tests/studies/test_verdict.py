"""Verdicts, exit status, and the command in a failure's text."""

from pathlib import Path

import pytest

from harness.studies.verdict import Check, Rerun, failed, judged, not_checked


def check(verdict: str, level: str = "L2") -> Check:
    facts = {"quantity": "q", "left": "a", "right": "b", "deviation": None, "tolerance": None, "why": ""}
    return Check(level=level, verdict=verdict, **facts)


def of(deviation: float, tolerance: float) -> Check:
    return judged(level="L1", quantity="q", left="a", right="b", deviation=deviation, tolerance=tolerance, why="seen",
                  rerun="grainproof ...")


@pytest.mark.parametrize(("deviation", "verdict"), [
    (0.0, "agrees"), (0.1, "agrees"), (0.1000000001, "differs"), (float("nan"), "differs"), (float("inf"), "differs"),
])
def test_a_deviation_at_the_tolerance_agrees_and_what_is_no_number_differs(deviation, verdict):
    assert of(deviation, 0.1).verdict == verdict


def test_only_a_failure_says_how_to_repeat_it():
    assert of(0.0, 1.0).why == "seen"
    assert of(2.0, 1.0).why == "seen; rerun: grainproof ..."


@pytest.mark.parametrize(("checks", "fails"), [
    ([], True),
    ([check("not_checked")], True),
    ([check("agrees", "run")], True),
    ([check("agrees", "run"), check("not_checked")], True),
    ([check("agrees"), check("not_checked")], False),
    ([check("inconclusive")], False),
    ([check("known_difference", "L3")], False),
    ([check("agrees"), check("differs")], True),
    ([check("agrees"), check("differs", "run")], True),
])
def test_a_comparison_fails_when_something_differs_or_nothing_was_compared(checks, fails):
    """What a run has to do with its own scene ("run") compares no codes; not checked is never a pass."""
    assert failed(checks) is fails


def test_not_checked_has_no_number():
    made = not_checked(level="L2", quantity="q", left="a", right="b", why="no run")
    assert (made.verdict, made.deviation, made.tolerance) == ("not_checked", None, None)


def test_the_command_that_repeats_is_safe_to_paste():
    rerun = Rerun(scene_file=Path("my $(rm) scene.toml"), out=Path("o ut"), packings=3)
    assert rerun("a", "b") == "grainproof compare 'my $(rm) scene.toml' --engines a,b --out 'o ut' --packings 3"
