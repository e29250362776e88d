"""Expected times: how runs are shared out, what is counted, and who refuses."""

from pathlib import Path

import pytest

from harness.engines.registry import ENGINES, choose_engines
from harness.errors import InputError
from harness.report import effects_expected, stability_expected
from harness.report.expected import (
    expected_comparison,
    judging_seconds,
    likely_system,
    longest_first,
    packing_seconds,
    run_seconds,
)
from harness.report.scene import scene_answer
from harness.scene.load import load_scene

SCENES = Path(__file__).resolve().parents[2] / "inputs" / "scenes"
KERNELS = choose_engines(["kernel:lammps", "kernel:liggghts"])


@pytest.mark.parametrize(("costs", "workers", "end"), [
    ([3.0, 1.0, 2.0, 2.0], 1, 8.0), ([3.0, 1.0, 2.0, 2.0], 2, 4.0), ([3.0, 1.0, 2.0, 2.0], 4, 3.0), ([], 2, 0.0),
])
def test_the_longest_run_begins_first(costs, workers, end):
    assert longest_first(costs, workers) == end


def shipped(name):
    path = SCENES / f"{name}.toml"
    scene = load_scene(path)
    return scene, likely_system(scene, path)


def test_packings_and_runs_add_up():
    scene, system = shipped("biaxial_quick")
    one, several = (expected_comparison(scene, system, KERNELS, starts=n, workers=1) for n in (1, 3))
    assert (one.runs, one.packings, several.runs, several.packings) == (2, 1, 6, 3)
    each = packing_seconds(scene, system) + sum(run_seconds(e, system) for e in KERNELS)
    judged = judging_seconds(system, 6) - judging_seconds(system, 2)
    assert several.seconds - one.seconds == pytest.approx(2 * each + judged)
    assert several.says.startswith("6 runs and 3 packings, on idle cores;")


def test_two_workers_take_half_the_time_of_equal_runs():
    scene, system = shipped("biaxial_quick")
    one, two = (expected_comparison(scene, system, KERNELS, starts=1, workers=n) for n in (1, 2))
    assert one.seconds - two.seconds == pytest.approx(run_seconds(KERNELS[0], system))


def test_without_friction_the_conventions_of_the_kernel_are_one_run():
    scene, system = shipped("head_on")
    expected = expected_comparison(scene, system, KERNELS, starts=1)
    assert (expected.runs, expected.packings, expected.at_once) == (1, 0, 1)


def test_a_scene_says_which_engines_refuse_it_and_why(tmp_path):
    """More sizes than LIGGGHTS' table of dashpots has room for, in an adhesive law with a dashpot."""
    text = (SCENES / "biaxial_quick.toml").read_text()
    linear = text[text.index('law = "linear"'):text.index("[contact.sliding]")]
    adhesive = (
        'law = "hysteretic"\nloading_stiffness = 1e5\nunloading_stiffness = 1.2e5\nadhesion_stiffness = 1e4\n'
        "normal_damping = 0.1\n\n"
    )
    assert "dt_fraction = 0.045" in text
    text = text.replace(linear, adhesive).replace("dt_fraction = 0.045", "dt_fraction = 0.02")
    (tmp_path / "sticky.toml").write_text(text)
    answer = scene_answer(tmp_path / "sticky.toml")
    refused = answer.tables["Engines that refuse it"]
    assert any("up to 12 different radii or masses, not 200" in r["note"] for r in refused if r["name"] == "liggghts")
    times = {r["name"] for r in answer.tables["Expected run time"]}
    assert times == set(ENGINES) - {r["name"] for r in refused}
    assert "Engines that refuse it" not in scene_answer(SCENES / "biaxial_quick.toml").tables


def test_hard_cases_are_counted_with_those_that_they_are_held_against():
    asked = {"engines": ["kernel:talk"], "long": False, "workers": 1}
    one = stability_expected.expected_stability(["late_mindlin"], **asked)
    assert (one.runs, one.packings) == (1, 0)
    held = stability_expected.expected_stability(["unit_base"], **asked).runs
    assert stability_expected.expected_stability(["fast_time"], **asked).runs > held, "it has a twin"
    packed = stability_expected.expected_stability(["pressure_jump_box"], **asked)
    assert packed.packings == 1
    line = stability_expected.announcement(["late_mindlin"], **asked)
    assert line.startswith("expected: about ")
    assert " for 1 run, on idle cores; what --out holds already is not made again" in line
    with pytest.raises(InputError, match="no_such"):
        stability_expected.announcement(["no_such"], **asked)


NOTHING = dict.fromkeys(("quantities", "tolerance", "only", "by", "packings", "workers"))


def test_effects_are_told_by_their_runs_packings_and_timing():
    both = {"engines": ["lammps", "kernel:talk"]}
    line = effects_expected.announcement(SCENES / "biaxial_quick.toml", **NOTHING, **both)
    assert "and 4 packings" in line
    assert "besides timing" in line
    with pytest.raises(InputError, match="--tolerance"):
        effects_expected.announcement(SCENES / "biaxial_quick.toml", **NOTHING | {"tolerance": 2.0}, **both)


def test_a_switch_more_takes_longer_and_a_scene_that_is_not_packed_has_no_packing():
    scene, file = load_scene(SCENES / "oblique.toml"), SCENES / "oblique.toml"
    one, two = (
        effects_expected.expected_effects(scene, file, only, KERNELS, KERNELS[0], packings=1, workers=1)
        for only in (["gravity"], ["gravity", "sliding friction"])
    )
    assert two.seconds > one.seconds
    assert two.runs > one.runs
    assert one.packings == 0
