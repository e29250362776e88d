"""The registry of cases, and the systems it leads to."""

import dataclasses

import numpy as np
import pytest

from harness.studies.bench.cases import CASES, ELASTIC, FRICTION, GAMMA, MASS, RESTITUTION, STIFFNESS, find_case
from harness.studies.bench.problem import STEPS_A_CONTACT, problem, time_step
from reference.analytic.linear_collision import LinearCollision


def test_names_are_unique_and_bases_are_cases_of_the_same_dimension():
    assert len({c.name for c in CASES}) == len(CASES)
    for case in CASES:
        if case.base is not None:
            assert find_case(case.base).dimension == case.dimension
            assert case.base != case.name


def test_a_case_differs_from_its_base_in_what_its_name_says():
    """One effect more, or another: apart from names and sizes one field differs (with the skin two)."""
    for case in CASES:
        if case.base is not None:
            mine, base = (dataclasses.asdict(c) for c in (case, find_case(case.base)))
            changed = {k for k in mine if mine[k] != base[k]} - {"name", "base", "quick", "full", "skin"}
            assert len(changed) == 1, case.name


def test_sizes_are_what_the_command_promises():
    assert max(n for c in CASES for n in c.quick) == 20_000
    assert min(n for c in CASES for n in c.full) == 100
    assert max(n for c in CASES for n in c.full) == 100_000
    assert all(list(c.full) == sorted(c.full) and list(c.quick) == sorted(c.quick) for c in CASES)


def test_the_dashpot_has_its_restitution():
    met = LinearCollision(stiffness=STIFFNESS, damping=GAMMA, reduced_mass=MASS / 2)
    assert met.restitution("allowed") == pytest.approx(RESTITUTION, rel=1e-12)


def test_a_contact_takes_its_number_of_steps():
    met = LinearCollision(stiffness=STIFFNESS, damping=0.0, reduced_mass=MASS / 2)
    assert met.duration("allowed") / time_step(find_case("2D elastic")) == pytest.approx(STEPS_A_CONTACT)
    stiffest = find_case("2D friction, adhesive")
    ratio = stiffest.normal.unloading_stiffness / ELASTIC.normal_stiffness
    assert time_step(find_case("2D elastic")) / time_step(stiffest) == pytest.approx(ratio**0.5)


@pytest.mark.parametrize("case", CASES, ids=lambda c: c.name)
def test_every_case_leads_to_a_system(case, tmp_path):
    system, packing = problem(case, 12, cache=tmp_path)
    p = system.particles
    assert len(p) == 12
    assert np.ptp(p.mass) == 0.0
    assert set(p.inertia_factor) == {0.5 if case.dimension == 2 else 0.4}
    assert len(system.walls) == (2 * case.dimension if case.walls else 0)
    assert (system.periodic is None) == case.walls
    assert np.std(p.v) == pytest.approx(case.speed, rel=0.5)
    assert p.radius.max() < packing.box.min()
    if case.sliding:
        assert system.sliding.shear_friction == FRICTION


def test_walls_close_the_box_and_look_inwards(tmp_path):
    system, packing = problem(find_case("3D friction"), 12, cache=tmp_path)
    inside = 0.5e-3 * packing.box
    for wall in system.walls:
        assert np.dot(inside - wall.point, wall.normal) == pytest.approx(np.abs(np.dot(inside, wall.normal)))
    assert len({w.name for w in system.walls}) == 6
    heights = [(system.particles.x - w.point) @ np.array(w.normal) for w in system.walls]
    assert min(h.min() for h in heights) > 0.0
