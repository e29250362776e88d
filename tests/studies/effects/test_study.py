"""The whole study on the kernel alone, wrong requests, and what is not made twice."""

from pathlib import Path

import pytest

from harness.errors import InputError
from harness.scene.effects import EFFECTS
from harness.scene.load import load_scene
from harness.studies.effects import effects_study, timing
from harness.studies.effects.asked import asked
from harness.studies.effects.cost import StepCost
from harness.studies.effects.quantities import named_quantities
from harness.studies.effects.study import REDUCED
from harness.studies.effects.variants import BASE

SCENES = Path(__file__).resolve().parents[3] / "inputs" / "scenes"
FILE = SCENES / "oblique_impact.toml"


def canned_costs(_engine, _version, systems, **_):
    """Every variant takes 0.9 of the time; sessions have tests of their own."""
    ratios = {name: 1.0 if name == BASE else 0.9 for name in systems}
    return {n: StepCost(seconds=(r * 1e-5,) * 3, ratios=(r,) * 3, setup=0.1) for n, r in ratios.items()}


def study(out, **more):
    options = {"engines": ["kernel:talk"], "only": ["normal_damping", "background-drag"]} | more
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(timing, "step_costs", canned_costs)
        return effects_study(FILE, out, **options)


@pytest.fixture(scope="module")
def out(tmp_path_factory):
    return tmp_path_factory.mktemp("effects")


@pytest.fixture(scope="module")
def found(out):
    return study(out, tolerance=0.3)


def test_a_switch_within_a_wide_tolerance_goes_and_a_run_says_so(found):
    assert found.smallest.left_out == ("normal damping",)
    assert found.smallest.verified
    (trial,) = found.smallest.trials
    assert trial.holds
    assert found.reduced.contact.normal.normal_damping == 0.0
    assert found.whole_ratio("kernel:talk", REDUCED) == 0.9
    assert found.exit_status == 0


def test_the_change_is_that_of_the_restitution(found):
    """Without a dashpot nothing of 1 - e = 0.19 is lost of the normal speed, cos 45 of the whole: 0.067 a body."""
    change = next(c for c in found.changes if (c.variant, c.quantity) == ("without normal damping", "velocity"))
    assert 0.05 < change.relative < 0.09


def test_nothing_is_made_twice(found, out):
    before = {p: p.stat().st_mtime_ns for p in out.rglob("*") if p.is_file() and p.name != ".lock"}
    again = study(out, tolerance=0.3)
    after = {p: p.stat().st_mtime_ns for p in out.rglob("*") if p.is_file() and p.name != ".lock"}
    assert {p: t for p, t in after.items() if p.suffix in (".h5", ".json")} == {
        p: t for p, t in before.items() if p.suffix in (".h5", ".json")
    }
    assert again.changes == found.changes
    assert again.costs == found.costs


def test_a_narrow_tolerance_keeps_it(out):
    narrow = study(out, tolerance=1e-3)
    assert narrow.smallest.left_out == ()
    assert "beyond the tolerance" in narrow.smallest.kept["normal damping"]
    assert REDUCED not in {variant for _, variant in narrow.costs}


def test_a_saving_within_the_scatter_of_the_times_moves_nothing(out):
    """The change is as small as before; the ratio's range holds 1."""
    def scattered(*words, **more):
        costs = canned_costs(*words, **more)
        hidden = StepCost(seconds=(1e-5,) * 3, ratios=(0.976, 0.992, 1.04))
        return {name: cost if name == BASE else hidden for name, cost in costs.items()}

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(timing, "step_costs", scattered)
        kept = effects_study(FILE, out, engines=["kernel:talk"], only=["normal damping"], tolerance=0.3)
    assert kept.smallest.left_out == ()
    assert "stands out of the scatter" in kept.smallest.kept["normal damping"]


def test_effects_that_are_not_asked_for_are_not_switched(found):
    assert {v.effect.name for v in found.variants} == {"normal damping", "background drag"}
    assert {name for _, name in found.costs} == {
        BASE, "without normal damping", "with background drag", REDUCED
    }
    assert len(found.effects) == len(EFFECTS)


@pytest.mark.parametrize(
    ("more", "says"),
    [
        ({"quantities": ["friction_angel"]}, "--quantity: expected one of exit"),
        ({"tolerance": 0.0}, "--tolerance: expected a number > 0"),
        ({"tolerance": -0.1}, "--tolerance: expected a number > 0"),
        ({"tolerance": float("nan")}, "--tolerance: expected a number > 0"),
        ({"tolerance": 5.0}, "0.05 is five per cent"),
        ({"only": ["sliding frction"]}, "--effect: expected one of normal contact"),
        ({"engines": ["yade"]}, "--engines: expected names"),
        ({"by": "yade"}, "--by: expected names"),
        ({"packings": 3}, "--packings: expected 1"),
    ],
)
def test_wrong_requests_are_refused_in_one_line(more, says, tmp_path):
    with pytest.raises(InputError) as error:
        study(tmp_path / "none", **more)
    assert says in str(error.value)
    assert "\n" not in str(error.value)
    assert not (tmp_path / "none").exists()


def test_an_engine_that_does_not_take_the_scene_cannot_answer(tmp_path):
    file = SCENES / "hysteretic_impact.toml"
    with pytest.raises(InputError, match="--by: expected an engine that computes the scene, got lammps"):
        effects_study(file, tmp_path, by="lammps")


def test_quantities_a_scene_does_not_have_are_not_offered():
    box = load_scene(SCENES / "biaxial_quick.toml")
    assert "friction_angle" in named_quantities(box)
    smooth = load_scene(SCENES / "biaxial_frictionless.toml")
    assert "friction_angle" not in named_quantities(smooth)
    wanted = asked(smooth, FILE, quantities=None, tolerance=None, only=None, engines=None, by=None, packings=None)
    assert wanted.quantities == ("plateau_angle",)
