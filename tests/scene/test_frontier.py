"""`grainproof scene` warns of steps near the measured limit, from the committed table and without running anything."""

import pytest

from harness.report.scene import scene_answer
from harness.scene.contact import LinearNormal
from harness.scene.derived import derive
from harness.scene.frontier import (
    MARGIN,
    Measured,
    Table,
    frontier_table,
    late_springs,
    measured_limit,
    step_warnings,
)
from harness.scene.numerics import particle_limit
from harness.scene.resolve import known_system

LAWS = ("linear", "spring", "", "")


def table(*entries):
    return Table(entries=entries, date="2026-01-01", command="grainproof frontier", versions={})


def entry(of_formula, laws=LAWS, dimension=2, engine="lammps"):
    return Measured(engine=engine, of_formula=of_formula, count=3, where="a lattice", dimension=dimension, laws=laws)


@pytest.fixture
def looked_at(scenes):
    """looked_at(changes): the two discs with friction spring and what follows from them."""

    def load(changes=None):
        scene = scenes.load(scenes.free, changes)
        return scene, derive(scene, known_system(scene, scenes.file))

    return load


def formula(scene, derived):
    return particle_limit(scene.contact, derived.grains, scene.background).dt


def test_committed_table_covers_codes_and_common_laws():
    known = frontier_table()
    assert known.command.startswith("grainproof frontier")
    for engine in ("lammps", "liggghts"):
        for laws in (("linear", "", "", ""), LAWS):
            assert [e for e in known.entries if (e.engine, e.laws, e.dimension) == (engine, laws, 2)]
    assert all(e.of_formula > 0.98 for e in known.entries), "the formula of scenes would let unstable steps pass"


def test_the_smallest_entry_of_the_same_laws_decides(looked_at):
    scene, derived = looked_at()
    known = table(entry(1.3), entry(1.1), entry(0.5, laws=("hertz", "", "", "")), entry(0.2, dimension=3))
    limit = measured_limit(scene, derived, known)
    assert limit.same_laws
    assert limit.dt == pytest.approx(1.1 * formula(scene, derived))


def test_of_unknown_laws_the_smallest_entry_of_the_dimension_stands(looked_at):
    scene, derived = looked_at()
    limit = measured_limit(scene, derived, table(entry(1.3, laws=("hertz", "", "", "")), entry(0.2, dimension=3)))
    assert not limit.same_laws
    assert limit.dt == pytest.approx(1.3 * formula(scene, derived))


def test_warning_names_limit_margin_and_command(looked_at):
    scene, derived = looked_at()
    near = derived.plan.dt / (1 - MARGIN) / formula(scene, derived)
    assert not list(step_warnings(scene, derived, table(entry(1.01 * near))))
    ((what, why),) = step_warnings(scene, derived, table(entry(0.99 * near)))
    assert what == "time step near the measured limit"
    assert "margin of 20 %" in why
    assert "grainproof frontier" in why
    assert "linear normal, spring sliding" in why


def test_its_advice_is_enough(looked_at):
    scene, derived = looked_at()
    known = table(entry(0.9 * derived.plan.dt / formula(scene, derived)))
    ((_, why),) = step_warnings(scene, derived, known)
    advised = float(why.split("dt_fraction <= ")[1].split(";")[0])
    assert not list(step_warnings(*looked_at({"numerics.dt_fraction": 0.995 * advised}), known))


def test_late_springs_of_the_talks(looked_at):
    scene, derived = looked_at({"contact.sliding.shear_damping": 0.0})
    ((what, why),) = step_warnings(scene, derived, table(entry(10.0)))
    assert "kernel:talk" in what
    assert "shear_damping" in why
    assert dict(late_springs(scene.contact)) == {"sliding": 0.0}
    assert not list(step_warnings(*looked_at({"contact.sliding.shear_damping": 0.1}), table(entry(10.0))))


def test_answer_shows_warnings_and_is_silent_without(scenes):
    fine = scenes.write(scenes.dump(scenes.free))
    assert "Warnings" not in scene_answer(fine).tables
    late = scenes.edited(scenes.free, {"contact.sliding.shear_damping": 0.0})
    answer = scene_answer(scenes.write(scenes.dump(late)))
    (row,) = answer.tables["Warnings"]
    assert row["name"] == "sliding spring without enough dashpot for kernel:talk"
    assert answer.data["warnings"][0]["value"] == "warning"


def test_a_smooth_scene_close_to_refusal_is_warned_of(scenes):
    """By the committed table: without friction the formula is as long as what was measured."""
    smooth = {"contact.sliding": scenes.remove, "duration": 1e-2}
    scene = scenes.load(scenes.free, smooth)
    derived = derive(scene, known_system(scene, scenes.file))
    nearly = 0.95 * scene.numerics.dt_fraction * formula(scene, derived) / derived.plan.dt
    near = scenes.edited(scenes.free, smooth | {"numerics.dt_fraction": nearly})
    (row,) = scene_answer(scenes.write(scenes.dump(near))).tables["Warnings"]
    assert row["name"] == "time step near the measured limit"


def test_viscous_friction_and_hertz_have_no_late_spring(scenes):
    scene = scenes.load(scenes.free, {"contact.sliding": scenes.slidings["viscous"]})
    assert not list(late_springs(scene.contact))
    assert isinstance(scene.contact.normal, LinearNormal)
