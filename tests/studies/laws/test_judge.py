"""The judge: what it finds, where it says it was, and what it never passes."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from harness.engines.protocol import Reaction
from harness.studies.laws.arrangement import arrangement
from harness.studies.laws.cases import CASES, TOLERANCE
from harness.studies.laws.drive import Driver, Job
from harness.studies.laws.invariance import FRAME_TOLERANCE, known_dependences
from harness.studies.laws.judge import CLOSED_FORM, PLAIN_FRAME, STEPPED, judge_engine

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
    assert checks["mixed", STEPPED].verdict == "agrees"
    assert 0.0 < checks["mixed", STEPPED].deviation < 1e-13
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


def frame_checks(done, convention="liggghts", laws=LAWS, motion="load_shear"):
    checks = judge_engine(laws, f"kernel:{convention}", {done.part: done}, {}, "again")
    return [c for c in checks if c.right == PLAIN_FRAME and c.quantity.endswith(f": {motion}")]


def test_a_known_dependence_is_predicted_row_by_row_and_explains_no_more(reaction):
    """LIGGGHTS' springs lose a cosine a row: how much that is, is known, and nothing else is passed for it."""
    (known,) = [c for c in frame_checks(reaction) if c.reason]
    assert known.verdict == "known_difference"
    assert known.predicted
    assert known.deviation == pytest.approx(known.tolerance, abs=1e-12)
    assert 1e-4 < known.tolerance < 3e-4
    assert known.off < 1e-13
    track = next(t for t in PLACE.tracks_of("load_shear") if t.frame.name == "turning")
    for change in (lambda f: 1.1 * f, lambda f: f * (1 + 1e-9), lambda f: f * (np.arange(len(f)) != 60)[:, None]):
        (wrong,) = [c for c in frame_checks(with_force(reaction, track, change)) if c.reason]
        assert wrong.verdict == "differs"
        assert wrong.off > FRAME_TOLERANCE
        assert wrong.why.endswith("rerun: again")


def test_an_answer_that_does_not_depend_on_the_frame_where_it_should_is_wrong(reaction):
    """The prediction holds both ways: the plain frame's answer in a turning one is not that convention's."""
    tracks = {t.frame.name: t for t in PLACE.tracks_of("load_shear")}
    plain, turning = tracks["plain"], tracks["turning"]
    own = plain.local(reaction.reaction)[0][:, 0, :]
    turned = np.einsum("kab,kb->ka", turning.frame.axes[1:], own)[:, :2]
    copied = with_force(reaction, turning, lambda _: turned)
    checks = judge_engine(LAWS, "kernel:liggghts", {copied.part: copied}, {}, "again")
    (one,) = [c for c in checks if getattr(c, "reason", "") and c.quantity.endswith("load_shear")]
    assert one.verdict == "differs"


def test_frames_are_judged_by_dimension(reaction):
    assert {c.dimension for c in frame_checks(reaction, motion="shear")} == {2}


def test_rules_are_about_what_they_name():
    assert known_dependences(CASES["linear"], "lammps", "shear", "turning") == ()
    assert known_dependences(LAWS, "lammps", "shear", "turned") == ()
    assert len(known_dependences(LAWS, "lammps", "shear", "turning")) == 1
    assert len(known_dependences(LAWS, "lammps", "mixed", "turning")) == 2
    assert known_dependences(LAWS, "talk", "load_shear", "turning") == ()


@pytest.fixture(scope="module")
def talk(tmp_path_factory):
    """Of the kernel in the talk's convention, whose springs stay at the limit once they slide."""
    from harness.engines.registry import ENGINES

    driver = Driver(root=tmp_path_factory.mktemp("runs"), time_limit=60.0, workers=1)
    return driver.drive(Job(laws=LAWS, engine=ENGINES["kernel:talk"], arrangement=PLACE))


def test_what_rounding_decides_is_bounded_where_it_decides_and_nowhere_else(talk):
    track = next(t for t in PLACE.tracks_of("shear") if t.frame.name == "mirrored")

    def bounded(done):
        return [c for c in frame_checks(done, "talk", motion="shear") if c.reason]

    def slipping(factor):
        """The friction of rows 180 to 200, which slip back, times a factor; the last component in 2D is t."""
        rows = np.ones((len(PLACE.path.x) - 1, 2))
        rows[180:200, 1] = factor
        return with_force(talk, track, lambda f: rows * f)

    assert all(c.verdict == "known_difference" and not c.predicted for c in bounded(talk))
    assert [c.verdict for c in bounded(slipping(0.5))] == ["known_difference"]
    assert [c.verdict for c in bounded(slipping(-4.0))] == ["differs"]
    early = np.ones((len(PLACE.path.x) - 1, 1))
    early[60] = 1.0 + 1e-6
    assert "differs" in [c.verdict for c in bounded(with_force(talk, track, lambda f: early * f))]


def test_an_engine_of_unknown_conventions_must_not_depend_on_the_frame_at_all(reaction):
    checks = judge_engine(LAWS, "yade", {reaction.part: named(reaction, "yade")}, {}, "again")
    assert "known_difference" not in {c.verdict for c in checks}
    assert "differs" in {c.verdict for c in checks if c.right == PLAIN_FRAME}


def test_reasons_are_shown_once_with_what_they_expect(reaction, talk):
    from harness.report.law_tables import frame_rows, short_frame_rows

    checks = [*judge_engine(LAWS, "kernel:liggghts", {reaction.part: reaction}, {}, "again"),
              *judge_engine(LAWS, "kernel:talk", {talk.part: talk}, {}, "again")]
    rows = short_frame_rows(SimpleNamespace(checks=checks))
    assert {r["engines"] for r in rows} == {"kernel:liggghts", "kernel:talk"}
    assert [r["expected"].startswith("at most ") for r in rows] == [r["engines"] == "kernel:talk" for r in rows]
    assert all(r["off that"] <= FRAME_TOLERANCE for r in rows)
    apart = frame_rows(SimpleNamespace(checks=checks))
    by_engine = {r["engine"]: r["the reason"] for r in apart}
    assert by_engine == {"kernel:liggghts": "predicts", "kernel:talk": "allows"}
