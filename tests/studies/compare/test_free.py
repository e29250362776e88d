"""The judgement of free scenes: agreements, what is missing, and wrong runs caught by name."""

from pathlib import Path

import numpy as np
import pytest

from harness.scene.load import load_scene
from harness.scene.resolve import resolve
from harness.studies.compare.free import agreement_checks, judge_free
from harness.studies.compare.pairs import Pair
from harness.studies.verdict import Rerun, failed

RERUN = Rerun(scene_file=Path("flight.toml"), out=Path("out"), packings=None)


@pytest.fixture
def scene(flight):
    return load_scene(flight)


@pytest.fixture
def true(flight, scene, obedient):
    system = resolve(scene, flight)
    return obedient("a").read(flight.parent, system)


@pytest.fixture
def judge(flight, scene, finished):
    system = resolve(scene, flight)

    def judged(**runs):
        start = type("Start", (), {"number": 0, "system": system})
        return judge_free(scene, [start], [finished(e, 0, t) for e, t in runs.items()], list(runs), RERUN)

    return judged


def verdicts(checks, left="a"):
    return {c.quantity.split(",")[0]: c.verdict for c in checks if c.left == left}


def test_true_runs_agree(true, judge):
    checks, result = judge(a=true, b=true)
    assert verdicts(checks) == dict.fromkeys(("displacement", "velocity", "spin"), "agrees")
    assert [c.deviation for c in checks if c.left == "a"] == [0.0] * 3
    assert not failed(checks)
    assert result.exits["a"].velocity == pytest.approx(np.array([[0.3, 0.1], [-0.2, 0.0]]))


@pytest.mark.parametrize(("name", "quantity", "wrong"), [
    ("path doubled", "displacement", lambda t, m: m.column(t, "particles", "x", lambda x: 2 * x)),
    ("path mirrored", "displacement", lambda t, m: m.column(t, "particles", "x", lambda x: -x)),
    ("frames one late", "displacement", lambda t, m: m.shift(t, "particles")),
    ("bodies exchanged", "displacement", lambda t, m: m.column(t, "particles", "x", lambda x: x[::-1])),
    ("velocity of the other sign", "velocity", lambda t, m: m.column(t, "particles", "vx", lambda v: -v)),
    ("velocity a part in 10^8 off", "velocity", lambda t, m: m.column(t, "particles", "vy", lambda v: v + 3e-9)),
    ("spin of the other sign", "spin", lambda t, m: m.column(t, "particles", "wz", lambda w: -w)),
    ("spin lost", "spin", lambda t, m: m.column(t, "particles", "wz", lambda w: 0 * w)),
    ("spin no number", "spin", lambda t, m: m.column(t, "particles", "wz", lambda w: w * np.nan)),
    ("place no number", "displacement", lambda t, m: m.column(t, "particles", "y", lambda y: y * np.nan)),
])
def test_wrong_runs_are_caught_by_a_named_check(true, judge, mutate, name, quantity, wrong):
    for runs in ({"a": wrong(true, mutate), "b": true}, {"a": true, "b": wrong(true, mutate)}):
        checks, _ = judge(**runs)
        assert verdicts(checks)[quantity] == "differs"
        assert failed(checks)
        (check,) = [c for c in checks if c.verdict == "differs"]
        assert check.why.endswith("rerun: grainproof compare flight.toml --engines a,b --out out")


def test_what_is_zero_in_both_is_not_checked(true, judge, mutate):
    flat = mutate.column(true, "particles", "wz", lambda w: 0 * w)
    checks, _ = judge(a=flat, b=flat)
    assert verdicts(checks)["spin"] == "not_checked"
    assert not failed(checks)


def test_a_missing_run_and_a_declaration_without_a_pair_are_not_checked(true, judge):
    checks, result = judge(a=true, b=None)
    assert [(c.verdict, c.why) for c in checks if c.left == "a"] == [("not_checked", "no completed run of b")]
    (other,) = [c for c in checks if c.left == "-"]
    assert "declared for same_conventions" in other.why
    assert failed(checks)
    assert result.growth == {}


def test_an_agreement_can_ask_for_bit_equality_of_a_kernel(scene, true, mutate):
    """One unit in the last place of a velocity is 1e-16: within 1e-12, which any formula error exceeds."""
    pair = Pair(left="a", right="kernel:a", kind="same_conventions")
    last_bit = mutate.column(true, "particles", "vx", lambda v: np.nextafter(v, 9))
    checks = agreement_checks([pair], scene.compare.agreements, {"a": true, "kernel:a": last_bit}, RERUN)
    velocity = next(c for c in checks if c.quantity.startswith("velocity"))
    assert velocity.verdict == "agrees"
    assert 0 < velocity.deviation < 1e-15
