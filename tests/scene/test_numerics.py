"""The time step: its unit, its limit against exact modes and measured runs, and the rounding of steps."""

import math

import numpy as np
import pytest

from harness.scene.contact import Contact, LinearNormal, SpringRolling, SpringSliding, SpringTorsion
from harness.scene.derived import derive
from harness.scene.grains import Grains, Pair, grains_of
from harness.scene.model import Biaxial
from harness.scene.numerics import leapfrog_limit, plan_steps, stability_limit
from harness.scene.resolve import resolve


def unit_grains(q=0.5, dimension=2):
    return Grains(
        dimension=dimension, count=1000, mean_mass=1.0, total_mass=1000.0, largest_radius=1.0,
        pairs=(Pair(name="smallest", reduced_mass=0.5, reduced_radius=0.5),), inverse_mass=1.0, inverse_turning=1 / q,
        lightest=Pair(name="lightest", reduced_mass=1.0, reduced_radius=1.0),
        heaviest=Pair(name="heaviest", reduced_mass=1.0, reduced_radius=1.0), turning_share=1.0,
    )


def limit(scenes, *, kt=None, gn=0.0, gt=0.0, kr=None, ko=None, q=0.5, dimension=2):
    """Stability limit in units of sqrt(m/k_n), with a wall too heavy to matter."""
    scene = scenes.load(scenes.free, {"dimension": 2})
    sliding = None if kt is None else SpringSliding(shear_friction=1.0, shear_stiffness=kt, shear_damping=gt)
    normal = LinearNormal(normal_stiffness=1.0, normal_damping=gn, attraction="allowed")
    rolling = None if kr is None else SpringRolling(rolling_friction=1.0, rolling_stiffness=kr, rolling_damping=0.0)
    torsion = None if ko is None else SpringTorsion(torsion_friction=1.0, torsion_stiffness=ko, torsion_damping=0.0)
    scene = type(scene)(**{f: getattr(scene, f) for f in scene.__struct_fields__ if f != "contact"},
                        contact=Contact(normal=normal, sliding=sliding, rolling=rolling, torsion=torsion))
    return stability_limit(scene, unit_grains(q, dimension)).dt


def lattice_frequency(kt, q, kr=0.0):
    """Largest w^2 (k_n = m = a = 1) of a triangular lattice of discs that turn, over its Bloch waves.

    Contact in direction n, t its tangent: slip = t.(u_i - u_j) - a (theta_i + theta_j), rolling
    = a/2 (theta_i - theta_j); rows below are their amplitudes in one contact for u_x, u_y and theta sqrt(q).
    """
    largest = 0.0
    angles = np.arange(3) * np.pi / 3
    for kx, ky in np.stack(np.meshgrid(*[np.linspace(0, 2 * np.pi, 25)] * 2), -1).reshape(-1, 2):
        stiffness = np.zeros((3, 3), complex)
        for n in np.column_stack([np.cos(angles), np.sin(angles)]):
            phase = np.exp(2j * (kx * n[0] + ky * n[1]) / 2)
            normal = np.array([n[0] * (1 - phase), n[1] * (1 - phase), 0])
            slip = np.array([-n[1] * (1 - phase), n[0] * (1 - phase), -(1 + phase) / math.sqrt(q)])
            roll = np.array([0, 0, (1 - phase) / 2 / math.sqrt(q)])
            stiffness += np.outer(normal.conj(), normal) + kt * np.outer(slip.conj(), slip)
            stiffness += kr * np.outer(roll.conj(), roll)
        largest = max(largest, np.linalg.eigvalsh(stiffness)[-1])
    return largest


@pytest.mark.parametrize("q", [0.4, 0.5, 1.0])
@pytest.mark.parametrize("kt", [0.2, 2 / 7, 1.0, 3.0])
def test_limit_covers_every_mode_of_the_triangular_lattice(scenes, kt, q):
    exact = 2 / math.sqrt(lattice_frequency(kt, q))
    assert 0.6 * exact < limit(scenes, kt=kt, q=q) <= exact * (1 + 1e-12)


@pytest.mark.parametrize("q", [0.4, 1.0])
@pytest.mark.parametrize("kt", [0.0, 0.2, 3.0])
@pytest.mark.parametrize("kr", [0.1, 1.0, 30.0])
def test_limit_covers_the_modes_of_rolling(scenes, kt, kr, q):
    """Bounded by one spring at a wall, which weighs as much as two between particles: 0.7 at worst."""
    exact = 2 / math.sqrt(lattice_frequency(kt, q, kr))
    assert 0.5 * exact < limit(scenes, kt=kt or None, kr=kr, q=q) <= exact * (1 + 1e-12)


def test_the_stiffer_one_of_rolling_and_torsion_counts(scenes):
    both = limit(scenes, kr=2.0, ko=3.0, dimension=3)
    assert both == limit(scenes, ko=3.0, dimension=3) == limit(scenes, kr=3.0, dimension=3) < limit(scenes, dimension=3)


def test_sphere_rolling_on_a_plane_is_stable_up_to_its_own_limit(scenes):
    """One spring at a wall: w^2 = k_r/(q m); the bound of a packing lies below."""
    assert limit(scenes, kr=50.0, q=0.4, dimension=3) < 2 / math.sqrt(50.0 / 0.4)


def test_limit_is_exact_for_the_frictionless_lattice(scenes):
    """Known: omega_max^2 = 6 k/m."""
    assert limit(scenes) == pytest.approx(2 / math.sqrt(6), rel=1e-14)
    assert lattice_frequency(0.0, 0.5) == pytest.approx(6.0, rel=1e-3)


def test_limit_in_space_lies_below_that_of_fcc(scenes):
    """Known: omega_max^2 = 8 k/m without friction."""
    assert limit(scenes, dimension=3) < 2 / math.sqrt(8)


@pytest.mark.parametrize(
    ("law", "unstable"),
    [
        ({}, 1.0),
        ({"zeta": 0.03}, 1.0),
        ({"zeta": 0.3}, 0.6),
        ({"kt": 0.3}, 0.9),
        ({"kt": 1.0}, 0.5),
        ({"kt": 1e-9, "zeta": 0.3, "zeta_t": 0.3}, 0.5),
    ],
)
def test_limit_lies_below_what_was_seen_to_explode(scenes, law, unstable):
    """Dense packings of 2000 discs in LAMMPS; dt in sqrt(m_min/k_n), zeta of a pair: gamma = zeta sqrt(2 k m)."""
    dashpots = {"gn": math.sqrt(2) * law.get("zeta", 0.0), "gt": math.sqrt(2) * law.get("zeta_t", 0.0)}
    assert limit(scenes, kt=law.get("kt"), **dashpots) * 1.2 < unstable


@pytest.mark.parametrize("zeta", [0.0, 0.1, 0.9, 3.0])
def test_leapfrog_limit_is_where_the_leapfrog_explodes(zeta):
    """Iterate x'' = -x - 2 zeta x' with the lagged half-step velocity in the dashpot."""
    dt = leapfrog_limit(1.0, 2 * zeta)
    assert dt == pytest.approx(2 * (math.sqrt(1 + zeta**2) - zeta), rel=1e-12)
    assert largest_swing(0.999 * dt, zeta) < 100
    assert largest_swing(1.001 * dt, zeta) > 1e6


def largest_swing(dt, zeta):
    x, v, largest = 1.0, 0.0, 0.0
    for _ in range(20000):
        v += dt * (-x - 2 * zeta * v)
        x += dt * v
        largest = max(largest, abs(x))
        if largest > 1e9:
            break
    return largest


def test_time_step_above_the_limit_is_refused(scenes):
    message = scenes.refusal(scenes.biaxial, {"numerics.dt_fraction": 0.5})
    assert message.startswith(
        "scene.toml: numerics.dt_fraction: expected at most 0.172, the stability limit "
        "dt = 2/omega (sqrt(1 + zeta^2) - zeta) = 1.26e-06 s of the particles, got 0.5 (dt = 3.68e-06 s); lower it"
    )
    largest = derive(scenes.load(scenes.biaxial, {"numerics.dt_fraction": 0.17}))
    assert 1 < largest.stability_margin < 1.05


def test_strong_damping_is_said_to_set_the_limit(scenes):
    """No usual fraction is named where none of the usual ones would do."""
    message = scenes.refusal(scenes.biaxial, {"contact.normal.normal_damping": 50.0})
    allowed = float(message.split("expected at most ")[1].split(",")[0])
    assert allowed < 0.02
    assert message.endswith("is what makes the limit so small")
    assert "lower it, or the damping: zeta = " in message
    scenes.load(scenes.biaxial, {"contact.normal.normal_damping": 50.0, "numerics.dt_fraction": 0.99 * allowed})


def test_light_wall_is_refused(scenes):
    message = scenes.refusal(scenes.biaxial, {"side.mass": 1e-9})
    assert 'of the wall "right", got 0.05' in message
    assert message.endswith("lower it, or make the wall heavier")
    lid = scenes.lid | {"motion": {"kind": "loaded", "mass": 1e-12, "load": 1.0}}
    assert 'of the wall "lid", got' in scenes.refusal(scenes.free, {"planes": [lid]})


def test_strong_drag_is_refused(scenes):
    message = scenes.refusal(scenes.free, {"background": {"translational_drag": 1e3}})
    assert "numerics.dt_fraction: expected at most" in message


def test_overdamped_contacts_have_a_time_scale(scenes):
    scene = scenes.load(scenes.biaxial, {"contact.normal.normal_damping": 2.0, "numerics.dt_fraction": 1e-3})
    smallest = derive(scene).pairs[0]
    assert smallest.met.time_scale == pytest.approx(math.pi * math.sqrt(smallest.pair.reduced_mass / 1e5), rel=1e-14)
    assert smallest.met.fact("damping ratio").value > 1
    assert smallest.met.fact("restitution, attraction allowed").value == 0.0
    assert 0 < smallest.met.fact("restitution, attraction clipped").value < 0.1


def test_smallest_pair_has_the_declared_smallest_radius(scenes):
    """So that all packings of a scene have one time step."""
    scene = scenes.load(scenes.biaxial)
    mass = 4 / 3 * math.pi * 2000 * 0.5e-3**3
    assert grains_of(scene).pairs[0].reduced_mass == pytest.approx(mass / 2, rel=1e-14)
    assert plan_steps(scene, grains_of(scene)).dt <= 0.05 * math.pi / math.sqrt(1e5 / (mass / 2) - (0.1 / mass) ** 2)


@pytest.mark.parametrize(("samples", "frames"), [(20, 10), (1, 1), (7, 3), (1000, 50), (30, 20)])
def test_steps_are_divided_evenly_and_never_too_long(scenes, samples, frames):
    scene = scenes.load(scenes.biaxial, {"outputs.samples": samples, "outputs.frames": frames})
    plan = plan_steps(scene, grains_of(scene))
    assert plan.sample_every * samples == plan.steps
    assert plan.frame_every * frames == plan.steps
    assert plan.dt * plan.steps == pytest.approx(scene.duration, rel=1e-15)
    requested = 0.05 * derive(scene).pairs[0].met.time_scale
    assert requested * (1 - math.lcm(samples, frames) / plan.steps) <= plan.dt <= requested


def test_no_step_is_added_for_round_off(scenes):
    """A duration of exactly 1000 requested steps takes 1000."""
    first = scenes.load(scenes.biaxial)
    requested = 0.05 * derive(first).pairs[0].met.time_scale
    for factor in (1000, 1000 * (1 + 1e-15), 1000 * (1 - 1e-15)):
        scene = scenes.load(scenes.biaxial, {"top.duration": requested * factor})
        assert plan_steps(scene, grains_of(scene)).steps == 1000


def test_outputs_that_do_not_fit_are_refused(scenes):
    message = scenes.refusal(scenes.biaxial, {"outputs.samples": 9973, "outputs.frames": 97})
    assert message.startswith(
        "scene.toml: outputs: expected samples and frames with a common multiple of at most twice the 27150 steps "
        "needed, got samples = 9973, frames = 97; take fewer"
    )


def test_too_many_steps_are_refused(scenes):
    assert scenes.refusal(scenes.biaxial, {"top.duration": 1e6}).startswith(
        "scene.toml: top.duration: expected at most 2000000000 steps of 3.68e-07 s, got 2.71e+12 steps in 1e+06 s"
    )
    assert scenes.refusal(scenes.free, {"duration": 1e6}).startswith("scene.toml: duration: expected at most 2000")


def test_single_particle_takes_the_time_of_a_wall_contact(scenes):
    scene = scenes.load(scenes.free, {"bodies": scenes.free["bodies"][:1], "planes": [scenes.floor]})
    (pair,) = derive(scene, resolve(scene, scenes.file)).pairs
    assert (pair.pair.reduced_mass, pair.pair.reduced_radius) == (1e-5, 1e-3)


def test_lightest_pair_of_unequal_particles(scenes):
    bodies = [
        {"position": [k * 3e-3, 2e-3], "radius": 1e-3, "mass": mass} for k, mass in enumerate([4e-5, 1e-5, 2e-5])
    ]
    scene = scenes.load(scenes.free, {"bodies": bodies})
    smallest, mean, largest = (p.pair for p in derive(scene, resolve(scene, scenes.file)).pairs)
    assert smallest.reduced_mass == pytest.approx(1e-5 * 2e-5 / 3e-5, rel=1e-15)
    assert mean.reduced_mass == pytest.approx(7e-5 / 6, rel=1e-15)
    assert largest.reduced_mass == pytest.approx(2e-5 * 4e-5 / 6e-5, rel=1e-15)


def test_schema_is_that_of_the_box(scenes):
    assert isinstance(scenes.load(scenes.biaxial), Biaxial)
