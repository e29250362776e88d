"""One acceptance test for every registered combination of laws: the kernel, in every convention that there is."""

from typing import get_args

import numpy as np
import pytest

from harness.engines.protocol import Reaction
from harness.engines.registry import ENGINES
from harness.scene import contact
from harness.studies.laws.arrangement import arrangement
from harness.studies.laws.cases import CASES
from harness.studies.laws.collisions import MEASURES, collision_system
from harness.studies.laws.drive import Driven, Driver, Job
from harness.studies.laws.frame_checks import frame_deviations
from harness.studies.laws.judge import CLOSED_FORM, PLAIN_FRAME, STEPPED, judge_engine
from harness.studies.laws.stepped import Stepper
from reference.kernel.conventions import CONVENTIONS
from reference.kernel.deck import read_deck
from reference.kernel.prescribed import driven
from reference.values import published_values

BEYOND_THE_KERNEL = ("jkr",)
"""Contacts that hold on beyond overlap zero; LAMMPS has them and is compared with the closed form."""


def proven() -> list[tuple[str, str]]:
    """Names and conventions: without tangential laws all conventions are one."""
    names = [n for n in CASES if n not in BEYOND_THE_KERNEL]
    normal = {n for n in names if CASES[n].sliding is CASES[n].rolling is CASES[n].torsion is None}
    return [(n, c) for n in names for c in CONVENTIONS if c == "talk" or n not in normal]


@pytest.mark.parametrize(("name", "convention"), proven())
def test_the_kernel_agrees_with_closed_forms_in_every_frame(name, convention, kernel_inside, tmp_path):
    laws, engine = CASES[name], kernel_inside(convention)
    driver = Driver(root=tmp_path, time_limit=60.0, workers=1)
    jobs = [Job(laws=laws, engine=engine, arrangement=arrangement(p, d, laws.grains)) for p, d in parts(laws)]
    (runs,) = driver.each([jobs])
    assert [r.status for r in runs] == ["completed"] * len(jobs)
    checks = judge_engine(laws, engine.name, {r.part: r for r in runs}, {}, "again")
    assert [c for c in checks if c.verdict == "differs"] == []
    assert {c.right for c in checks} == {CLOSED_FORM, STEPPED, PLAIN_FRAME}
    fixed = {c.quantity for c in checks if c.right == CLOSED_FORM}
    assert len(fixed) == (5 if 3 in laws.dimensions else 4)
    assert max(c.deviation for c in checks if c.right == CLOSED_FORM) <= 2e-15
    assert max(c.deviation for c in checks if c.right == STEPPED) <= 1e-13
    frames = [c for c in checks if c.right == PLAIN_FRAME]
    assert max(c.off for c in frames if c.dimension == 3) <= 1e-13
    assert max(c.off for c in frames) <= 3e-13
    assert all(abs(c.deviation - c.tolerance) <= 3e-13 for c in frames if c.predicted and not bounds(c))


@pytest.mark.parametrize("name", ["hertz+mindlin", "hertz+viscous", "hysteretic+spring"])
@pytest.mark.parametrize("partner", ["pair", "plane"])
def test_what_the_paths_add_of_their_own_in_other_frames(name, partner, tmp_path):
    """The kernel in extended precision finds what the rounding of the paths themselves makes of 3D: less than 1e-13."""
    laws, place = CASES[name], arrangement(partner, 3)
    engine = ENGINES["kernel:corrected"]
    for file, text in engine.render_prescribed(place.system(laws, "x")).items():
        (tmp_path / file).write_text(text)
    model, _ = read_deck(tmp_path)
    numbers = [np.asarray(getattr(place.path, k), np.longdouble) for k in ("x", "v", "spin")]
    force, torque = driven(model.in_long_double(), *numbers)
    run = Driven(
        job=Job(laws=laws, engine=engine, arrangement=place), status="completed", reason="",
        reaction=Reaction(force=force, torque=torque),
    )
    found = [f for m in place.motions for f in frame_deviations(run, m, "corrected", Stepper(laws=laws))]
    assert 1e-15 < max(f.off for f in found) < 1e-13


def bounds(check) -> bool:
    """Does rounding have a share in what the reason explains?"""
    return "decided by rounding" in check.reason


def parts(laws) -> list[tuple[str, int]]:
    """Pairs in 3D and planes in 2D: the two others have the same parts."""
    return [("pair", 3), ("plane", 2 if 2 in laws.dimensions else 3)]


def test_every_law_of_the_scene_is_proven_in_some_combination():
    unions = {"normal": contact.NormalLaw, "sliding": contact.SlidingLaw, "rolling": contact.RollingLaw}
    for family, union in unions.items():
        assert {type(getattr(laws, family)) for laws in CASES.values()} - {type(None)} == set(get_args(union))
    assert any(laws.torsion for laws in CASES.values())
    assert {getattr(laws.normal, "attraction", "") for laws in CASES.values()} >= {"allowed", "clipped"}
    assert any(getattr(laws.sliding, "dynamic_friction", None) for laws in CASES.values())
    damped = {getattr(laws.sliding, "shear_damping", 0.0) > 0.0 for laws in CASES.values() if laws.sliding}
    assert damped == {True, False}


@pytest.mark.parametrize("name", CASES)
def test_a_kernel_takes_every_combination_or_says_why_not(name):
    laws = CASES[name]
    systems = [arrangement(p, d, laws.grains).system(laws, "x") for p, d in parts(laws)] + [collision_system(laws)]
    refused = [s for system in systems for s in ENGINES["kernel:talk"].supports(system) if s.level == "unsupported"]
    assert bool(refused) == (name in BEYOND_THE_KERNEL)


def test_tabulated_impacts_are_of_laws_that_there_are():
    values = [v for v in published_values().values() if v.kind == "analytical"]
    assert len(values) >= 9
    for v in values:
        laws, _, what = v.quantity.partition(": ")
        assert laws in CASES
        assert what in MEASURES
