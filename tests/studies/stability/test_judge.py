"""What a run is called: by how the code ended, and by what its invariants say."""

import math
from dataclasses import replace
from datetime import UTC, datetime
from pathlib import Path
from types import SimpleNamespace

import pytest

from harness.runs.outcome import FileRecord, Host, Outcome
from harness.scene.expect import Expect, Invariant, KnownOutcome
from harness.studies.stability.cases import Case
from harness.studies.stability.judge import Held, Result, declared, judge_refusal, judge_run, measure, worst

HOST = Host(cpu_model="x", cores=1, os="x", python="3", numpy="2")


def outcome(status="completed", reason="", timings=None, **more):
    now = datetime(2026, 1, 1, tzinfo=UTC)
    return Outcome(
        status=status, reason=reason, scene_name="s", engine="e", engine_version="1", harness_version="1", host=HOST,
        system_digest="d", particles_digest="p", steps=10, particles=1, started=now, finished=now, load_average=0.0,
        timings=timings or {}, cpu_seconds=0.1, wall_seconds=0.1,
        trajectory=FileRecord(size=1, sha256="a") if status == "completed" else None, **more,
    )


def case(*invariants, outcomes=(), refused=None, refusal="", name="c"):
    expect = Expect(topics=("alone",), why="a test", invariants=invariants, outcomes=outcomes, refused=refused)
    scene = None if refused else SimpleNamespace()
    return Case(name=name, file=Path("c.toml"), expect=expect, title="t", scene=scene, refusal=refusal)


def invariant(name, tolerance, **more):
    return Invariant(name=name, tolerance=tolerance, reason="a test", **more)


def ended(case_, engine, run, **settings):
    return judge_run(case_, engine, outcome(**settings), run, {})


@pytest.fixture
def apart(states):
    """A pair whose distance grows by 5 % and that touches at first."""
    x = [[[0.0, 0.0], [1.9 * (1 + 0.05 * k / 4), 0.0]] for k in range(5)]
    return states.seen(x)


def test_a_run_whose_invariants_hold_is_stable(apart):
    result = ended(case(invariant("rigid", 0.06)), "lammps", apart)
    assert (result.ended, result.reason, result.as_declared) == ("stable", "", True)


def test_beyond_tolerance_it_is_degraded_and_says_by_how_much(apart):
    result = ended(case(invariant("rigid", 0.01)), "lammps", apart)
    assert result.ended == "degraded"
    assert result.reason == "rigid: change of a distance, relative 0.05 > 0.01"
    assert not result.as_declared


def test_beyond_ruin_a_run_that_said_nothing_failed_silently(apart):
    result = ended(case(invariant("rigid", 0.01, ruin=0.02)), "kernel:talk", apart)
    assert result.ended == "failed_silently"
    assert result.kernel_failed_silently


def test_beyond_ruin_a_run_that_warned_failed_loudly(apart):
    result = ended(case(invariant("rigid", 0.01, ruin=0.02)), "kernel:talk", apart, warning="swings could have grown")
    assert result.ended == "failed_loudly"
    assert result.reason == "rigid: change of a distance, relative 0.05 > 0.01; swings could have grown"


@pytest.mark.parametrize(("tolerance", "word"), [(0.01, "degraded"), (0.06, "stable")])
def test_a_warning_does_not_make_a_run_worse(apart, tolerance, word):
    assert ended(case(invariant("rigid", tolerance)), "kernel:talk", apart, warning="swings").ended == word


def test_what_the_harness_ended_at_the_time_limit_is_no_word_of_the_code():
    result = ended(case(), "lammps", None, status="timed_out", reason="no end after 0.01 s")
    assert (result.ended, result.reason) == ("timed_out", "no end after 0.01 s")
    assert not result.as_declared


@pytest.mark.parametrize("status", ["crashed", "unstable"])
def test_a_code_that_stopped_itself_failed_loudly(status):
    result = ended(case(), "lammps", None, status=status, reason="lost atoms")
    assert (result.ended, result.reason) == ("failed_loudly", "lost atoms")


def test_what_only_the_harness_found_the_code_did_not_say():
    result = ended(case(), "lammps", None, status="unstable", reason="step 3: lost", timings={"read": 0.1})
    assert result.ended == "failed_silently"


@pytest.mark.parametrize("status", ["unsupported", "unavailable"])
def test_what_was_not_run_is_called_so(status):
    assert ended(case(), "lammps", None, status=status, reason="why").ended == status


def test_a_code_that_is_not_here_is_no_surprise():
    assert ended(case(), "lammps", None, status="unavailable", reason="why").as_declared
    assert not ended(case(), "lammps", None, status="unsupported", reason="why").as_declared


def test_what_cannot_be_measured_is_no_pass(apart):
    result = ended(case(invariant("wall_load", 1.0)), "lammps", apart)
    assert result.ended == "degraded"
    assert "not measured, no series of walls" in result.reason


def test_a_case_without_a_contact_tests_none(states):
    far = states.seen([[[0.0, 0.0], [9.0, 0.0]]] * 3)
    assert ended(case(invariant("rigid", 0.1)), "lammps", far).ended == "degraded"
    assert ended(case(invariant("free_flight", 0.1)), "lammps", far).ended == "stable"


def test_declared_endings_go_by_name_then_by_code():
    known = (KnownOutcome(engine="kernel", outcome="degraded", reason="a"),
             KnownOutcome(engine="kernel:corrected", outcome="failed_loudly", reason="b"))
    of = case(outcomes=known)
    assert declared(of, "kernel:talk") == ("degraded", "a")
    assert declared(of, "kernel:corrected") == ("failed_loudly", "b")
    assert declared(of, "lammps@2024.8") == ("stable", "")


def test_the_kernel_may_not_fail_silently_even_when_declared():
    silent = "failed_silently"
    result = Result(case="c", engine="kernel:talk", ended=silent, reason="", expected=silent, known="")
    assert result.as_declared
    assert result.kernel_failed_silently
    assert not replace(result, engine="kernel:lammps").kernel_failed_silently, "it does what LAMMPS does"


def test_a_refusal_must_name_what_was_declared():
    assert judge_refusal(case(refused="radius", refusal="the radius is wrong"), "lammps").ended == "refused"
    other = judge_refusal(case(refused="radius", refusal="the mass is wrong"), "lammps")
    assert other.ended == "failed_silently"
    assert "another reason" in other.reason
    assert judge_refusal(case(refused="radius", refusal=""), "lammps").reason.startswith("the scene was taken")


def held(size, tolerance, ruin=1.0):
    return Held(invariant="x", size=size, tolerance=tolerance, ruin=ruin, says="")


def test_the_worst_is_the_ruined_one_then_the_furthest_beyond():
    mild, far, ruined = held(0.5, 1e-6), held(0.9, 1e-9), held(2.0, 1.9)
    assert worst([mild, far]) is far
    assert worst([mild, far, ruined]) is ruined
    assert worst([held(0.1, 0.2)]) is None


def test_no_number_is_broken_and_ruined():
    assert held(math.nan, 1.0).broken
    assert held(math.nan, 1.0).ruined
    assert not held(None, 1.0).broken


def test_until_cuts_the_run_before_it_is_measured(apart):
    assert measure(invariant("rigid", 1.0, until=0.1), apart, {}).size == pytest.approx(0.0125)


def test_a_twin_that_failed_leaves_its_invariant_unmeasured(apart):
    from harness.scene.expect import Twin

    found = measure(invariant("twin", 1.0, twin=Twin(case="other")), apart, {"other": None})
    assert found.size is None
    assert "did not complete" in found.says
