"""One acceptance test for every registered combination of laws: the kernel, in every convention that there is."""

from typing import get_args

import pytest

from harness.engines.registry import ENGINES
from harness.scene import contact
from harness.studies.laws.arrangement import arrangement
from harness.studies.laws.cases import CASES
from harness.studies.laws.collisions import MEASURES, collision_system
from harness.studies.laws.drive import Driver, Job
from harness.studies.laws.judge import CLOSED_FORM, PLAIN_FRAME, judge_engine
from reference.kernel.conventions import CONVENTIONS
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
    assert {c.right for c in checks} == {CLOSED_FORM, PLAIN_FRAME}
    fixed = {c.quantity for c in checks if c.right == CLOSED_FORM}
    assert len(fixed) == (5 if 3 in laws.dimensions else 4)
    assert max(c.deviation for c in checks if c.right == CLOSED_FORM) <= 2e-15


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


def test_allowances_are_close_to_the_rule_and_have_a_reason():
    for laws in CASES.values():
        for engine, a in laws.allowances.items():
            assert engine in ENGINES
            assert 1e-12 < a.tolerance <= 1e-11
            assert len(a.reason) > 40


def test_tabulated_impacts_are_of_laws_that_there_are():
    values = [v for v in published_values().values() if v.kind == "analytical"]
    assert len(values) >= 9
    for v in values:
        laws, _, what = v.quantity.partition(": ")
        assert laws in CASES
        assert what in MEASURES
