"""Advice on made-up ladders: the cheapest setting is known, and so is what must be said where there is none."""

import itertools
import json
import math

import pytest

from harness.errors import InputError
from harness.report.advise_tables import advice_rows, ladder_rows
from harness.report.advise_words import limits
from harness.scene.load import load_scene
from harness.scene.write import write_scene
from harness.studies.advise import advise, choose, read_evidence
from harness.studies.advise.combine import Part, Total, total
from harness.studies.advise.scene import Settings, can_run

SCALE = 25.0
"""Of the made-up quantity, see conftest."""

DT = {0.06: (0.02, 0.0, 7.5), 0.045: (0.015, 0.0, 10.0), 0.03: (0.01, 0.0, 15.0), 0.015: (0.005, 0.0, 30.0)}
"""error = f/3, seconds = 0.45/f; 0.06 is beyond the stability limit of this scene (0.0536)."""

STIFFNESS = {1 / 16: (-0.16, 0.0, 2.5), 1 / 4: (-0.04, 0.0, 5.0), 1.0: (-0.01, 0.0, 10.0)}
"""error = -0.01/k, seconds = 10 sqrt(k)."""


def asked(study, file, tolerance, **more):
    folder = study.write()
    scene = load_scene(file)
    effects = folder if study.effects is not None else None
    evidence = read_evidence(
        scene, file, quantity="friction_angle", folder=folder, effects=effects, tolerance=tolerance, **more
    )
    return advise(evidence, tolerance)


def values(advice):
    return {k: r.value for k, r in advice.choice.rungs.items()}


@pytest.mark.parametrize("tolerance", [0.2, 0.18, 0.06, 0.055, 0.03, 0.026, 0.021])
def test_the_cheapest_of_all_settings_is_found(study, file, tolerance):
    advice = asked(study({"dt": DT, "stiffness": STIFFNESS}), file, tolerance)
    able = [
        (10.0 * (dt[2] / 10.0) * (k[2] / 10.0), f, s)
        for (f, dt), (s, k) in itertools.product(list(DT.items())[1:], STIFFNESS.items())
        if abs(dt[0]) + abs(k[0]) <= tolerance
    ]
    seconds, f, s = min(able)
    assert values(advice) == {"dt": f, "stiffness": s}
    assert math.isclose(advice.choice.seconds, seconds)
    assert math.isclose(advice.choice.total.error(1), DT[f][0] + abs(STIFFNESS[s][0]))
    assert advice.choice.packings == 1
    assert not advice.choice.extrapolated
    assert advice.exit_status == 0


def test_errors_of_opposite_sign_do_not_cancel(study, file):
    ladders = {"dt": {0.045: (0.03, 0.0, 10.0)}, "stiffness": {1.0: (-0.03, 0.0, 10.0)}}
    assert asked(study(ladders), file, 0.05).choice is None
    assert asked(study(ladders), file, 0.06).choice is not None


def test_a_rung_that_is_right_by_chance_is_not_believed(study, file):
    """The error changes sign at 0.045; what is seen at 0.03 counts there, too."""
    ladder = {0.045: (0.0, 0.0001, 10.0), 0.03: (-0.01, 0.0001, 15.0), 0.015: (-0.004, 0.0001, 30.0)}
    advice = asked(study({"dt": ladder}), file, 0.008)
    assert values(advice) == {"dt": 0.015}
    wide = asked(study({"dt": ladder}), file, 0.02)
    assert values(wide) == {"dt": 0.045}
    assert math.isclose(wide.choice.total.systematic, 0.01)


def test_the_faster_engine_is_taken(study, file):
    made = study({"dt": DT}, engines=("lammps", "liggghts"), dearer={"lammps": 1.1})
    assert asked(made, file, 0.05).choice.engine == "liggghts"


def test_a_step_that_the_scene_refuses_is_not_advised(study, file):
    assert values(asked(study({"dt": DT}), file, 0.5)) == {"dt": 0.045}


def test_scatter_asks_for_packings(study, file):
    """sqrt(s^2/P) <= T - e: P = (0.1/(0.05 - 0.01))^2 = 6.25, rounded up; a finer rung needs fewer but more time."""
    advice = asked(study({"dt": {0.03: (0.01, 0.0, 15.0)}}, spread=0.1), file, 0.05)
    assert advice.choice.packings == 7
    assert advice.below_floor
    assert advice.choice.total.error(7) <= 0.05 < advice.choice.total.error(6)


def test_larger_samples_scatter_less_and_cost_more(study, file):
    """A packing of 4 N scatters by half, so that a quarter of the packings do: it pays below four times the cost."""
    dear = {200.0: (0.0, 0.0, 10.0), 800.0: (0.0, 0.0, 50.0)}
    cheap = {200.0: (0.0, 0.0, 10.0), 800.0: (0.0, 0.0, 30.0)}
    for ladder, count, packings in ((dear, 200.0, 16), (cheap, 800.0, 4)):
        advice = asked(study({"size": ladder}, spread=0.04), file, 0.01)
        assert (values(advice)["size"], advice.choice.packings) == (count, packings)


def test_scatter_is_that_of_all_sizes_together(study, file):
    """Told by 200 and 800 as 0.04 and 0.02, it is 0.02 at 800 whatever one of them says by chance."""
    made = study({"size": {200.0: (0.0, 0.0, 10.0), 800.0: (0.0, 0.0, 30.0)}}, spread=0.04)
    made._each = lambda name, value: [SCALE - d, SCALE + d] if (d := 1e-9 if value == 200.0 else 0.4) else None
    advice = asked(made, file, 0.05)
    told = math.sqrt(800.0 * (0.4 * math.sqrt(2.0) / SCALE) ** 2 / 2.0)
    assert math.isclose(advice.choice.total.spread, told / math.sqrt(200.0), rel_tol=1e-6)


def test_noise_adds_in_quadrature(study, file):
    ladders = {"dt": {0.045: (0.01, 0.03, 10.0)}, "stiffness": {1.0: (-0.02, 0.04, 10.0)}}
    advice = asked(study(ladders), file, 0.1)
    expected = math.sqrt(0.03**2 + 0.04**2 + 0.01**2 + 0.02**2)
    assert math.isclose(advice.choice.total.noise, expected)
    assert advice.choice.total.systematic == 0.0


def test_a_tolerance_below_the_floor_says_how_many_packings_would_do(study, file):
    """Errors known to 2 % from 8 packings; half the variance of 1 % needs eight times as many."""
    advice = asked(study({"dt": {0.045: (0.0, 0.02, 10.0)}}, spread=0.05), file, 0.01)
    assert advice.choice is None
    assert advice.exit_status == 1
    assert "below the statistical floor" in advice.why
    assert advice.needed == 64
    again = asked(study({"dt": {0.045: (0.0, 0.02 * math.sqrt(8 / 64), 10.0)}}, spread=0.05, packings=64), file, 0.01)
    assert again.choice.packings == 50, "with as many packings in the ladders it can be told"


def test_a_seen_error_above_the_tolerance_is_no_matter_of_packings(study, file):
    advice = asked(study({"dt": {0.045: (0.05, 0.001, 10.0)}}), file, 0.01)
    assert advice.choice is None
    assert advice.needed is None
    assert "climb further rungs" in advice.why
    assert advice.best.rungs["dt"].value == 0.045


# --- extrapolation ---------------------------------------------------------------------------------------


def test_a_finer_rung_follows_from_the_order(study, file):
    """error = f/3: 0.4 % asks for f = 0.012; half the finest rung, 0.0075, has 0.25 % and costs twice as much."""
    advice = asked(study({"dt": DT}), file, 0.004)
    rung = advice.choice.rungs["dt"]
    assert (rung.origin, advice.choice.extrapolated) == ("extrapolated", ("dt",))
    assert math.isclose(rung.value, 0.0075)
    assert math.isclose(rung.error, 0.0025)
    assert math.isclose(rung.seconds, 60.0)
    assert "x^1" in rung.how


def test_order_and_knob_decide_where_it_lies(study, file):
    """error = 0.01/k^2, order 2 in 1/k: 0.1 % asks for k = 3.2, the next is 4 with 0.06 %; time goes with sqrt(k)."""
    ladder = {1 / 4: (0.16, 0.0, 5.0), 1.0: (0.01, 0.0, 10.0)}
    advice = asked(study({"stiffness": ladder}, order=2.0), file, 0.001)
    rung = advice.choice.rungs["stiffness"]
    assert math.isclose(rung.value, 4.0)
    assert math.isclose(rung.error, 0.01 / 16)
    assert math.isclose(rung.seconds, 20.0)


def test_measured_rungs_come_first(study, file):
    """Beyond 0.015 a rung would be extrapolated; one that was run does it, though slower ones were too."""
    assert asked(study({"dt": DT}), file, 0.0051).choice.rungs["dt"].origin == "measured"


@pytest.mark.parametrize("more", [{"state": "flat"}, {"state": "outside"}, {"order": math.nan}, {"order": 0.0}])
def test_nothing_is_foretold_without_a_power(study, file, more):
    advice = asked(study({"dt": DT}, **more), file, 0.004)
    assert advice.choice is None


def test_nothing_is_foretold_too_far(study, file):
    assert asked(study({"dt": DT}), file, 0.005 / 8.0).choice is not None
    assert asked(study({"dt": DT}), file, 0.005 / 8.1).choice is None


# --- effects ---------------------------------------------------------------------------------------------

GO = {"names": ["damping attraction"], "change": 0.5, "error": 0.01, "saved": {"lammps": 0.2}}


def test_effects_that_may_go_save_their_time(study, file):
    advice = asked(study({"dt": {0.045: (0.01, 0.0, 10.0)}}, effects=GO), file, 0.02)
    assert advice.choice.without == ("damping attraction",)
    assert math.isclose(advice.choice.seconds, 8.0)
    assert math.isclose(advice.choice.total.systematic, 0.015)
    assert advice.scene.contact.normal.attraction == "clipped"


def test_effects_stay_where_their_change_is_too_much(study, file):
    advice = asked(study({"dt": {0.045: (0.01, 0.0, 10.0)}}, effects=GO), file, 0.012)
    assert advice.choice.without == ()
    assert advice.scene.contact.normal.attraction == "allowed"


# --- the scene -------------------------------------------------------------------------------------------


def test_the_advised_scene_is_written_and_loads(study, file, tmp_path):
    ladders = {
        "dt": {0.03: (0.0, 0.0, 15.0)}, "stiffness": {4.0: (0.0, 0.0, 20.0)}, "rate": {2.0: (0.0, 0.0, 5.0)},
        "size": {300.0: (0.0, 0.0, 15.0)},
    }
    advice = asked(study(ladders, spread=0.05, packings=4), file, 0.02)
    write_scene(advice.scene, file, tmp_path / "advised.toml", about="as advised")
    made, scene = load_scene(tmp_path / "advised.toml"), load_scene(file)
    assert made == advice.scene
    assert made.numerics.dt_fraction == 0.03
    assert made.particles.count == 300
    assert made.contact.normal.normal_stiffness == 4.0 * scene.contact.normal.normal_stiffness
    assert math.isclose(made.contact.normal.normal_damping, 2.0 * scene.contact.normal.normal_damping)
    assert made.top.duration == 0.5 * scene.top.duration
    assert made.compare.packings == advice.choice.packings > 1


# --- what is not there -----------------------------------------------------------------------------------


def test_knobs_without_a_ladder_are_told(study, file):
    advice = asked(study({"dt": DT}), file, 0.05)
    assert set(advice.evidence.absent) == {"stiffness", "rate", "size"}
    assert "not measured" in advice.evidence.absent["rate"]


def test_a_study_of_another_scene_is_refused(study, file):
    made = study({"dt": DT})
    other = load_scene(file.with_name("biaxial.toml"))
    made.scene = other
    with pytest.raises(InputError, match="expected a study of this scene"):
        asked(made, file, 0.05)


def test_a_quantity_without_errors_is_refused(study, file):
    folder = study({"dt": DT}).write()
    with pytest.raises(InputError, match="with errors and times of plateau_angle"):
        advise(read_evidence(load_scene(file), file, quantity="plateau_angle", folder=folder, effects=None,
                             tolerance=0.1), 0.1)


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


@pytest.mark.parametrize(("change", "says"), [
    *((pop(key), f"`{key}`") for key in ("rows", "packings", "quantity", "quantities", "engines", "knobs", "scene")),
    (pop("schema"), "without a schema"), (put("grainproof accuracy of bulk quantities, 1", "schema"), "quantities, 1"),
    (put("10", "rows", 0, "cpu_seconds"), "rows"), (put(-1.0, "rows", 0, "cpu_seconds"), "rows"),
    (put(-0.1, "rows", 0, "error_bar"), "rows"), (pop("rows", 0, "kind"), "kind"), (put(1, "packings"), "packings"),
    (put("x", "rows", -1, "state"), "state"), (put([3], "scene"), "scene"),
])
def test_a_file_that_no_study_writes_is_refused_in_one_line(study, file, change, says):
    made = study({"dt": DT})
    place = made.write() / "accuracy.json"
    data = json.loads(place.read_text())
    change(data)
    place.write_text(json.dumps(data))
    with pytest.raises(InputError) as error:
        read_evidence(load_scene(file), file, quantity=None, folder=place.parent, effects=None, tolerance=0.1)
    assert "\n" not in str(error.value)
    assert f"{place}: expected a finished grainproof accuracy, got " in str(error.value)
    assert says in str(error.value)


@pytest.mark.parametrize("change", [
    pop("saved"), pop("tables"), pop("left_out"), put([], "tables", "trials"),
    put("much", "tables", "trials", 0, "trial"), put(None, "tables", "trials", 0, "change (%)"),
])
def test_a_damaged_effects_study_is_refused_in_one_line(study, file, change):
    folder = study({"dt": DT}, effects=GO).write()
    data = json.loads((folder / "effects.json").read_text())
    change(data)
    (folder / "effects.json").write_text(json.dumps(data))
    with pytest.raises(InputError, match="effects.json: expected a finished grainproof effects, got a damaged file"):
        read_evidence(load_scene(file), file, quantity=None, folder=folder, effects=folder, tolerance=0.1)


def test_a_file_in_place_of_its_folder_is_said_to_be_one(study, file):
    place = study({"dt": DT}).write() / "accuracy.json"
    with pytest.raises(InputError, match="--from: expected the folder of a finished .*, got .*, a file; name"):
        read_evidence(load_scene(file), file, quantity=None, folder=place, effects=None, tolerance=0.1)


def test_only_the_engines_that_are_asked_for(study, file):
    folder = study({"dt": DT}, engines=("lammps", "liggghts"), dearer={"lammps": 1.1}).write()
    facts = {"quantity": None, "folder": folder, "effects": None, "tolerance": 0.1}
    evidence = read_evidence(load_scene(file), file, **facts, engines=["lammps"])
    assert advise(evidence, 0.1).choice.engine == "lammps"
    with pytest.raises(InputError, match="--engines: expected some of lammps, liggghts, which .* has, got kernel:talk"):
        read_evidence(load_scene(file), file, **facts, engines=["lammps", "kernel:talk"])


def test_refused_steps_are_named_and_are_those_that_cannot_run(study, file):
    """The study's mark and the check of the scene that would be advised agree."""
    ladder = {0.36: (0.001, 0.0, 1.0), 0.18: (0.001, 0.0, 2.0), **DT}
    advice = asked(study({"dt": ladder}, largest=0.0536), file, 0.1)
    dt = advice.evidence.ladders["lammps"]["dt"]
    assert dt.beyond == (0.06, 0.18, 0.36)
    scene = load_scene(file)
    assert [can_run(scene, file, Settings(values={"dt": r.value})) for r in dt.rungs] == [
        r.value not in dt.beyond for r in dt.rungs
    ]
    assert values(advice) == {"dt": 0.045}
    (told,) = [s for s in limits(advice) if "refused" in s]
    assert told.startswith("dt 0.06, 0.18, 0.36: refused by `scene`, beyond its stability limit of 0.0536;")
    assert [r["setting"] for r in ladder_rows(advice) if r["taken"] == "refused by `scene`"] == [0.36, 0.18, 0.06]


def test_packings_of_no_solution_promise_nothing(study, file):
    for bar, known in ((0.02, "those of the ladders; no number of them is known to be enough"),
                       (0.0001, "so that their mean is within the tolerance")):
        advice = asked(study({"dt": {0.045: (0.0, bar, 10.0)}}, spread=0.05), file, 0.01)
        (row,) = [r for r in advice_rows(advice) if r["what"] == "packings"]
        assert row["known from"] == known


@pytest.mark.parametrize("text", ["{", "[]", '{"schema": "another"}'])
def test_a_damaged_study_is_refused_in_one_line(text, file, tmp_path):
    (tmp_path / "accuracy.json").write_text(text)
    with pytest.raises(InputError) as error:
        read_evidence(load_scene(file), file, quantity=None, folder=tmp_path, effects=None, tolerance=0.1)
    assert "\n" not in str(error.value)


# --- combining, and mutants of it ------------------------------------------------------------------------


def test_total_by_hand():
    parts = [Part(name="a", error=0.03, bar=0.01, ratio=1.0), Part(name="b", error=-0.01, bar=0.02, ratio=1.0)]
    found = total(parts, 0.06)
    assert math.isclose(found.systematic, 0.03)
    assert math.isclose(found.noise, math.sqrt(0.01**2 + 0.02**2 + 0.01**2))
    assert math.isclose(found.error(9), 0.03 + math.hypot(found.noise, 0.02))


def test_packings_are_the_least_that_do():
    for tolerance in (0.031, 0.04, 0.05, 0.08):
        found = Total(systematic=0.01, noise=0.02, spread=0.1)
        count = found.packings_for(tolerance)
        assert found.error(count) <= tolerance * (1 + 1e-12)
        assert count == 1 or found.error(count - 1) > tolerance
    assert Total(systematic=0.01, noise=0.02, spread=0.1).packings_for(0.03) is None
    assert Total(systematic=0.01, noise=0.02, spread=0.1).packings_for(0.005) is None


def signed(parts, spread):
    """A mutant: seen errors may cancel."""
    return Total(systematic=abs(sum(p.error for p in parts if p.seen)), noise=0.0, spread=spread)


def noiseless(parts, spread):
    """A mutant: what is not seen is not there."""
    return Total(systematic=sum(abs(p.error) for p in parts if p.seen), noise=0.0, spread=spread)


def unscattered(parts, _spread):
    """A mutant: one packing tells all."""
    return Total(systematic=sum(abs(p.error) for p in parts), noise=0.0, spread=0.0)


@pytest.mark.parametrize(
    ("mutant", "case"),
    [(signed, test_errors_of_opposite_sign_do_not_cancel), (noiseless, test_noise_adds_in_quadrature),
     (noiseless, test_a_tolerance_below_the_floor_says_how_many_packings_would_do),
     (unscattered, test_scatter_asks_for_packings)],
)  # fmt: skip
def test_wrong_sums_are_caught(mutant, case, study, file, monkeypatch):
    monkeypatch.setattr(choose, "total", mutant)
    with pytest.raises(AssertionError):
        case(study, file)


def test_a_wrong_product_of_times_is_caught(study, file, monkeypatch):
    monkeypatch.setattr(choose, "time_ratio", lambda parts: sum(p.ratio for p in parts))
    with pytest.raises(AssertionError):
        test_the_cheapest_of_all_settings_is_found(study, file, 0.055)
