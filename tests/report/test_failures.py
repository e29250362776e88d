"""What went wrong, and how to repeat it."""

from harness.report.failures import entries, reason_and_command


def test_the_command_is_taken_off_the_reason(check):
    assert reason_and_command(check(why="a; b; rerun: grainproof compare 'x; y.toml'")) == (
        "a; b", "grainproof compare 'x; y.toml'")
    assert reason_and_command(check(why="all is well")) == ("all is well", "")


def test_what_an_engine_warns_of_is_listed(check, ran):
    (entry,) = entries([check()], [ran("a"), ran("b", warning="swings could have grown", reproduce="cd x && y")])
    assert (entry.word, entry.title, entry.why, entry.command) == (
        "warning", "b, packing 1", "swings could have grown", "cd x && y")


def test_runs_that_failed_and_checks_that_differ_are_listed_with_their_command(check, ran):
    runs = [
        ran("a"), ran("b", 1, status="crashed", last_lines=("one", "two"), reproduce="cd x && y"),
        ran("c", status="unavailable", reason="pip install c", reproduce="", steps_done=0),
    ]
    crashed, missing, differs = entries([check(), check("differs"), check("inconclusive")], runs)
    assert (crashed.word, crashed.title, crashed.command) == ("crashed", "b, packing 2", "cd x && y")
    assert crashed.why == f"signal 6, after step 3 of {runs[1].outcome.steps}; last words: two"
    assert (missing.word, missing.why, missing.command) == ("unavailable", "pip install c", "")
    assert (differs.title, differs.why, differs.command) == (
        "L2, force: a against b", "largest of 3 samples", "grainproof compare s.toml")
