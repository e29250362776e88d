"""`grainproof scene` warns of steps near the measured limit, from the committed table and without running anything."""

import math

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
    assert [(late.family, late.held) for late in late_springs(scene.contact, derived)] == [("sliding", 0.0)]
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


def test_viscous_friction_has_no_late_spring(looked_at):
    scene, derived = looked_at({"contact.sliding": {"law": "viscous", "shear_friction": 0.5, "shear_damping": 0.1}})
    assert not list(late_springs(scene.contact, derived))
    assert isinstance(scene.contact.normal, LinearNormal)


@pytest.fixture
def spheres(scenes, looked_at):
    """spheres(restitution, dt_fraction): the two discs as Hertz-Mindlin ones."""

    def load(restitution, dt_fraction=0.02):
        normal = scenes.normals["hertz"] | {"restitution": restitution}
        return looked_at({"contact.normal": normal, "contact.sliding": scenes.slidings["mindlin"],
                          "numerics.dt_fraction": dt_fraction})

    return load


@pytest.mark.parametrize("restitution", [0.3, 0.8, 0.95])
def test_mindlin_s_spring_is_held_up_to_its_dashpot_over_its_stiffness(spheres, restitution):
    """2 sqrt(5/6) beta sqrt(m*/S_t), S_t = 8 G* sqrt(R* delta), delta of the impact."""
    scene, derived = spheres(restitution)
    (late,) = late_springs(scene.contact, derived)
    normal, smallest = scene.contact.normal, derived.pairs[0]
    shear = normal.youngs_modulus / (4 * (2 - normal.poisson_ratio) * (1 + normal.poisson_ratio))
    stiffness = 8 * shear * math.sqrt(smallest.pair.reduced_radius * smallest.met.largest_overlap)
    beta = -math.log(restitution) / math.hypot(math.log(restitution), math.pi)
    held = 2 * math.sqrt(5 / 6) * beta * math.sqrt(smallest.pair.reduced_mass / stiffness)
    assert late.held == pytest.approx(held, rel=1e-9)


def test_mindlin_s_spring_is_warned_of_where_its_dashpot_does_not_hold(spheres):
    """At a fiftieth of the contact time it holds up to e = 0.88: 2.01 beta sqrt(m*/S_n) against 4.03/50 of it."""
    known = table(entry(10.0, laws=("hertz", "mindlin", "", "")))
    assert not list(step_warnings(*spheres(0.85), known))
    ((what, why),) = step_warnings(*spheres(0.91), known)
    assert what == "sliding spring without enough dashpot for kernel:talk"
    assert "lower normal.restitution" in why
    assert "impact_speed" in why
    assert not list(step_warnings(*spheres(0.91, dt_fraction=0.01), known))
    ((_, why),) = step_warnings(*spheres(1.0, dt_fraction=0.001), known)
    assert "gamma/k = 0 s" in why
