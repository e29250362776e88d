"""The judgement of free scenes: agreements, what is missing, and wrong runs caught by name."""

from pathlib import Path

import numpy as np
import pytest

from harness.scene.load import load_scene
from harness.scene.resolve import resolve
from harness.studies.compare.finest import finest_differences
from harness.studies.compare.free import agreement_checks, judge_free
from harness.studies.compare.pairs import Pair
from harness.studies.verdict import Rerun, failed

SCENES = Path(__file__).resolve().parents[3] / "inputs" / "scenes"
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
    assert result.exits["a"].velocity == pytest.approx(np.array([[0.3, 0.09], [-0.2, -0.01]]))


@pytest.mark.parametrize(("name", "quantity", "wrong"), [
    ("path doubled", "displacement", lambda t, m: m.column(t, "particles", "x", lambda x: 2 * x)),
    ("path mirrored", "displacement", lambda t, m: m.column(t, "particles", "x", lambda x: -x)),
    ("frames one late", "displacement velocity spin", lambda t, m: m.shift(t, "particles")),
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
        assert failed(checks)
        wrong_ones = [c for c in checks if c.verdict == "differs"]
        assert [c.quantity.split(",")[0] for c in wrong_ones] == quantity.split()
        rerun = "rerun: grainproof compare flight.toml --engines a,b --out out"
        assert all(c.why.endswith(rerun) for c in wrong_ones)


def test_what_is_zero_in_both_is_not_checked(true, judge, mutate):
    flat = mutate.column(true, "particles", "wz", lambda w: 0 * w)
    checks, _ = judge(a=flat, b=flat)
    assert verdicts(checks)["spin"] == "not_checked"
    assert not failed(checks)


@pytest.fixture
def calm(flight, scene, obedient, judge):
    """calm(off=1e-6) judges the scene without gravity, the second run's velocities off by that."""

    def judged(*, off=0.0):
        flight.write_text(flight.read_text().replace("gravity = [0.0, -10.0]\n", ""))
        system = resolve(load_scene(flight), flight)
        a, b = (obedient(name, off=o).read(flight.parent, system) for name, o in (("a", 0.0), ("b", off)))
        return judge(a=a, b=b)[0]

    return judged


def test_free_flight_is_no_agreement(calm):
    checks = [c for c in calm() if c.left == "a"]
    assert {c.verdict for c in checks} == {"not_checked"}
    assert [c.why.split(" changes")[0] for c in checks] == [
        "no body's velocity", "no body's velocity", "no body's spin",
    ]
    assert failed(checks)


def test_free_flight_that_differs_differs(calm):
    checks = calm(off=1e-6)
    assert verdicts(checks) == {"displacement": "differs", "velocity": "differs", "spin": "not_checked"}


def test_numbers_that_are_rounding_are_not_compared(true, judge, flight, scene, mutate):
    """A hundred per cent of 1e-15 rad/s, of 1e-15 m/s: rounding; of ten times the finest difference: differs."""
    finest = finest_differences(scene, resolve(scene, flight))
    for quantity, columns in {"velocity": ("vx", "vy"), "spin": ("wz",)}.items():
        for size, verdict in ((0.3, "not_checked"), (10.0, "differs")):
            value = size * finest[quantity].value

            def small(sign, columns=columns, value=value):
                t = true
                for c in columns:
                    t = mutate.column(t, "particles", c, lambda v: 0 * v + sign * value)
                return t

            checks, _ = judge(a=small(1.0), b=small(-1.0))
            (check,) = [c for c in checks if c.quantity.startswith(quantity) and c.left == "a"]
            assert check.verdict == verdict
            assert ("rounding in this scene: nothing to compare" in check.why) == (verdict == "not_checked")


def test_the_finest_differences_follow_from_places_and_stiffness(flight, scene):
    """5 mm from the origin, half a period of pi sqrt(m*/k) but for damping, radius 1 mm."""
    found = finest_differences(scene, resolve(scene, flight))
    assert found["displacement"].value == pytest.approx(2**-51 * 5e-3)
    frequency = np.sqrt(1e5 / 0.5e-5)
    assert found["velocity"].value == pytest.approx(frequency * 2**-51 * 5e-3, rel=0.05)
    assert found["spin"].value == pytest.approx(found["velocity"].value / 1e-3)


def test_no_shipped_tolerance_is_wider_for_it():
    """Of what moves as fast as its scene lets it: the rounding is below the declared tolerance."""
    for file in (SCENES / f"{name}.toml" for name in ("head_on", "oblique", "hertz_impact", "rolling_incline")):
        shipped = load_scene(file)
        system = resolve(shipped, file)
        speed = max(np.abs(system.particles.v).max(), 0.03)  # the sphere on the incline ends with 0.04 m/s
        strictest = min(a.tolerance for a in shipped.compare.agreements)
        assert finest_differences(shipped, system)["velocity"].value < strictest * speed


def test_a_missing_run_and_a_declaration_without_a_pair_are_not_checked(true, judge):
    checks, result = judge(a=true, b=None)
    assert [(c.verdict, c.why) for c in checks if c.left == "a"] == [("not_checked", "no completed run of b")]
    (other,) = [c for c in checks if c.left == "-"]
    assert "declared for same_conventions" in other.why
    assert failed(checks)
    assert result.growth == {}


def test_an_agreement_can_ask_for_bit_equality_of_a_kernel(flight, scene, true, mutate):
    """One unit in the last place of a velocity is 1e-16: within 1e-12, which any formula error exceeds."""
    pair = Pair(left="a", right="kernel:a", kind="same_conventions")
    last_bit = mutate.column(true, "particles", "vx", lambda v: np.nextafter(v, 9))
    finest = finest_differences(scene, resolve(scene, flight))
    checks = agreement_checks([pair], scene.compare.agreements, {"a": true, "kernel:a": last_bit}, finest, RERUN)
    velocity = next(c for c in checks if c.quantity.startswith("velocity"))
    assert velocity.verdict == "agrees"
    assert 0 < velocity.deviation < 1e-15
