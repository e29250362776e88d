"""What LIGGGHTS cannot do is said, with its own reason; whatever is not refused can be written as a deck."""

from __future__ import annotations

import itertools

import numpy as np
import pytest

from harness.engines.liggghts import LIGGGHTS
from harness.engines.liggghts.law.dashpot import FAINT, damping, restitution
from harness.engines.liggghts.law.kinds import MOST_BODIES
from harness.engines.protocol import PATH_FILE, REFUSED
from harness.scene.contact import (
    ConstantRolling,
    DmtNormal,
    HertzNormal,
    HystereticNormal,
    JkrNormal,
    LinearNormal,
    MindlinSliding,
    SpringRolling,
    SpringSliding,
    SpringTorsion,
    VariableHystereticNormal,
    ViscousSliding,
)
from harness.scene.system import Constant

PLASTIC = {"loading_stiffness": 100.0, "adhesion_stiffness": 50.0, "normal_damping": 0.3}
ELASTIC = {"youngs_modulus": 1e7, "poisson_ratio": 0.3, "impact_speed": 1.0}
NORMAL = {
    "linear": LinearNormal(normal_stiffness=200.0, normal_damping=0.5, attraction="allowed"),
    "hertz": HertzNormal(**ELASTIC, restitution=0.5, attraction="allowed"),
    "hysteretic": HystereticNormal(**PLASTIC, unloading_stiffness=200.0),
    "hysteretic_variable": VariableHystereticNormal(
        **PLASTIC, largest_unloading_stiffness=200.0, plasticity_depth=0.05),
    "dmt": DmtNormal(**ELASTIC, surface_energy=0.1, normal_damping=0.1),
    "jkr": JkrNormal(**ELASTIC, surface_energy=0.1, normal_damping=0.1),
}
SLIDING = {
    "": None, "spring": SpringSliding(shear_friction=0.3, shear_stiffness=60.0, shear_damping=0.2),
    "dynamic": SpringSliding(shear_friction=0.3, shear_stiffness=60.0, shear_damping=0.2, dynamic_friction=0.2),
    "mindlin": MindlinSliding(shear_friction=0.3), "viscous": ViscousSliding(shear_friction=0.3, shear_damping=0.7),
}
ROLLING = {
    "": None, "spring": SpringRolling(rolling_friction=0.1, rolling_stiffness=30.0, rolling_damping=0.1),
    "constant": ConstantRolling(rolling_friction=0.1),
}
TORSION = SpringTorsion(torsion_friction=0.1, torsion_stiffness=30.0, torsion_damping=0.1)

CANNOT = [
    ("dmt", "", "", "no normal model dmt"), ("jkr", "", "", "no normal model jkr"),
    ("linear", "dynamic", "", "second coefficient"), ("hertz", "spring", "", "no other tangential stiffness"),
    ("hertz", "viscous", "", "dashpot of the normal model"),
    ("hysteretic", "viscous", "", "dashpot of the normal model"),
    ("hertz", "", "spring", "multiple of k_n"), ("hysteretic", "", "constant", "not the elastic force"),
]


@pytest.fixture(name="two")
def _two(make):
    """Return two bodies with laws; they do not touch."""
    def two(dimension=2, **rest):
        given = {"contacts": False, "x": np.pad([[0.0, 0.0], [1.1, 0.0]], [(0, 0), (0, dimension - 2)])}
        return make(**(given | rest))

    return two


def refusals(system) -> list[str]:
    return [s.note for s in LIGGGHTS.supports(system) if s.level in REFUSED]


def test_every_combination_of_laws_is_judged_or_rendered(two, plane):
    rendered = 0
    for dimension in (2, 3):
        walls = [plane(1, "floor", (0, -2, 0)[:dimension], (0, 1, 0)[:dimension], True)]
        for normal, sliding, rolling in itertools.product(NORMAL.values(), SLIDING.values(), ROLLING.values()):
            system = two(dimension, normal=normal, sliding=sliding, rolling=rolling, walls=walls)
            assert all(s.note for s in LIGGGHTS.supports(system))
            if not refusals(system):
                assert LIGGGHTS.render(system)
                assert LIGGGHTS.render_prescribed(system)
                rendered += 1
    assert rendered >= 20


@pytest.mark.parametrize(("normal", "sliding", "rolling", "reason"), CANNOT)
def test_laws_it_does_not_have(two, normal, sliding, rolling, reason):
    found = refusals(two(normal=NORMAL[normal], sliding=SLIDING[sliding], rolling=ROLLING[rolling]))
    assert any(reason in note for note in found), found


def test_torsion_resistance(two):
    assert "torsionTorque on" in refusals(two(3, torsion=TORSION))[0]


@pytest.mark.parametrize(("normal", "reason"), [
    (HertzNormal(**(ELASTIC | {"poisson_ratio": -0.2}), restitution=0.5, attraction="allowed"), "poissonsRatio"),
    (HertzNormal(**ELASTIC, restitution=0.04, attraction="allowed"), "0.05 < coefficientRestitution"),
    (HystereticNormal(**(PLASTIC | {"normal_damping": 12.0}), unloading_stiffness=200.0), "0.05 < coefficientRestitu"),
    (HystereticNormal(**(PLASTIC | {"normal_damping": 30.0}), unloading_stiffness=200.0), "restitution 0:"),
])
def test_numbers_it_refuses(two, normal, reason):
    assert reason in refusals(two(normal=normal))[0]


def test_a_rolling_spring_too_soft_for_its_friction(two):
    soft = SpringRolling(rolling_friction=0.5, rolling_stiffness=30.0, rolling_damping=0.0)
    assert "rollingStiffness >= 1" in refusals(two(sliding=SLIDING["spring"], rolling=soft))[0]
    assert not refusals(two(rolling=soft))


def test_a_dashpot_by_bodies_wants_few_different_ones(make):
    count = MOST_BODIES + 1
    x = [[2.5 * k, 0.0] for k in range(count)]

    def notes(masses, **damping):
        normal = HystereticNormal(**(PLASTIC | damping), unloading_stiffness=200.0)
        return refusals(make(x=x, mass=masses, normal=normal, contacts=False))

    different = 1.0 + 0.01 * np.arange(count)
    assert "not 13" in notes(different)[0]
    assert not notes(np.minimum(different, different[-2]))
    assert not notes(different, normal_damping=0.0)


def test_a_periodic_axis_and_constant_k2(two):
    periodic = {"x": [[2.0, 2.0], [3.1, 2.0]], "periodic": (5.0, 0.0)}
    assert "periodic boundary" in refusals(two(**periodic, normal=NORMAL["hysteretic"]))[0]
    assert not refusals(two(**periodic, normal=NORMAL["hysteretic_variable"]))


def test_contact_output_that_would_change_the_run(two):
    def judged(contacts=True, **laws):
        found = LIGGGHTS.supports(two(contacts=contacts, **laws))
        return [s.level for s in found if s.effect == "contact output"]

    damped, springs = NORMAL["hysteretic"], SLIDING["spring"]
    quiet = HystereticNormal(**(PLASTIC | {"normal_damping": 0.0}), unloading_stiffness=200.0)
    undamped = SpringSliding(shear_friction=0.3, shear_stiffness=60.0, shear_damping=0.0)
    assert judged(normal=damped, sliding=springs) == ["unsupported"]
    assert judged(normal=quiet, rolling=ROLLING["spring"]) == ["unsupported"]
    assert judged(normal=quiet, sliding=springs) == ["partial"]
    assert judged(normal=quiet, sliding=undamped) == judged(normal=damped) == []
    assert judged(contacts=False, normal=damped, sliding=springs) == []


@pytest.mark.parametrize("gamma", [1e-9, 1e-3, 0.3, 7.0])
def test_a_dashpot_becomes_a_restitution_and_back(gamma):
    """To the digits of e, which lie around 1: absolutely, a rounding of the critical dashpot."""
    found = damping(restitution(gamma, 0.5, 100.0), 0.5, 100.0)
    assert found == pytest.approx(gamma, rel=1e-13, abs=1e-15 * np.sqrt(4.0 * 0.5 * 100.0))


def test_the_faintest_dashpot_is_below_rounding():
    assert 0.0 < damping(FAINT, 0.5, 100.0) < 1e-15 * np.sqrt(0.5 * 100.0)


def test_prescribed_motion_refuses_what_moves_by_itself(two, plane):
    moving = plane(1, "floor", (0, 0), (0, 1), False, Constant(velocity=(1.0, 0.0)))
    for change in ({"periodic": (5.0, 0.0)}, {"walls": [moving]}):
        with pytest.raises(ValueError, match="fixed planes and open axes"):
            LIGGGHTS.render_prescribed(two(**change))


@pytest.mark.needs_liggghts
@pytest.mark.parametrize(("x", "reason"), [
    (np.zeros((3, 3, 2)), "has 3 bodies, the deck 2"),
    (np.full((3, 2, 2), 1e3), "leads a body more than 3 radii away"),
    (np.full((3, 2, 2), np.nan), "leads a body more than 3 radii away"),
])
def test_a_path_that_does_not_fit_is_told(two, tmp_path, x, reason):
    for name, text in LIGGGHTS.render_prescribed(two()).items():
        (tmp_path / name).write_text(text)
    np.savez(tmp_path / PATH_FILE, x=x, v=np.zeros_like(x), spin=np.zeros((*x.shape[:2], 1)))
    result = LIGGGHTS.run_prescribed(tmp_path, time_limit=20)
    assert result.status == "crashed"
    assert reason in result.reason


@pytest.mark.needs_liggghts
def test_an_error_of_the_lab_is_told(two, tmp_path):
    for name, text in LIGGGHTS.render_prescribed(two()).items():
        (tmp_path / name).write_text(text.replace("hooke/stiffness", "hoooke"))
    np.savez(tmp_path / PATH_FILE, x=np.zeros((1, 2, 2)), v=np.zeros((1, 2, 2)), spin=np.zeros((1, 2, 1)))
    result = LIGGGHTS.run_prescribed(tmp_path, time_limit=20)
    assert result.status == "crashed"
    assert "Invalid model specified" in result.reason
