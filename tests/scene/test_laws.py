"""The registry of laws: every law of the scene has its row, and the rows say what their formulas give."""

import math

import msgspec
import pytest

from harness.scene.contact import (
    ConstantRolling,
    Contact,
    MindlinSliding,
    NormalLaw,
    RollingLaw,
    SlidingLaw,
    SpringSliding,
    SpringTorsion,
    ViscousSliding,
)
from harness.scene.grains import Pair
from harness.scene.law_scales import HeadOn
from harness.scene.laws import (
    NORMAL,
    TANGENTIAL,
    elastic_stiffness,
    first_stiffness,
    head_on,
    stiffens,
    tangential_springs,
    turning,
    word,
)

PAIR = Pair(name="a", reduced_mass=4e-6, reduced_radius=0.7e-3)


def law_of(table, **changes) -> NormalLaw:
    return msgspec.convert({"normal": table | changes}, Contact).normal


def test_mindlin_is_8_g_a(scenes):
    hertz = law_of(scenes.normals["hertz"], restitution=0.5)
    met = head_on(hertz, PAIR)
    shear = 1e8 / (4 * (2 - 0.3) * (1 + 0.3))
    stiffness = 8 * shear * math.sqrt(PAIR.reduced_radius * met.largest_overlap)
    beta = math.log(2) / math.sqrt(math.log(2) ** 2 + math.pi**2)
    found = tangential_springs(MindlinSliding(shear_friction=0.5), hertz, met)
    assert found.stiffness == pytest.approx(stiffness, rel=1e-12)
    damping = math.sqrt(10 / 3) * beta * math.sqrt(stiffness * PAIR.reduced_mass)
    assert found.damping == pytest.approx(damping, rel=1e-12)


def test_springs_of_the_other_laws(scenes):
    normal = law_of(scenes.normals["linear"])
    met = head_on(normal, PAIR)
    assert tangential_springs(None, normal, met) == (0.0, 0.0)
    assert tangential_springs(ViscousSliding(shear_friction=0.5, shear_damping=0.3), normal, met) == (0.0, 0.3)
    spring = SpringSliding(shear_friction=0.5, shear_stiffness=2e4, shear_damping=0.1)
    assert tangential_springs(spring, normal, met) == (2e4, 0.1)


def test_every_law_of_the_scene_has_its_row(scenes):
    assert set(NORMAL) == set(NormalLaw.__args__)
    assert set(TANGENTIAL) == {*SlidingLaw.__args__, *RollingLaw.__args__, SpringTorsion}
    for name, table in scenes.normals.items():
        law = law_of(table)
        assert word(law) == name
        assert isinstance(head_on(law, PAIR), HeadOn)
        assert NORMAL[type(law)].numbers(law)


def test_stiffness_of_packings_and_of_energies(scenes):
    laws = {name: law_of(table) for name, table in scenes.normals.items()}
    assert first_stiffness(laws["linear"]) == 1e5
    assert first_stiffness(laws["hysteretic"]) == first_stiffness(laws["hysteretic_variable"]) == 5e4
    with pytest.raises(TypeError, match="no packing can be balanced under hertz"):
        first_stiffness(laws["hertz"])
    assert {n for n, law in laws.items() if elastic_stiffness(law) is not None} == {"linear"}
    assert elastic_stiffness(None) is None
    assert elastic_stiffness(ViscousSliding(shear_friction=0.5, shear_damping=0.3)) is None
    assert {n for n, law in laws.items() if stiffens(law)} == {"hertz", "dmt", "jkr"}


def test_what_turns_particles(scenes):
    normal = law_of(scenes.normals["linear"])
    assert turning(Contact(normal=normal)) == ()
    viscous, constant = ViscousSliding(shear_friction=0.5, shear_damping=0.3), ConstantRolling(rolling_friction=0.1)
    assert turning(Contact(normal=normal, rolling=constant)) == ("rolling",)
    torsion = SpringTorsion(torsion_friction=0.1, torsion_stiffness=1.0, torsion_damping=0.0)
    assert turning(Contact(normal=normal, sliding=viscous, torsion=torsion)) == ("sliding", "torsion")
    assert TANGENTIAL[ConstantRolling].springs(constant, normal, head_on(normal, PAIR)) == (0.0, 0.0)
