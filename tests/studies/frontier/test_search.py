"""Bisection against codes that are stable up to a known step, never, always, or not to be asked."""

import math
from dataclasses import replace

import pytest

from harness.report.frontier_tables import _row
from harness.studies.frontier.probe import Look
from harness.studies.frontier.search import HIGHEST, LOWEST, Search
from harness.studies.frontier.study import Frontier


def run(search, answer):
    """Let a search look until it is done; return how many looks it took."""
    for count in range(60):
        if search.done:
            return count
        search.tell(answer(search.next_step()))
    raise AssertionError("it never ends")


def up_to(limit):
    return lambda dt: Look(dt=dt, seen="stable" if dt < limit else "unstable", energy=1.0)


@pytest.mark.parametrize("limit", [0.11, 0.5, 0.969, 0.999, 1.0001, 1.04, 2.7, 7.9])
def test_it_encloses_the_limit_as_closely_as_asked_for(limit):
    search = Search(guess=1.0)
    run(search, up_to(limit))
    assert search.fault == ""
    assert search.stable < limit <= search.unstable
    assert search.unstable - search.stable <= search.precision * search.middle


def test_a_good_guess_takes_few_looks():
    search = Search(guess=1.0)
    assert run(search, up_to(1.001)) == 5


def test_a_code_that_is_never_stable():
    search = Search(guess=1.0)
    run(search, up_to(0.0))
    assert search.stable is None
    assert search.unstable == pytest.approx(LOWEST)
    assert search.fault.startswith("unstable at every step")


def test_a_code_that_does_not_begin_was_not_measured():
    """Refused is not unstable: theory may know of a step that the code is too careful for."""
    search = Search(guess=1.0)
    run(search, lambda dt: Look(dt=dt, seen="unstable", energy=math.inf, reason="unstable: step 0: felt a step late"))
    assert search.fault.startswith("refused at every step")
    found = frontier(exact=0.5, fault=search.fault, unstable=search.unstable)
    assert (found.measured, found.deviation, found.verdict) == (None, None, "not_checked")
    agreed = replace(found, exact=0.0)
    assert (agreed.measured, agreed.deviation, agreed.verdict) == (0.0, 0.0, "agrees")
    assert replace(found, fault="unstable at every step down to 0.1 of the guess", end="grew").verdict == "differs"


def frontier(**facts):
    return Frontier(
        engine="kernel:talk", law="rolling spring", packing="lattice", system=None, particles=2, contacts=1, unit=1.0,
        formula=1.0, linear=True, note="", **{"stable": None, "looks": 6, "end": "refused"} | facts,
    )


def test_a_refusal_below_the_limit_is_no_measurement():
    """A code that is more careful than theory: nothing was seen to grow. Beyond the limit it counts."""
    careful = frontier(exact=1.0, fault="", stable=0.98, unstable=0.99)
    assert (careful.deviation, careful.verdict) == (None, "not_checked")
    assert "more careful" in _row(careful)["note"]
    assert replace(careful, end="grew").verdict == "agrees"
    assert replace(careful, stable=0.9, unstable=0.91, end="stopped").verdict == "differs"
    beyond = replace(careful, stable=1.001, unstable=1.009)
    assert beyond.verdict == "agrees"
    assert replace(careful, stable=1.1, unstable=1.11).verdict == "differs"


@pytest.mark.parametrize(("reason", "end"), [
    ("", "grew"), ("unstable: step 0: felt a step late", "refused"), ("crashed: lost atoms", "stopped"),
])
def test_how_the_smallest_unstable_step_ended(reason, end):
    search = Search(guess=1.0)
    assert search.end == ""
    search.tell(Look(dt=1.1, seen="unstable", energy=math.inf, reason="crashed: far beyond"))
    search.tell(Look(dt=1.03, seen="unstable", energy=9.0, reason=reason))
    search.tell(Look(dt=0.97, seen="stable", energy=1.0))
    assert search.end == end


def test_a_code_that_is_always_stable():
    search = Search(guess=1.0)
    run(search, up_to(math.inf))
    assert search.unstable is None
    assert search.stable == pytest.approx(HIGHEST)
    assert search.fault.startswith("stable at every step")


def test_a_run_that_says_nothing_ends_the_search():
    search = Search(guess=1.0)
    run(search, lambda dt: Look(dt=dt, seen="failed", energy=math.inf, reason="crashed: wrong deck"))
    assert search.fault == "crashed: wrong deck"
    assert search.stable is search.unstable is None


def test_a_stable_look_beyond_an_unstable_one_does_not_count():
    """Islands of stability are not the largest stable step."""
    search = Search(guess=1.0)
    for dt, seen in ((0.97, "unstable"), (0.6, "stable"), (1.2, "stable")):
        search.tell(Look(dt=dt, seen=seen, energy=1.0))
    assert (search.stable, search.unstable) == (0.6, 0.97)
