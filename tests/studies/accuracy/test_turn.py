"""A knob changes what it says and nothing else."""

from pathlib import Path

import msgspec
import numpy as np
import pytest

from harness.scene.contact import (
    Contact,
    DmtNormal,
    HertzNormal,
    HystereticNormal,
    LinearNormal,
    MindlinSliding,
    SpringRolling,
    SpringSliding,
)
from harness.scene.derived import derive, peak_inertial_number
from harness.scene.grains import Pair
from harness.scene.laws import head_on
from harness.scene.load import load_scene
from harness.studies.accuracy.simpler import simpler_laws
from harness.studies.accuracy.turn import stepped_system, stiffened, turned, why_not_stiffened

FOLDER = Path(__file__).resolve().parents[3] / "inputs" / "scenes"
PAIR = Pair(name="pair", reduced_mass=5e-6, reduced_radius=5e-4)


@pytest.fixture
def box():
    return load_scene(FOLDER / "biaxial_quick.toml")


@pytest.fixture
def ring():
    return load_scene(FOLDER / "couette_quick.toml")


def flat(value, place=""):
    if isinstance(value, dict):
        return {k: v for name, of in value.items() for k, v in flat(of, f"{place}.{name}" if place else name).items()}
    return {place: value}


def changed(before, after):
    """Ratio of what changed, by place."""
    a, b = (flat(msgspec.to_builtins(s)) for s in (before, after))
    assert a.keys() == b.keys()
    return {name: b[name] / a[name] for name in a if a[name] != b[name]}


def test_stiffness_scales_springs_and_the_root_of_it_dashpots(box):
    assert changed(box, turned(box, "stiffness", 0.25)) == {
        "contact.normal.normal_stiffness": 0.25, "contact.normal.normal_damping": 0.5,
        "contact.sliding.shear_stiffness": 0.25, "contact.sliding.shear_damping": 0.5,
    }


@pytest.mark.parametrize("factor", [1 / 64, 1 / 3, 4.0])
def test_stiffness_keeps_restitution_and_ratios_and_the_part_of_a_contact_time(box, factor):
    soft = turned(box, "stiffness", factor)
    before, after = (head_on(s.contact.normal, PAIR) for s in (box, soft))
    assert after.time_scale == pytest.approx(before.time_scale / factor**0.5, rel=1e-14)
    kept = [{f.name: f.value for f in met.facts if "restitution" in f.name} for met in (before, after)]
    assert len(kept[0]) == 2
    assert kept[1] == pytest.approx(kept[0], rel=1e-12)
    for s in (box, soft):
        assert s.contact.sliding.shear_stiffness / s.contact.normal.normal_stiffness == pytest.approx(0.2, rel=1e-15)
    dt = [derive(s).plan.dt for s in (box, soft)]
    assert dt[1] / dt[0] == pytest.approx(factor**-0.5, rel=0.05), "whole numbers of steps"


def test_adhesion_by_surface_energy_has_no_such_knob():
    normal = DmtNormal(youngs_modulus=1e7, poisson_ratio=0.3, surface_energy=0.1, normal_damping=0.02, impact_speed=0.1)
    assert "surface energy" in why_not_stiffened(normal)
    assert why_not_stiffened(LinearNormal(normal_stiffness=1e5, normal_damping=0.1, attraction="allowed")) == ""


def test_a_constant_dashpot_on_hertz_keeps_its_restitution():
    """Integrated: a head-on impact of m x'' = -K x^(3/2) - gamma x' at one speed."""
    def exit_speed(stiffness, damping, mass=1e-5, speed=0.1):
        from scipy.integrate import solve_ivp

        def force(_, y):
            return [y[1], (-stiffness * max(y[0], 0.0) ** 1.5 - damping * y[1]) / mass]

        def parted(_, y):
            return y[0]

        parted.terminal, parted.direction = True, -1
        found = solve_ivp(force, (0, 1), [0.0, speed], events=parted, rtol=1e-10, atol=1e-14, max_step=1e-5)
        return -found.y[1, -1] / speed

    factor = 1 / 16
    hertz = HertzNormal(youngs_modulus=1e7, poisson_ratio=0.3, restitution=0.8, attraction="clipped", impact_speed=0.1)
    rolling = SpringRolling(rolling_friction=0.1, rolling_stiffness=100.0, rolling_damping=0.02)
    soft = stiffened(Contact(normal=hertz, rolling=rolling), factor)
    assert (soft.normal.youngs_modulus, soft.normal.restitution) == (1e7 * factor, 0.8)
    assert soft.rolling.rolling_damping == pytest.approx(0.02 * factor**0.4)
    assert exit_speed(1e6 * factor, 0.02 * factor**0.4) == pytest.approx(exit_speed(1e6, 0.02), rel=1e-6)
    assert exit_speed(1e6 * factor, 0.02 * factor**0.5) != pytest.approx(exit_speed(1e6, 0.02), rel=1e-2)


def test_hysteretic_laws_keep_their_ratios():
    law = HystereticNormal(loading_stiffness=5e4, unloading_stiffness=1e5, adhesion_stiffness=2e5, normal_damping=0.1)
    soft = stiffened(Contact(normal=law), 0.01).normal
    assert (soft.loading_stiffness, soft.unloading_stiffness, soft.adhesion_stiffness) == (5e2, 1e3, 2e3)
    assert soft.normal_damping == pytest.approx(0.01)


def test_rate_of_a_box_changes_the_duration_alone(box):
    fast = turned(box, "rate", 4.0)
    assert changed(box, fast) == {"top.duration": 0.25}
    assert peak_inertial_number(fast) == pytest.approx(4.0 * peak_inertial_number(box), rel=1e-14)


def test_rate_of_a_ring_keeps_the_angle(ring):
    fast = turned(ring, "rate", 4.0)
    assert changed(ring, fast) == {"rings.omega": 4.0, "duration": 0.25, "compare.steady_from": 0.25}
    assert fast.rings.omega * fast.duration == pytest.approx(ring.rings.omega * ring.duration, rel=1e-15)


def test_size_keeps_the_inertial_number(box):
    small = turned(box, "size", 50.0)
    assert changed(box, small) == {"particles.count": 0.25}
    assert peak_inertial_number(small) == pytest.approx(peak_inertial_number(box), rel=1e-14)


@pytest.mark.parametrize("knob", ["dt", "width", "law"])
def test_other_knobs_leave_the_scene_alone(box, knob):
    assert turned(box, knob, 0.5) is box


def test_a_step_beyond_the_limit_is_taken_all_the_same(box, some_discs):
    """The scene refuses it; the study wants to see where it ends."""
    system = some_discs
    coarse = stepped_system(box, system, 0.09)
    assert coarse.dt == pytest.approx(2.0 * stepped_system(box, system, 0.045).dt, rel=0.02)
    assert coarse.dt * coarse.steps == pytest.approx(box.duration, rel=1e-12)
    same = {"dt", "steps", "sample_every", "frame_every"}
    a, b = system.identity(), coarse.identity()
    assert {k for k in a if a[k] != b[k]} <= same


@pytest.fixture
def some_discs(box):
    from harness.scene.resolve import resolve_biaxial

    places = np.array([[x, y] for y in (1, 3, 5, 7) for x in (1, 3, 5, 7)]) * 1e-3
    return resolve_biaxial(box, places, np.full(16, 1e-3), (8e-3, 8e-3))


# --- laws ----------------------------------------------------------------------------------------------


def test_simpler_laws_of_the_box(box):
    found = {s.name: s.contact for s in simpler_laws(box.contact, PAIR)}
    assert list(found) == ["as declared", "viscous sliding", "no sliding"]
    viscous = found["viscous sliding"]
    assert (viscous.sliding.shear_friction, viscous.sliding.shear_damping) == (0.5, 0.125)
    assert viscous.normal == box.contact.normal
    assert found["no sliding"].sliding is None


def test_linear_springs_take_as_long_as_hertz_and_lose_as_much():
    hertz = HertzNormal(youngs_modulus=1e7, poisson_ratio=0.3, restitution=0.8, attraction="clipped", impact_speed=0.1)
    contact = Contact(normal=hertz, sliding=MindlinSliding(shear_friction=0.4))
    linear = {s.name: s.contact for s in simpler_laws(contact, PAIR)}["linear springs"]
    k, gamma, m = linear.normal.normal_stiffness, linear.normal.normal_damping, PAIR.reduced_mass
    b = gamma / (2.0 * m)
    time = np.pi / np.sqrt(k / m - b**2)
    assert time == pytest.approx(head_on(hertz, PAIR).time_scale, rel=1e-12)
    assert np.exp(-b * time) == pytest.approx(0.8, rel=1e-12)
    assert linear.sliding.shear_stiffness / k == pytest.approx(2 * 0.7 / 1.7)


def test_frictionless_linear_laws_have_nothing_simpler():
    contact = Contact(normal=LinearNormal(normal_stiffness=1e5, normal_damping=0.1, attraction="allowed"))
    assert [s.name for s in simpler_laws(contact, PAIR)] == ["as declared"]
    spring = SpringSliding(shear_friction=0.5, shear_stiffness=1e4, shear_damping=0.0)
    names = [s.name for s in simpler_laws(msgspec.structs.replace(contact, sliding=spring), PAIR)]
    assert names == ["as declared", "viscous sliding", "no sliding"]
