"""Changes with errors, verdicts against a tolerance, and the smallest set, on numbers with known answers."""

import math

import pytest

from harness.scene.effects import Effect
from harness.studies.effects.changes import change_of
from harness.studies.effects.smallest import smallest_set
from harness.studies.effects.variants import BASE, Variant
from harness.studies.statistics.family import Measured

OFF = "without rolling resistance"
DRIFT = (0.5, -0.5, 0.25, -0.25)
"""Adds up to nothing: scatter of differences without changing their mean."""


def quantity(shift, scatter=0.0, *, name="friction_angle", scale=None, count=4, gone=()):
    base = {k: 20.0 + 2.0 * DRIFT[k % 4] for k in range(count)}
    switched = {k: v + shift + scatter * DRIFT[k % 4] for k, v in base.items() if k not in gone}
    return Measured(quantity=name, unit="deg", values={BASE: base, OFF: switched}, scale=scale)


def test_what_packings_share_cancels():
    found = change_of(quantity(0.4), OFF, 0.05)
    assert math.isclose(found.relative, 0.02)
    assert found.error < 1e-15
    assert found.verdict == "agrees"
    spread = 2.0 * math.sqrt((0.5**2 + 0.25**2) * 2 / 3) / 20.0
    assert math.isclose(found.bar, spread)
    assert math.isclose(found.in_bars, 0.02 / spread)


@pytest.mark.parametrize(
    ("shift", "scatter", "verdict"),
    [(0.1, 0.1, "agrees"), (3.0, 0.1, "differs"), (-3.0, 0.1, "differs"), (0.9, 4.0, "inconclusive"),
     (0.1, 8.0, "inconclusive"), (0.999, 0.0, "agrees"), (1.001, 0.0, "differs")],
)  # fmt: skip
def test_verdicts(shift, scatter, verdict):
    assert change_of(quantity(shift, scatter), OFF, 0.05).verdict == verdict


def test_more_packings_would_settle_it_and_how_many():
    found = change_of(quantity(0.1, 3.0), OFF, 0.05)
    assert found.verdict == "inconclusive"
    assert 5 <= found.needed <= 60
    assert f"{found.needed} packings" in found.why


def test_packings_that_would_show_a_change_to_be_beyond():
    """-50 % with an error of 10 % from two packings: t_1 is so wide that they cannot tell, three can."""
    found = change_of(quantity(-10.0, 4.0, count=2), OFF, 0.05)
    assert math.isclose(found.relative, -0.5)
    assert (found.verdict, found.needed) == ("inconclusive", 3)
    assert "about 3 packings would show that it is beyond" in found.why
    assert change_of(quantity(-10.0, 4.0, count=4), OFF, 0.05).verdict == "differs"
    assert change_of(quantity(1.2, 3.0), OFF, 0.05).needed > 100, "hardly beyond"
    assert change_of(quantity(1.0, 3.0), OFF, 0.05).needed is None, "at the tolerance no number tells"


def test_what_a_change_is_a_part_of_is_named():
    assert change_of(quantity(0.4), OFF, 0.05).over == "its value as declared"
    assert change_of(quantity(0.4, name="volume_strain", scale=0.05), OFF, 0.05).over == "an axial strain of 0.05"
    curve = Measured(quantity="stress_strain", unit="1", values={BASE: {0: 0.0}, OFF: {0: 0.14}}, scale=1.0)
    assert change_of(curve, OFF, 0.05).over == "the rms of the curve as declared"


def test_a_negative_quantity_that_shrinks_falls():
    torque = Measured(quantity="torque", unit="N m", values={BASE: {0: -2.0, 1: -2.2}, OFF: {0: -1.0, 1: -1.1}})
    assert math.isclose(change_of(torque, OFF, 0.05).relative, -0.5)


def test_a_quantity_that_is_gone_differs():
    found = change_of(quantity(0.0, gone=(0, 1, 2, 3)), OFF, 0.05)
    assert (found.verdict, found.value, found.relative) == ("differs", None, None)
    assert change_of(quantity(0.0, gone=(1,)), OFF, 0.05).verdict == "differs"


def test_a_run_that_failed_is_no_change():
    found = change_of(quantity(0.0, gone=(1,)), OFF, 0.05, "crashed: out of memory")
    assert (found.verdict, found.why, found.relative) == ("not_checked", "crashed: out of memory", None)


def test_one_packing_has_no_error_bar_unless_the_run_tells_one():
    bare = quantity(0.1, count=1)
    assert change_of(bare, OFF, 0.05).verdict == "inconclusive"
    told = Measured(quantity="torque", unit="N m", values=bare.values, errors={BASE: {0: 0.03}, OFF: {0: 0.04}})
    found = change_of(told, OFF, 0.05)
    assert math.isclose(found.error * 21.0, 0.05)
    assert math.isclose(found.bar * 21.0, 0.03)
    assert found.verdict == "agrees"


def test_deviations_of_a_free_scene_are_exact_and_have_no_error_bar():
    exits = Measured(quantity="exit", unit="1", values={BASE: {0: 0.0}, OFF: {0: 0.02}}, scale=1.0)
    found = change_of(exits, OFF, 0.01)
    assert (found.verdict, found.error) == ("differs", 0.0)
    assert found.bar is found.in_bars is None, "the tolerance is none"
    assert change_of(exits, OFF, 0.03).verdict == "agrees"


# --- the smallest set ----------------------------------------------------------------------------------


def variant(name, *, on=True, scene="something"):
    return Variant(effect=Effect(name=name, on=on, place="", reason="", brings=""), scene=scene, reason="because")


def shifted(name, shift):
    m = quantity(shift, 0.1)
    return change_of(Measured(quantity="q", unit="", values={BASE: m.values[BASE], name: m.values[OFF]}), name, 0.05)


SHIFTS = {"gravity": 0.5, "background drag": 0.6, "adhesion": 3.0, "wall friction": 0.1}


def found(joint, saves=None):
    """joint: the change of effects left out together, from their own."""
    variants = [variant(n) for n in SHIFTS] + [variant("normal contact", scene=None), variant("rotation", on=False)]
    changes = [shifted(f"without {n}", s) for n, s in SHIFTS.items()]
    tried = []

    def run(names):
        tried.append(names)
        return [shifted("reduced", joint([SHIFTS[n] for n in names]))]

    return smallest_set(variants, changes, ("q",), saves or dict.fromkeys(SHIFTS, 0.1), run), tried


def test_all_that_may_go_go_when_a_run_says_so():
    smallest, tried = found(max)
    assert smallest.left_out == ("gravity", "background drag", "wall friction")
    assert tried == [smallest.left_out]
    assert smallest.verified
    assert smallest.kept.keys() == {"adhesion", "normal contact"}
    assert smallest.kept["normal contact"] == "because"


def test_the_one_that_changes_most_comes_back_until_it_holds():
    smallest, tried = found(sum)
    assert [len(t) for t in tried] == [3, 2]
    assert smallest.left_out == ("gravity", "wall friction")
    assert "together" in smallest.kept["background drag"]
    assert [t.holds for t in smallest.trials] == [False, True]


def test_nothing_goes_that_no_run_confirms():
    smallest, tried = found(lambda _: 9.0)
    assert smallest.left_out == ()
    assert len(tried) == 3


def test_what_saves_no_time_that_was_seen_stays():
    smallest, tried = found(max, {"gravity": -0.1, "background drag": 0.0, "adhesion": 0.3, "wall friction": None})
    assert "10 % longer" in smallest.kept["gravity"]
    assert "nothing that stands out" in smallest.kept["background drag"]
    assert "not measured" in smallest.kept["wall friction"]
    assert (smallest.left_out, tried) == ((), [])


def test_a_trial_keeps_what_else_changes_and_is_not_judged_by_it():
    variants = [variant("gravity")]
    other = change_of(quantity(9.0, 0.1, name="stress_strain"), OFF, 0.05)
    alone, together = [shifted("without gravity", 0.1)], [shifted("reduced", 0.1), other]
    smallest = smallest_set(variants, alone, ("q",), {"gravity": 0.1}, lambda _: together)
    assert smallest.left_out == ("gravity",)
    (trial,) = smallest.trials
    assert [c.quantity for c in trial.changes] == ["q"]
    assert [(c.quantity, c.verdict) for c in trial.others] == [("stress_strain", "differs")]


def test_an_inconclusive_switch_stays():
    changes = [change_of(quantity(0.1, 8.0), OFF, 0.05)]
    smallest = smallest_set([variant("rolling resistance")], changes, ("friction_angle",), {}, lambda _: [])
    assert smallest.left_out == ()
    assert "cannot tell" in smallest.kept["rolling resistance"]
