"""What the scene says of a law head-on, against the kernel's law driven through the same collision."""

import math

import msgspec
import numpy as np
import pytest

from harness.scene.contact import Contact, NormalLaw
from harness.scene.grains import Pair
from harness.scene.laws import head_on
from reference.kernel.conventions import TALK
from reference.kernel.laws.contact import Touching
from reference.kernel.laws.registry import build_law

PAIR = Pair(name="a", reduced_mass=4e-6, reduced_radius=0.7e-3)


def law_of(table, **changes) -> NormalLaw:
    return msgspec.convert({"normal": table | changes}, Contact).normal


def collide(law: NormalLaw, speed: float, steps_per_scale: int = 4000):
    """Drive the kernel's own law through a head-on collision; return e, contact time and largest overlap.

    Velocity Verlet on the overlap, dashpots at the half step; e is None if the bodies stay together for long.
    """
    table = {k: v for k, v in msgspec.to_builtins(law).items() if k != "impact_speed"}
    kernel = build_law("normal", table, TALK)
    dt = head_on(law, PAIR).time_scale / steps_per_scale
    memory = np.zeros((kernel.memory_rows(3), 1)) if kernel.memory_rows(3) else None
    overlap, rate, force, largest = 1e-300, speed, 0.0, 0.0
    for step in range(1, 40 * steps_per_scale):
        rate -= 0.5 * dt * force / PAIR.reduced_mass
        overlap += dt * rate
        if overlap <= 0.0:
            return -rate / speed, dt * step, largest
        largest = max(largest, overlap)
        contact = touching(overlap, -rate)
        total, _, memory = kernel.force(contact, memory)
        force = float(total[0])
        rate -= 0.5 * dt * force / PAIR.reduced_mass
    return None, math.inf, largest


def touching(overlap: float, v_n: float) -> Touching:
    one = np.ones(1)
    known = {
        "i": np.zeros(1, int), "j": np.ones(1, int), "n": np.array([[1.0], [0.0], [0.0]]), "overlap": overlap * one,
        "v_n": v_n * one, "reduced_radius": PAIR.reduced_radius * one, "reduced_mass": PAIR.reduced_mass * one,
    }
    return Touching(**{k: v for k, v in known.items() if k in Touching.__dataclass_fields__})


def said(law: NormalLaw, name: str):
    return head_on(law, PAIR).fact(name).value


@pytest.mark.parametrize("attraction", ["allowed", "clipped"])
def test_linear(scenes, attraction):
    law = law_of(scenes.normals["linear"], attraction=attraction)
    if attraction == "allowed":
        e, time, _ = collide(law, 0.1)
        assert time == pytest.approx(head_on(law, PAIR).time_scale, rel=2e-3)
        assert e == pytest.approx(said(law, "restitution, attraction allowed"), rel=2e-3)
    notes = {f.name: f.note for f in head_on(law, PAIR).facts if f.name.startswith("restitution")}
    assert notes.pop(f"restitution, attraction {attraction}") == "as in the scene"
    assert list(notes.values()) == ["for comparison"]


def test_hertz(scenes):
    law = law_of(scenes.normals["hertz"], restitution=0.7)
    e, time, largest = collide(law, law.impact_speed)
    met = head_on(law, PAIR)
    assert e == pytest.approx(0.7, rel=2e-3)
    assert said(law, "restitution, attraction allowed") == pytest.approx(0.7, rel=1e-12)
    assert time == pytest.approx(met.time_scale, rel=2e-3)
    assert largest == pytest.approx(said(law, "largest overlap"), rel=2e-3)
    assert met.largest_overlap == said(law, "largest overlap")
    assert elastic_slope(law, met.largest_overlap) == pytest.approx(met.stiffness, rel=1e-5)
    assert dashpot(law, met.largest_overlap) == pytest.approx(met.damping, rel=1e-9)


def kernel_force(law, overlap, v_n):
    table = {k: v for k, v in msgspec.to_builtins(law).items() if k != "impact_speed"}
    return float(build_law("normal", table, TALK).force(touching(overlap, v_n), None)[0][0])


def elastic_slope(law, overlap):
    less, more = (kernel_force(law, overlap * (1 + sign * 1e-6), 0.0) for sign in (-1, 1))
    return (more - less) / (2e-6 * overlap)


def dashpot(law, overlap):
    return (kernel_force(law, overlap, 0.0) - kernel_force(law, overlap, 1e-3)) / 1e-3


def test_hysteretic(scenes):
    law = law_of(scenes.normals["hysteretic"], normal_damping=0.0)
    e, time, _ = collide(law, 0.1)
    assert e == pytest.approx(said(law, "restitution"), rel=2e-3)
    assert time == pytest.approx(said(law, "contact time"), rel=2e-3)
    met = head_on(law, PAIR)
    assert met.time_scale == pytest.approx(math.pi * math.sqrt(PAIR.reduced_mass / 1e5), rel=1e-14)
    assert (met.stiffness, met.damping, met.largest_overlap) == (1e5, 0.0, None)
    assert said(law, "least k_c that sticks") is None
    assert "k_2 <= 2 k_1" in met.fact("least k_c that sticks").note


def test_hysteretic_that_sticks(scenes):
    law = law_of(scenes.normals["hysteretic"], normal_damping=0.0, unloading_stiffness=2e5)
    least = said(law, "least k_c that sticks")
    for factor, sticks in ((0.9, False), (1.1, True)):
        sticky = law_of(msgspec.to_builtins(law), adhesion_stiffness=factor * least)
        e, _, _ = collide(sticky, 0.1, 1000)
        assert (e is None) is sticks
        assert (said(sticky, "restitution") == 0.0) is sticks
        assert (said(sticky, "contact time") is None) is sticks


def test_hysteretic_variable(scenes):
    law = law_of(scenes.normals["hysteretic_variable"], normal_damping=0.0, plasticity_depth=0.01)
    speed = said(law, "speed that reaches it")
    e, _, largest = collide(law, speed)
    assert largest == pytest.approx(said(law, "plastic limit delta_max*"), rel=2e-3)
    assert e == pytest.approx(said(law, "restitution"), rel=2e-3)
    assert head_on(law, PAIR).stiffness == 1e5


def test_hysteretic_variable_sticks_between_two_speeds(scenes):
    law = law_of(
        scenes.normals["hysteretic_variable"], normal_damping=0.0, largest_unloading_stiffness=4e5,
        adhesion_stiffness=2e5,
    )
    low, high = said(law, "lowest speed that sticks"), said(law, "highest speed that sticks")
    sticks = [collide(law, v, 1000)[0] is None for v in (0.9 * low, 1.1 * low, 0.9 * high, 1.1 * high)]
    assert sticks == [False, True, True, False]


def test_dmt(scenes):
    law = law_of(scenes.normals["dmt"], normal_damping=0.0)
    e, _, largest = collide(law, law.impact_speed)
    met = head_on(law, PAIR)
    assert e == pytest.approx(1.0, rel=2e-3)
    assert said(law, "restitution") == 1.0
    assert largest == pytest.approx(met.largest_overlap, rel=2e-3)
    assert elastic_slope(law, met.largest_overlap) == pytest.approx(met.stiffness, rel=1e-5)
    assert kernel_force(law, 1e-15, 0.0) == pytest.approx(-said(law, "pull-off force"), rel=1e-3)


def test_jkr(scenes):
    law = law_of(scenes.normals["jkr"], normal_damping=0.0)
    assert said(law, "pull-off force") == pytest.approx(3 * math.pi * 0.05 * 0.7e-3)
    assert said(law, "tearing overlap") < 0 < said(law, "sticking speed") < law.impact_speed
    assert said(law, "restitution") == pytest.approx(math.sqrt(1 - (said(law, "sticking speed") / 0.1) ** 2))


@pytest.mark.parametrize("law", ["hysteretic", "hysteretic_variable", "dmt", "jkr"])
def test_with_damping_there_is_no_closed_form_and_it_is_said(scenes, law):
    fact = head_on(law_of(scenes.normals[law]), PAIR).fact("restitution")
    assert fact.value is None
    assert fact.note == "no closed form with normal_damping"


@pytest.mark.parametrize("law", ["dmt", "jkr"])
def test_adhesive_time_scale_is_that_of_hertz_without_adhesion(scenes, law):
    bare = law_of(scenes.normals["hertz"], restitution=1.0)
    weak = law_of(scenes.normals[law], surface_energy=1e-9, normal_damping=0.0)
    assert head_on(weak, PAIR).time_scale == pytest.approx(head_on(bare, PAIR).time_scale, rel=1e-3)
    assert head_on(weak, PAIR).stiffness == pytest.approx(head_on(bare, PAIR).stiffness, rel=1e-3)
    strong = law_of(scenes.normals[law], surface_energy=1.0)
    assert head_on(strong, PAIR).largest_overlap > head_on(weak, PAIR).largest_overlap
