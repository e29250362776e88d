"""An advice put to the test: verdicts on numbers made up, what is run, and a small box from its study to a verdict."""

import dataclasses
import math
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

from harness.engines.registry import find_engine
from harness.errors import InputError
from harness.report.accuracy_bulk import write_bulk
from harness.report.advise_expected import verification_announcement
from harness.scene.load import load_scene
from harness.studies.accuracy.asked import BOX, Asked
from harness.studies.accuracy.bulk import bulk_accuracy
from harness.studies.accuracy.bulk_result import Rung as Ran
from harness.studies.accuracy.shaken import Shaking, why_shaken
from harness.studies.advise import advise, read_evidence
from harness.studies.advise import verify as module
from harness.studies.advise.verification import difference_of, mean_and_error, multiple_of, verdict_of
from harness.studies.advise.verify import (
    ADVISED,
    REFERENCE,
    engine_for,
    packing_count,
    reference_of,
    settings_of,
    verified_packings,
    verify,
)
from harness.studies.statistics.difference import Difference

FILE = Path(__file__).resolve().parents[3] / "inputs" / "scenes" / "biaxial_quick.toml"
SCALE = 25.0
T_2 = 2.9199855803537260
"""Student's one-sided 95 % point of two degrees of freedom."""

DT = {0.06: (0.02, 0.0, 7.5), 0.045: (0.015, 0.0, 10.0), 0.03: (0.01, 0.0, 15.0), 0.015: (0.005, 0.0, 30.0)}
STIFFNESS = {1 / 16: (-0.16, 0.0, 2.5), 1 / 4: (-0.04, 0.0, 5.0), 1.0: (-0.01, 0.0, 10.0)}
"""As in test_advise; the first step is beyond the stability limit of the scene."""


def advised(study, tolerance, effects=False):
    folder = study.write()
    evidence = read_evidence(
        load_scene(FILE), FILE, quantity="friction_angle", folder=folder, effects=folder if effects else None,
        tolerance=tolerance,
    )
    return advise(evidence, tolerance)


def column(*values):
    return np.array(values, float)[:, None]


# --- verdicts --------------------------------------------------------------------------------------------


def test_students_point_of_two_degrees_of_freedom():
    """t = (2 p - 1) sqrt(2/(4 p (1 - p))) for nu = 2, p = 0.95."""
    p = 0.95
    assert multiple_of(2) == pytest.approx((2 * p - 1) * math.sqrt(2 / (4 * p * (1 - p))), rel=1e-12)
    assert multiple_of(2) == pytest.approx(T_2, rel=1e-9)


@pytest.mark.parametrize(("size", "tolerance", "verdict"), [
    (0.01, 0.01 + 1.001 * T_2 * 0.01, "agrees"), (0.01, 0.01 + 0.999 * T_2 * 0.01, "inconclusive"),
    (-0.01, 0.01 + 1.001 * T_2 * 0.01, "agrees"), (0.1, 0.1 - 0.999 * T_2 * 0.01, "inconclusive"),
    (0.1, 0.1 - 1.001 * T_2 * 0.01, "differs"), (-0.1, 0.1 - 1.001 * T_2 * 0.01, "differs"),
])
def test_the_bar_is_a_multiple_of_the_standard_error(size, tolerance, verdict):
    found = Difference(value=size, error=0.01, dof=2.0, count=3, paired=True)
    said, why, needed = verdict_of(found, tolerance, "packings")
    assert said == verdict
    assert "2.92 standard errors" in why
    assert (needed is not None) == (verdict == "inconclusive")
    if needed:
        assert needed > 3
        assert f"about {needed} packings would" in why


def test_what_packings_share_cancels():
    """Differences of 0.5, 0.25, 0 over 25: mean 1 %, standard error 0.25/sqrt(3)/25."""
    found = difference_of(column(20.5, 30.25, 40.0), column(20.0, 30.0, 40.0), SCALE, paired=True)
    assert found.value == pytest.approx(0.01)
    assert found.error == pytest.approx(0.25 / math.sqrt(3) / SCALE)
    assert (found.dof, found.count, found.paired) == (2.0, 3, True)


def test_other_packings_are_two_samples():
    """Samples {0, 2} and {0, 4, 8}: variances 2 and 16, so that error^2 = 2/2 + 16/3."""
    found = difference_of(column(0.0, 2.0), column(0.0, 4.0, 8.0), 1.0, paired=False)
    assert found.value == pytest.approx(-3.0)
    assert found.error == pytest.approx(math.sqrt(1.0 + 16.0 / 3.0))
    assert found.dof == pytest.approx((1.0 + 16.0 / 3.0) ** 2 / (1.0 / 1.0 + (16.0 / 3.0) ** 2 / 2.0))


def test_a_curve_counts_by_its_rms():
    a, b = np.array([[3.0, -4.0], [3.0, -4.0]]), np.zeros((2, 2))
    found = difference_of(a, b, 2.0, paired=True)
    assert found.value == pytest.approx(math.sqrt(12.5) / 2.0)
    assert found.error == 0.0


def test_a_packing_without_a_value_is_left_out_on_both_sides():
    a, b = column(1.0, math.nan, 3.0, 5.0), column(0.0, 0.0, math.nan, 4.0)
    found = difference_of(a, b, 1.0, paired=True)
    assert (found.value, found.count) == (1.0, 2)
    assert difference_of(a[:3], b[:3], 1.0, paired=True) is None
    assert mean_and_error(column(math.nan, 2.0)) == (None, None)
    assert mean_and_error(column(1.0, 3.0)) == pytest.approx((2.0, 1.0))


# --- what is run -----------------------------------------------------------------------------------------


def test_the_reference_has_all_knobs_at_their_finest(study):
    advice = advised(study({"dt": DT, "stiffness": STIFFNESS}), 0.2)
    assert {k: r.value for k, r in advice.choice.rungs.items()} == {"dt": 0.045, "stiffness": 1 / 16}
    advised_one, finest = settings_of(advice)
    scene = load_scene(FILE)
    assert advised_one.scene.numerics.dt_fraction == 0.045
    assert advised_one.scene.contact.normal.normal_stiffness == scene.contact.normal.normal_stiffness / 16
    assert finest.scene.numerics.dt_fraction == 0.015
    assert finest.scene.contact == scene.contact
    assert reference_of(advice).seconds == pytest.approx(10.0 * 3.0 * 1.0)
    assert reference_of(advice).total.of_knobs == pytest.approx(0.005 + 0.01)


def test_no_step_that_scenes_refuse_is_a_reference(study):
    """One rung is good and can be run: there is nothing finer, although 0.06 was measured."""
    made = study({"dt": {0.06: (0.001, 0.0, 7.5), 0.045: (0.015, 0.0, 10.0)}}, largest=0.0536)
    (only,) = settings_of(advised(made, 0.05))
    assert only.scene.numerics.dt_fraction == 0.045


def test_effects_that_may_go_are_on_in_the_reference(study):
    go = {"names": ["damping attraction"], "change": 0.5, "error": 0.01, "saved": {"lammps": 0.2}}
    advice = advised(study({"dt": {0.045: (0.01, 0.0, 10.0)}}, effects=go), 0.02, effects=True)
    advised_one, finest = settings_of(advice)
    assert advised_one.scene.contact.normal.attraction == "clipped"
    assert finest.scene.contact.normal.attraction == "allowed"


def test_a_rung_that_was_not_run_is_the_same_in_both(study):
    advice = advised(study({"dt": DT, "stiffness": STIFFNESS}), 0.0145)
    assert advice.choice.extrapolated
    reference = reference_of(advice)
    for knob, rung in advice.choice.rungs.items():
        assert reference.rungs[knob].x <= rung.x
    assert any(reference.rungs[k] == advice.choice.rungs[k] for k in advice.choice.extrapolated)


def test_packings_are_those_of_the_advice_and_two_at_least(study):
    assert packing_count(advised(study({"dt": DT}), 0.05), None) == 2
    advice = advised(study({"dt": {0.03: (0.01, 0.0, 15.0)}}, spread=0.1), 0.05)
    assert packing_count(advice, None) == advice.choice.packings == 7
    assert packing_count(advice, 3) == 3


@pytest.mark.parametrize(("asked", "free", "says"), [
    (1, False, "--verify: expected a number of packings from 2 to 1000, got 1"),
    (1001, False, "--verify: expected a number of packings from 2 to 1000, got 1001"),
    (4, True, "--verify: expected no number for this kind of scene, got 4; it has as many phases"),
])
def test_numbers_that_cannot_be_are_refused(asked, free, says):
    with pytest.raises(InputError) as error:
        verified_packings(asked, free=free)
    assert says in str(error.value)
    assert "\n" not in str(error.value)


def test_engines_are_found_by_the_name_that_studies_give_them():
    assert engine_for("kernel:talk", None).name == "kernel:talk"
    assert engine_for("kernel:talk", ["lammps", "kernel:talk"]).name == "kernel:talk"
    with pytest.raises(InputError):
        engine_for("lammps@1999", None)


def test_what_several_knobs_may_do_by_physics_is_divided_out_together():
    """Eight times as fast and a quarter as stiff: energies of 8 * 4 times 9 are believed, of 8 * 4 times 11 not."""
    still = [Shaking(balance=0.01, energy=f) for f in (1.0, 1.1, 0.9)]
    for factor, believed in ((9.0, True), (11.0, False)):
        hot = [dataclasses.replace(s, energy=s.energy * 32.0 * factor) for s in still]
        assert (why_shaken({"rate": 8.0, "stiffness": 4.0}, hot, still) == "") is believed


# --- made-up runs ----------------------------------------------------------------------------------------


@pytest.fixture
def runs(monkeypatch):
    """runs(advised=..., reference=...) makes `verify` find these rungs in place of runs."""

    def make(**rungs):
        by_label = {ADVISED: rungs["advised"], REFERENCE: rungs.get("reference")}
        monkeypatch.setattr(
            module, "pack_settings", lambda settings, *_, **__: SimpleNamespace(settings=tuple(settings), seconds=0.0)
        )
        monkeypatch.setattr(module, "run_settings", lambda *_, **__: {})
        monkeypatch.setattr(module, "measure_settings", lambda *_, **__: {})
        monkeypatch.setattr(module, "rung_of", lambda setting, *_: by_label[setting.label])
        monkeypatch.setattr(module, "why_shaken", lambda *_: rungs.get("shaken", ""))

    return make


def ran(*values, seconds=1.0, status="completed", reason="", particles=200):
    return Ran(
        knob="all knobs", value=0.0, x=0.0, label="", own=False, status=status, reason=reason, particles=particles,
        dt=1e-6, steps=1000, values={"friction_angle": column(*values)} if values else {}, seconds=seconds,
    )


def checked(study, tolerance=0.2, knobs=None, **words):
    advice = advised(study(knobs or {"dt": DT, "stiffness": STIFFNESS}, **words), tolerance)
    return verify(
        advice, find_engine("kernel:talk"), Path("nowhere"), packings=3, time_limit=1.0, workers=1, progress=None
    )


def test_a_difference_within_the_tolerance_agrees(study, runs):
    """-2, -3, -4 degrees of 25: -12 +- 2.3 %; times 2.92 it is 6.7 %, 18.7 % in all."""
    runs(advised=ran(23.0, 24.0, 25.0, seconds=3.0), reference=ran(25.0, 27.0, 29.0, seconds=40.0))
    found = checked(study)
    assert found.verdict == "agrees"
    assert found.difference.value == pytest.approx(-0.12)
    assert found.difference.error == pytest.approx(1.0 / math.sqrt(3.0) / SCALE)
    assert found.bar == pytest.approx(T_2 / math.sqrt(3.0) / SCALE)
    assert found.difference.paired
    assert (found.advised.mean, found.reference.mean) == (24.0, 27.0)
    assert found.time_ratio == pytest.approx(3.0 / 40.0)
    assert found.foretold_ratio == pytest.approx(2.5 / 30.0), "10 (2.5/10) over 10 (30/10)"
    assert found.expected == pytest.approx(0.015 + 0.16)
    assert found.remaining == pytest.approx(0.005 + 0.01)
    assert found.from_limit == pytest.approx(0.12 + found.bar + 0.015)
    assert found.exit_status == 0
    assert found.untested == ()


def test_a_difference_beyond_the_tolerance_differs(study, runs):
    runs(advised=ran(15.0, 17.0, 19.0), reference=ran(25.0, 27.0, 29.0))
    found = checked(study)
    assert (found.verdict, found.exit_status) == ("differs", 1)
    assert found.difference.value == pytest.approx(-0.4)


def test_what_scatters_too_much_says_how_many_would_tell(study, runs):
    runs(advised=ran(23.0, 30.0, 19.0), reference=ran(25.0, 27.0, 29.0))
    found = checked(study)
    assert (found.verdict, found.exit_status) == ("inconclusive", 0)
    assert found.needed > 3


def test_other_numbers_of_particles_are_not_paired(study, runs):
    runs(advised=ran(23.0, 24.0, 25.0, particles=100), reference=ran(25.0, 27.0, 29.0))
    found = checked(study, knobs={"size": {100.0: (0.02, 0.0, 5.0), 200.0: (0.01, 0.0, 10.0)}})
    assert not found.difference.paired
    assert found.difference.error == pytest.approx(math.sqrt((1.0 + 4.0) / 3.0) / SCALE)
    assert found.singly is found.together is None


@pytest.mark.parametrize(("side", "name"), [("advised", "advised"), ("reference", "reference")])
def test_a_failed_run_is_not_checked_and_said(study, runs, side, name):
    both = {"advised": ran(23.0, 24.0, 25.0), "reference": ran(25.0, 27.0, 29.0)}
    runs(**both | {side: ran(status="timed_out", reason="after 1 s", seconds=None)})
    found = checked(study)
    assert (found.verdict, found.difference, found.exit_status) == ("not_checked", None, 1)
    assert found.why == f"the {name} run is timed out: after 1 s"
    assert found.time_ratio is None


def test_a_shaken_sample_is_not_believed(study, runs, monkeypatch):
    one = {"advised": ran(23.0, 24.0, 25.0), "reference": ran(25.0, 27.0, 29.0)}
    runs(**one, shaken="opposite walls out of balance")
    found = checked(study)
    assert (found.verdict, found.advised.status) == ("not_checked", "unstable")
    assert found.why == "the advised run is unstable: opposite walls out of balance"
    assert found.advised.mean is None


def test_a_quantity_that_is_gone_is_not_checked(study, runs):
    runs(advised=ran(), reference=ran(25.0, 27.0, 29.0))
    found = checked(study)
    assert (found.verdict, found.why) == ("not_checked", "fewer than 2 packings have a friction_angle in both")


def test_the_finest_setting_is_held_against_nothing(study, runs):
    """Else it would agree with itself."""
    runs(advised=ran(23.0, 24.0, 25.0))
    found = checked(study, knobs={"dt": {0.045: (0.01, 0.0, 10.0)}}, tolerance=0.05)
    assert (found.verdict, found.reference, found.exit_status) == ("not_checked", None, 0)
    assert "nothing finer to hold it against" in found.why
    assert found.advised.mean == 24.0


def test_the_smallest_scale_of_the_ladders_measures(study, runs):
    runs(advised=ran(23.0, 24.0, 25.0), reference=ran(25.0, 27.0, 29.0))
    made = study({"dt": DT, "stiffness": STIFFNESS})
    rows = made._rows
    made._rows = lambda e, k: [r | {"scale": 20.0} if k == "stiffness" else r for r in rows(e, k)]
    found = checked(lambda *_, **__: made)
    assert found.scale == 20.0
    assert found.difference.value == pytest.approx(-3.0 / 20.0)
    assert found.over == (
        "20 deg, by which the ladder of stiffness measures its errors, the smallest such of the turned knobs (dt 25)"
    )


def test_what_knobs_do_to_each_other_is_what_their_ladders_do_not_say(study, runs):
    """Alone they change -1, -1 and -2, -4 degrees; together -5, -7: 2 more than their sum in both packings."""
    each = {("dt", 0.03): [24.0, 28.0], ("dt", 0.015): [25.0, 29.0],
            ("stiffness", 1 / 16): [23.0, 25.0], ("stiffness", 1.0): [25.0, 29.0]}
    runs(advised=ran(20.0, 22.0, 0.0), reference=ran(25.0, 29.0, 0.0))
    made = study({"dt": {f: DT[f] for f in (0.03, 0.015)}, "stiffness": STIFFNESS})
    made._each = lambda knob, value: each.get((knob, value), [0.0, 0.0])
    found = checked(lambda *_, **__: made)
    assert found.singly.value == pytest.approx(-4.0 / SCALE)
    assert found.singly.error == pytest.approx(1.0 / SCALE)
    assert found.together.value == pytest.approx(-2.0 / SCALE)
    assert found.together.error == pytest.approx(0.0, abs=1e-12)
    assert found.together.count == 2, "the third packing is not in the study"
    assert found.joint
    assert found.knobs_act


def test_rungs_of_the_ladders_tell_nothing_of_several_knobs(study, runs):
    """The advised setting turns the stiffness alone, the reference the step alone: the sum is the difference itself."""
    runs(advised=ran(20.0, 22.0, 0.0), reference=ran(25.0, 29.0, 0.0))
    found = checked(study)
    assert not found.joint
    assert found.together is None
    assert not found.knobs_act
    assert found.difference is not None


# --- a small box -----------------------------------------------------------------------------------------

SMALLER = {
    "count = 200 ": "count = 25 ", "normal_stiffness = 1e5": "normal_stiffness = 1e4",
    "normal_damping = 0.5": "normal_damping = 0.158", "shear_stiffness = 2e4": "shear_stiffness = 2e3",
    "shear_damping = 0.125": "shear_damping = 0.04", "duration = 0.06 ": "duration = 0.004 ",
    "samples = 500": "samples = 100", "final_strain = 0.10": "final_strain = 0.05",
    "0.05, 0.1]": "0.05]", "plateau = [0.05, 0.10]": "plateau = [0.02, 0.05]",
}


def asked(knob, value):
    return Asked(knob=BOX[knob], values=(value, 1.0), quantity="volume_strain")


def test_a_box_from_its_study_to_a_verdict(tmp_path):
    """Two knobs, two packings; the reference is the scene as declared, whose runs the study has left behind."""
    text = FILE.read_text()
    for old, new in SMALLER.items():
        assert old in text, old
        text = text.replace(old, new)
    file, out = tmp_path / "box.toml", tmp_path / "out"
    file.write_text(text)
    scene, options = load_scene(file), {"time_limit": 60.0, "workers": 2, "progress": None}
    done = bulk_accuracy(
        scene, file, (asked("rate", 1.5), asked("stiffness", 0.5)), out, engines=["kernel:talk"], packings=2, **options
    )
    write_bulk(done, out)
    evidence = read_evidence(scene, file, quantity=None, folder=out, effects=None, tolerance=3.0)
    advice = advise(evidence, 3.0)
    assert {k: r.value for k, r in advice.choice.rungs.items()} == {"stiffness": 0.5, "rate": 1.5}
    kernel = find_engine("kernel:talk")
    assert "4 runs and 2 packings" in verification_announcement(advice, kernel, packings=None, workers=1)
    before = {f: f.stat().st_mtime_ns for f in out.glob("runs/*/outcome.json")}
    found = verify(advice, kernel, out, packings=None, **options)
    after = {f: f.stat().st_mtime_ns for f in out.glob("runs/*/outcome.json")}
    assert {f: after[f] for f in before} == before
    assert len(after) == len(before) + 2, "the advised scene alone is run, on two packings"
    own = next(r for r in done.ladders[0].rungs if r.own)
    assert np.array_equal(found.reference.values, own.values["volume_strain"])
    assert found.reference.seconds == own.seconds
    apart = found.advised.values - found.reference.values
    assert np.abs(apart).min() > 0.0
    assert found.difference.value == pytest.approx(apart.mean() / 0.05)
    assert found.scale == 0.05
    assert found.verdict == "agrees"
    alone = sum(
        next(r for r in la.rungs if not r.own).values["volume_strain"] - own.values["volume_strain"]
        for la in done.ladders
    )
    assert found.singly.value == pytest.approx(alone.mean() / 0.05)
    assert found.together.value == pytest.approx((apart - alone).mean() / 0.05)
    again = verify(dataclasses.replace(advice, tolerance=1e-4), kernel, out, packings=None, **options)
    assert {f: f.stat().st_mtime_ns for f in out.glob("runs/*/outcome.json")} == after
    assert again.difference == found.difference
    assert again.verdict in ("differs", "inconclusive")
