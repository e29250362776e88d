"""The judge: what it finds, where it says it was, and what it never passes."""

from dataclasses import replace

import numpy as np
import pytest

from harness.engines.protocol import Reaction
from harness.studies.laws.arrangement import arrangement
from harness.studies.laws.cases import CASES, TOLERANCE
from harness.studies.laws.drive import Driver, Job
from harness.studies.laws.invariance import known_dependence
from harness.studies.laws.judge import CLOSED_FORM, PLAIN_FRAME, judge_engine

LAWS = CASES["linear+spring"]
PLACE = arrangement("pair", 2)


@pytest.fixture(scope="module")
def reaction(tmp_path_factory):
    """Of the kernel in LIGGGHTS' conventions."""
    from harness.engines.registry import ENGINES

    driver = Driver(root=tmp_path_factory.mktemp("runs"), time_limit=60.0, workers=1)
    done = driver.drive(Job(laws=LAWS, engine=ENGINES["kernel:liggghts"], arrangement=PLACE))
    assert done.status == "completed"
    return done


def named(done, name: str):
    class Named:
        pass

    engine = Named()
    engine.name = name
    return replace(done, job=replace(done.job, engine=engine))


def with_force(done, track, change):
    """The run with the force on the first body of one track changed."""
    force = done.reaction.force.copy()
    row = track.bodies[0]
    force[:, row] = change(force[:, row])
    return replace(done, reaction=Reaction(force=force, torque=done.reaction.torque))


def judged(done, kernel, laws=LAWS):
    """The worst check of each motion and partner."""
    order = ("differs", "not_checked", "known_difference", "agrees")
    checks = judge_engine(laws, "liggghts", {done.part: named(done, "liggghts")}, kernel, "again")
    checks.sort(key=lambda c: -order.index(c.verdict))
    return {(c.quantity.partition(": ")[2], c.right): c for c in checks}


def test_equal_runs_agree_and_every_motion_is_checked(reaction):
    checks = judged(reaction, {reaction.part: reaction})
    for motion in PLACE.motions:
        assert checks[motion, "kernel:liggghts"].deviation == 0.0
        assert checks[motion, PLAIN_FRAME].verdict in ("agrees", "known_difference")
    assert ("mixed", CLOSED_FORM) not in checks
    assert {c.verdict for c in checks.values()} == {"agrees", "known_difference"}


def test_a_deviation_is_named_by_motion_frame_and_part(reaction):
    track = next(t for t in PLACE.tracks_of("shear") if t.frame.name == "mirrored")
    checks = judged(with_force(reaction, track, lambda f: f * (1 + 1e-9)), {reaction.part: reaction})
    wrong = {key: c for key, c in checks.items() if c.verdict == "differs"}
    assert set(wrong) == {("shear", "kernel:liggghts"), ("shear", PLAIN_FRAME)}
    assert "frame mirrored, pairs in 2D" in wrong["shear", "kernel:liggghts"].why
    assert wrong["shear", "kernel:liggghts"].deviation == pytest.approx(1e-9, rel=1e-3)
    assert wrong["shear", "kernel:liggghts"].tolerance == TOLERANCE
    assert wrong["shear", "kernel:liggghts"].why.endswith("rerun: again")


def test_the_plain_frame_is_held_against_the_closed_form(reaction):
    plain = PLACE.tracks_of("load")[0]
    checks = judged(with_force(reaction, plain, lambda f: f + 1e-9), {reaction.part: reaction})
    assert checks["load", CLOSED_FORM].verdict == "differs"


def test_one_number_that_is_none_is_a_difference(reaction):
    track = PLACE.tracks_of("roll")[1]

    def spoilt(force):
        force = force.copy()
        force[7] = np.nan
        return force

    checks = judged(with_force(reaction, track, spoilt), {reaction.part: reaction})
    assert checks["roll", "kernel:liggghts"].verdict == "differs"
    assert checks["roll", PLAIN_FRAME].verdict == "differs"


def test_without_a_kernel_nothing_is_passed(reaction):
    checks = judged(reaction, {})
    assert {c.verdict for (_, right), c in checks.items() if right == "kernel:liggghts"} == {"not_checked"}
    assert checks["load", CLOSED_FORM].verdict == "agrees"


def test_an_allowance_holds_for_its_engine_and_says_why(reaction):
    own = replace(LAWS, allowances=CASES["hertz+mindlin"].allowances)
    track = PLACE.tracks_of("shear")[3]
    nearly = with_force(reaction, track, lambda f: f * (1 + 5e-12))
    check = judged(nearly, {reaction.part: reaction}, laws=own)["shear", "kernel:liggghts"]
    assert check.verdict == "agrees"
    assert check.why.endswith(own.allowances["liggghts"].reason)
    assert judged(nearly, {reaction.part: reaction})["shear", "kernel:liggghts"].verdict == "differs"


def test_a_known_dependence_explains_its_size_and_no_more(reaction):
    track = next(t for t in PLACE.tracks_of("load_shear") if t.frame.name == "turning")
    rule = known_dependence(LAWS, "liggghts", "load_shear", "turning")
    assert judged(reaction, {})["load_shear", PLAIN_FRAME].verdict == "known_difference"
    worst = judged(with_force(reaction, track, lambda f: 1.1 * f), {})["load_shear", PLAIN_FRAME]
    assert (worst.verdict, worst.tolerance) == ("differs", rule.limit)


def test_rules_are_about_what_they_name():
    assert known_dependence(CASES["linear"], "lammps", "shear", "turning") is None
    assert known_dependence(LAWS, "lammps", "shear", "turned") is None
    assert known_dependence(LAWS, "lammps", "shear", "turning") is not None
    assert known_dependence(LAWS, "yade", "shear", "turning") is None
    assert known_dependence(LAWS, "talk", "load_shear", "turning") is None
