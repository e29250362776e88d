"""Advice on a free scene: errors are rms over phases, whose standard error counts; and a check by a run of its own."""

import json
import math
from functools import partial
from pathlib import Path

import msgspec
import numpy as np
import pytest

from harness.engines.registry import find_engine
from harness.errors import InputError
from harness.report.advise_expected import verification_announcement
from harness.report.advise_tables import sum_rows
from harness.report.advise_words import limits, paragraph
from harness.scene.grains import grains_of
from harness.scene.load import load_scene
from harness.scene.numerics import plan_steps, requested_step
from harness.scene.resolve import resolve
from harness.scene.write import write_scene
from harness.studies.accuracy import accuracy, cost, steps
from harness.studies.accuracy.phases import delays
from harness.studies.advise import advise, read_evidence
from harness.studies.advise.files import FREE_SCHEMA
from harness.studies.advise.free_ladders import rms_error
from harness.studies.advise.verification import multiple_of
from harness.studies.advise.verify import verify
from harness.studies.advise.verify_free import OTHER, free_case

FILE = Path(__file__).resolve().parents[3] / "inputs" / "scenes" / "oblique_impact.toml"
BEYOND = "beyond the scene's limit of"
EVEN, UNEVEN = (1.0, 1.0, 1.0, 1.0), (0.1, 0.1, 0.1, 1.99)
"""Errors of four phases over their rms, nearly the same rms."""


def study(folder, spread, engines=("lammps",)):
    """error = f/4, 1 ms a step at f = 0.01; one rung of 0.64 that went wrong."""
    values = (0.16, 0.08, 0.04, 0.02, 0.01)
    points = [
        {"case": "as declared", "engine": e, "rung": f, "dt_fraction": f, "exit": f / 4, "velocity": None,
         "CPU (ms)": 0.01 / f, "status": "completed", BEYOND: None}
        for e in engines for f in values
    ]
    wild = {"rung": 0.64, "dt_fraction": 0.64, BEYOND: 0.245, "exit": None, "status": "unstable", "CPU (ms)": None}
    points.insert(0, points[0] | wild)
    data = {
        "schema": FREE_SCHEMA, "scene": msgspec.to_builtins(load_scene(FILE)), "quantity": "exit", "phases": 4,
        "knob": "dt",
        "errors": [{"case": "as declared", "engine": e, "dt_fraction": f, "exit": [f / 4 * s for s in spread]}
                   for e in engines for f in values],
        "tables": {
            "points": points,
            "slopes": [{"case": "as declared", "engine": e, "quantity": "exit", "slope": 1.0} for e in engines],
            "oracles": [{"case": "as declared", "engine": e, "its error": 1e-9} for e in engines],
        },
    }
    (folder / "accuracy.json").write_text(json.dumps(data))
    return folder


def advised(folder, tolerance):
    scene = load_scene(FILE)
    evidence = read_evidence(scene, FILE, quantity=None, folder=folder, effects=None, tolerance=tolerance)
    return advise(evidence, tolerance)


def test_the_coarsest_step_that_does(tmp_path):
    advice = advised(study(tmp_path, EVEN), 0.011)
    assert advice.choice.rungs["dt"].value == 0.04
    assert math.isclose(advice.choice.total.error(1), 0.01, rel_tol=1e-6)
    assert math.isclose(advice.choice.seconds, 0.25e-3)
    assert "free" not in advice.evidence.absent
    assert "not turned in this kind of scene" in advice.evidence.absent["rate"]
    assert advice.evidence.ladders["lammps"]["dt"].failed == ("0.64: unstable",)


def rewritten(folder, change):
    """The study's file with something else in it."""
    place = folder / "accuracy.json"
    data = json.loads(place.read_text())
    change(data)
    place.write_text(json.dumps(data))
    return folder


def pop(*path):
    def change(data):
        for key in path[:-1]:
            data = data[key]
        del data[path[-1]]
    return change


def put(value, *path):
    def change(data):
        for key in path[:-1]:
            data = data[key]
        data[path[-1]] = value
    return change


@pytest.mark.parametrize("change", [
    pop("schema"), pop("tables"), pop("tables", "points"), pop("tables", "slopes"), pop("tables", "oracles"),
    pop("errors"), pop("quantity"), pop("phases"), pop("scene"), pop("tables", "points", 1, "exit"),
    put([], "tables", "points"), put("fast", "tables", "points", 1, "CPU (ms)"),
    put(-1.0, "tables", "points", 1, "exit"), put(-1.0, "tables", "points", 1, "CPU (ms)"), put(None, "tables"),
    put([], "errors"), put("heat", "quantity"), put([], "tables", "oracles"),
])
def test_a_damaged_file_is_refused_in_one_line(tmp_path, change):
    folder = rewritten(study(tmp_path, EVEN), change)
    with pytest.raises(InputError, match="accuracy.json: expected a finished grainproof accuracy, got a") as error:
        advised(folder, 0.011)
    assert "\n" not in str(error.value)


def test_the_step_that_ran_is_advised(tmp_path):
    """That of 0.16 ran as 0.152; the scene's own 0.01 as 0.0098, and is still its own."""
    ran = {0.16: 0.152, 0.01: 0.0098}

    def change(data):
        for row in (*data["tables"]["points"], *data["errors"]):
            row["dt_fraction"] = ran.get(row["dt_fraction"], row["dt_fraction"])

    advice = advised(rewritten(study(tmp_path, EVEN), change), 0.05)
    assert advice.choice.rungs["dt"].value == 0.152
    assert advice.scene.numerics.dt_fraction == 0.152
    assert advice.evidence.ladders["lammps"]["dt"].own.value == 0.0098


def test_refused_steps_are_named(tmp_path):
    """A good rung beyond the limit, and the one that is unstable anyway."""
    def change(data):
        extra = data["tables"]["points"][1] | {"rung": 0.32, "dt_fraction": 0.2885, BEYOND: 0.245, "exit": 0.01}
        data["tables"]["points"].append(extra)
        data["errors"].append(data["errors"][0] | {"dt_fraction": 0.2885, "exit": [0.01] * 4})

    advice = advised(rewritten(study(tmp_path, EVEN), change), 0.1)
    assert advice.choice.rungs["dt"].value == 0.16, "0.2885 is faster and near, and no scene may have it"
    assert any(s.startswith("dt 0.2885, 0.64: refused by `scene`, beyond its stability limit of 0.245")
               for s in limits(advice))


def test_a_free_scene_has_runs_and_no_packings(tmp_path):
    advice = advised(study(tmp_path, EVEN), 0.1)
    assert "packing" not in paragraph(advice)
    assert not [name for row in sum_rows(advice) for name in row if "packing" in name]


def test_too_few_phases_are_called_phases(tmp_path):
    """No error stands out of a noise of 1 %."""
    folder = study(tmp_path, EVEN)
    rewritten(folder, lambda data: data["tables"]["oracles"][0].update({"its error": 0.01}))
    advice = advised(folder, 0.0005)
    assert advice.choice is None
    words = paragraph(advice)
    assert "from 4 phases of the step; about" in words
    assert "packing" not in words
    assert advice.needed == pytest.approx(4 * (advice.best.total.noise / 0.0005) ** 2, abs=1.0)


def test_phases_that_differ_widen_the_error(tmp_path):
    even, uneven = (advised(study(tmp_path, s), 0.011).choice.rungs["dt"].value for s in (EVEN, UNEVEN))
    assert (even, uneven) == (0.04, 0.02)


def test_a_finer_step_is_foretold(tmp_path):
    rung = advised(study(tmp_path, EVEN), 0.0013).choice.rungs["dt"]
    assert (rung.origin, rung.value) == ("extrapolated", 0.005)


def test_standard_error_of_a_root_mean_square():
    """Against what samples of normal numbers scatter: rms of n has s/sqrt(2 n)."""
    rng = np.random.default_rng(5)
    samples = rng.normal(size=(4000, 50))
    told = np.mean([rms_error(list(s)) for s in samples[:300]])
    assert math.isclose(told, np.sqrt((samples**2).mean(axis=1)).std(), rel_tol=0.06)
    assert math.isinf(rms_error([1.0]))
    assert rms_error([0.0, 0.0]) == 0.0


# --- put to the test -------------------------------------------------------------------------------------


def verified(advice, out, monkeypatch):
    monkeypatch.setattr(steps, "measure_costs", partial(cost.measure_costs, repeats=1))
    return verify(
        advice, find_engine(advice.choice.engine), out, packings=None, time_limit=60.0, workers=1, progress=None
    )


def test_the_advised_step_is_held_against_the_oracle_at_other_phases(tmp_path, monkeypatch):
    """The leapfrog's error is about 0.29 f on this impact, which the made-up f/4 is near enough to."""
    advice = advised(study(tmp_path, EVEN, engines=("kernel:lammps",)), 0.0099)
    assert advice.choice.rungs["dt"].value == 0.02
    longest = 0.02 * free_case(advice).contact_time
    assert np.array_equal(free_case(advice).cases[0].phased[0].delay, delays(4, longest, OTHER))
    assert not np.equal(delays(4, longest, OTHER), delays(4, longest)).any()
    assert "2 runs" in verification_announcement(advice, find_engine("kernel:lammps"), packings=None, workers=1)
    assert free_case(advice).cases[0].values == (0.02, 0.01), "times are those of the finest rung, as in ladders"
    found = verified(advice, tmp_path, monkeypatch)
    errors = found.advised.values[:, 0]
    assert len(errors) == found.count == 4
    assert found.advised.mean == math.sqrt((errors**2).mean())
    assert 0.003 < found.advised.mean < 0.0085
    assert found.advised.error == pytest.approx(rms_error(list(errors)), rel=1e-6), "the oracle is known to 1e-9"
    assert found.bar == pytest.approx(multiple_of(3) * found.advised.error)
    assert (found.verdict, found.exit_status) == ("agrees", 0)
    assert found.reference is None
    assert found.time_ratio == pytest.approx(found.advised.seconds / advice.choice.seconds)
    assert found.remaining == 1e-9
    made = {f: f.stat().st_mtime_ns for part in ("runs", "oracles", "times") for f in (tmp_path / part).rglob("*.json")}
    assert verified(advice, tmp_path, monkeypatch).difference == found.difference
    assert {f: f.stat().st_mtime_ns for f in made} == made


def test_a_ladder_that_promises_too_much_is_found_out(tmp_path, monkeypatch):
    """The same with a tenth of the error that there is."""
    def change(data):
        for row in (*data["tables"]["points"], *data["errors"]):
            told = row["exit"]
            row["exit"] = [e / 10 for e in told] if isinstance(told, list) else told and told / 10

    advice = advised(rewritten(study(tmp_path, EVEN, engines=("kernel:lammps",)), change), 0.005)
    assert advice.choice.rungs["dt"].value == 0.16
    found = verified(advice, tmp_path, monkeypatch)
    assert (found.verdict, found.exit_status) == ("differs", 1)
    assert found.difference.value > 0.02
    assert found.expected == pytest.approx(0.004)


@pytest.mark.parametrize("tolerance", [0.045, 0.025, 0.012, 0.003])
def test_the_written_scene_makes_the_advised_step(tmp_path, tolerance):
    """Steps are rounded up to fit samples and frames: by no more than a twentieth, else it looks less often."""
    advice = advised(study(tmp_path, EVEN), tolerance)
    scene = advice.scene
    grains = grains_of(scene, resolve(scene, FILE).particles)
    plan = plan_steps(scene, grains)
    assert plan.steps <= 1.05 * math.ceil(scene.duration / requested_step(scene, grains))
    assert plan.steps % scene.outputs.samples == plan.steps % scene.outputs.frames == 0


def test_without_a_choice_the_time_is_that_of_all_phases_once(tmp_path):
    advice = advised(study(tmp_path, EVEN), 1e-9)
    assert advice.choice is None
    assert advice.packings == 1
    (row,) = sum_rows(advice)[:1]
    assert f"{1e3 * row['CPU of all phases (s)']:.2g} ms of CPU time for all 4 phases together" in paragraph(advice)


@pytest.mark.long
@pytest.mark.parametrize("tolerance", [0.05, 0.01, 0.002])
def test_the_advised_scene_keeps_the_tolerance_at_other_phases(tmp_path, tolerance):
    """Ladders of 12 phases, a check of 60: what was advised is run as its own study."""
    from harness.report.accuracy import write_accuracy

    done = accuracy(FILE, tmp_path, engines=["kernel:talk", "kernel:corrected"], phases=12)
    write_accuracy(done, tmp_path)
    advice = advised(tmp_path, tolerance)
    write_scene(advice.scene, FILE, tmp_path / "advised.toml")
    step = advice.scene.numerics.dt_fraction
    check = accuracy(
        tmp_path / "advised.toml", tmp_path / "check", engines=[advice.choice.engine], ladder=[step, step / 2],
        phases=60,
    )
    found = next(p for t in check.declared for p in t.points if p.rung == step).size("exit")
    assert found <= tolerance
    assert found >= 0.2 * advice.choice.total.error(1), "the expected error is one, and no mere bound"
