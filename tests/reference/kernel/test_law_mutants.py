"""Wrong contact laws, each of which must be caught by a named check that the kernel passes."""

import dataclasses
import math

import numpy as np
import pytest

from reference.analytic.hertz_collision import HertzCollision, hertz_stiffness
from reference.analytic.hysteretic_collision import ConstantUnloading, OverlapUnloading
from reference.kernel import interactions
from reference.kernel.laws import (
    constant_rolling,
    dmt,
    hertz,
    hysteretic,
    hysteretic_variable,
    law,
    rolling,
    slider,
    spheres,
    torsion,
    viscous,
)
from reference.kernel.prescribed import driven

# --- checks ----------------------------------------------------------------------------------------


def impact(dem, **options):
    """Two unequal spheres meet head on at relative speed 2; return the restitution."""
    m = dem.model([[0.0, 0.0, 0.0], [1.7001, 0.0, 0.0]], v=[[1.5, 0.0, 0.0], [-0.5, 0.0, 0.0]], mass=(1.0, 3.0),
                  radius=(1.0, 0.7), dt=dem.tc / 200, **options)
    v = dem.run(dem.Simulation(m), 1500).state.v[0]
    return (v[1] - v[0]) / 2.0


def check_hertz_restitution(dem):
    """The restitution that was asked for, whatever the masses."""
    assert impact(dem, normal=dem.table("normal", "hertz")) == pytest.approx(0.8, abs=2e-3)


def check_hertz_duration(dem):
    """Elastic spheres of unequal size part after the closed form's time."""
    m = dem.model([[0.0, 0.0, 0.0], [1.7, 0.0, 0.0]], v=[[1.0, 0.0, 0.0], [-1.0, 0.0, 0.0]], radius=(1.0, 0.7),
                  normal=dem.table("normal", "hertz", restitution=1.0), dt=dem.tc / 200)
    stiffness = hertz_stiffness(effective_modulus=3e4 / 2 / 0.91, effective_radius=0.7 / 1.7)
    closed = HertzCollision(reduced_mass=0.5, stiffness=stiffness)
    s, touching = dem.Simulation(m), 0
    for _ in range(1500):
        s.advance()
        touching += len(s.interactions[0].last.f_n)
    assert touching * m.dt == pytest.approx(closed.duration(2.0), rel=5e-3)


def check_plastic_restitution(dem):
    """e^2 = k_1/k_2 - (k_c/k_1)(k_2 - k_1)^2/(k_2 (k_2 + k_c))."""
    closed = ConstantUnloading(loading=4e3, unloading=6e3, adhesion=1e3, reduced_mass=0.75)
    table = dem.table("normal", "hysteretic", unloading_stiffness=6e3, adhesion_stiffness=1e3, normal_damping=0.0)
    assert impact(dem, normal=table) == pytest.approx(closed.restitution, rel=3e-3)


def check_growing_stiffness(dem):
    """e^2 with the k_2 that belongs to the largest overlap reached."""
    numbers = {"adhesion_stiffness": 500.0, "plasticity_depth": 0.1, "normal_damping": 0.0}
    closed = OverlapUnloading(loading=4e3, limit=1.2e4, adhesion=500.0, plasticity_depth=0.1, pair_radius=1.4 / 1.7,
                              reduced_mass=0.75)
    assert closed.limit_speed > 2.0
    assert impact(dem, normal=dem.table("normal", "hysteretic_variable", **numbers)) == pytest.approx(
        closed.restitution(2.0), rel=3e-3)


def on_a_path(dem, overlaps, *, slip=0.0, spin=(0.0, 0.0, 0.0), count=2, **tables):
    """Force and torque on sphere 1 while sphere 2 (or a wall, count 1) overlaps it from -x, row by row.

    `slip` is the velocity of sphere 1 along y; `spin` is that of sphere 1: numbers, or one a row.
    """
    rows = len(overlaps) + 1
    x, v, w = np.zeros((rows, count, 3)), np.zeros((rows, count, 3)), np.zeros((rows, count, 3))
    depth = np.array([-0.2, *overlaps])
    if count == 2:
        x[:, 1, 0] = depth - 2.0
    else:
        x[:, 0, 0] = 1.0 - depth
    v[1:, 0, 1] = slip
    w[1:, 0] = spin
    walls = [dem.wall("side", (0.0,) * 3, (1.0, 0.0, 0.0), friction=True)] if count == 1 else ()
    m = dem.model(x[0], walls=walls, dt=1e-3, **tables)
    force, torque = driven(m, x, v, w)
    return force[:, 0], torque[:, 0]


def check_friction_of_a_contact_that_adheres(dem):
    """Unloaded from 0.1 to 0.08: f_n = 200, and friction reaches mu (f_n + k_c delta) = mu 360."""
    normal = dem.table("normal", "hysteretic", normal_damping=0.0)
    force, _ = on_a_path(dem, [0.1] + [0.08] * 60, slip=5.0, normal=normal, sliding=dem.table("sliding", "spring"))
    assert force[-1, 0] == pytest.approx(200.0, rel=1e-9)
    assert force[-2:, 1].min() == pytest.approx(-0.4 * 360.0, rel=1e-9)


def check_pull_off(dem):
    """DMT: at no overlap the pull is 4 pi w a*, between spheres and at a wall."""
    for count, reduced in ((2, 0.5), (1, 1.0)):
        force, _ = on_a_path(dem, [1e-12], count=count, normal=dem.table("normal", "dmt"))
        assert force[-1, 0] == pytest.approx(-4.0 * math.pi * 5.0 * reduced, rel=1e-6)


def check_sphere_on_wall(dem):
    """4/3 E* sqrt(R delta) delta."""
    force, _ = on_a_path(dem, [0.1], count=1, normal=dem.table("normal", "hertz", restitution=1.0))
    assert force[-1, 0] == pytest.approx(4.0 / 3.0 * 3e4 / 2 / 0.91 * math.sqrt(0.1) * 0.1, rel=1e-9)


def check_no_slip_stiffness(dem):
    """Mindlin: f_t = 8 G* sqrt(a* delta) s before anything slides."""
    normal = dem.table("normal", "hertz", restitution=1.0)
    force, _ = on_a_path(dem, [0.1] * 5, slip=0.01, normal=normal, sliding=dem.table("sliding", "mindlin"))
    stiffness = 8.0 * 3e4 / (4.0 * 1.7 * 1.3) * math.sqrt(0.05)
    assert force[-1, 1] == pytest.approx(-stiffness * 4 * 0.01 * 1e-3, rel=1e-9)  # the talk stretches after the force


def check_viscous_friction(dem):
    """gamma_t v at slow slip, mu f_n at fast slip, nothing at rest."""
    tables = {"normal": dem.table("normal", "linear"), "sliding": dem.table("sliding", "viscous")}
    for slip, expected in ((0.1, 4.0), (-2.0, -80.0), (100.0, 400.0), (0.0, 0.0)):
        force, _ = on_a_path(dem, [0.1], slip=slip, **tables)
        assert force[-1, 1] == pytest.approx(-expected, rel=1e-12, abs=1e-12)


def check_static_and_dynamic_friction(dem):
    """Dragged along, friction rises to mu f_n and falls to mu_d f_n for good."""
    tables = {"normal": dem.table("normal", "linear"), "sliding": dem.table(
        "sliding", "spring", shear_damping=0.0, dynamic_friction=0.25)}
    force, _ = on_a_path(dem, [0.1] * 100, slip=10.0, **tables)
    drag = -force[:, 1]
    assert drag.max() == pytest.approx(400.0, rel=0.08)
    np.testing.assert_allclose(drag[-50:], 250.0, rtol=1e-9)


def loop(rate, steps=200, back=40):
    return np.array([rate] * steps + [-rate] * back)


def check_rolling_loop(dem):
    """Rolled on and back about z: couple -a* min(k_r a* angle, mu_r f_n), back along the same stiffness at once."""
    rolling_law = dem.table("rolling", "spring", rolling_damping=0.0)
    spin = loop(10.0)[:, None] * [0.0, 0.0, 1.0]
    force, couple = on_a_path(dem, [0.1] * 240, spin=spin, normal=dem.table("normal", "linear"), rolling=rolling_law)
    limit, step = 0.5 * 0.2 * 1e3, 0.5 * 0.5 * 2e3 * 10.0 * 1e-3
    np.testing.assert_allclose(couple[:15, 2], -step * np.arange(15), atol=1e-9)
    np.testing.assert_allclose(couple[40:200, 2], -limit, rtol=1e-9)
    np.testing.assert_allclose(couple[201:240, 2], -limit + step * np.arange(39), atol=1.01 * step)
    assert not force[:, 1:].any()


def check_rolling_spring_turns_with_the_pair(dem):
    """Rolled about z, then turned rigidly by 90 degrees about z, the couple stays as it is."""
    angle = np.concatenate([np.zeros(6), np.linspace(0.0, math.pi / 2, 101)])
    x, w = np.zeros((107, 2, 3)), np.zeros((107, 2, 3))
    x[:, 1] = 1.9 * np.array([np.cos(angle), np.sin(angle), 0.0 * angle]).T
    x[0, 1, 0] = 2.2
    w[1:6, 0, 2] = 5.0
    w[6:, :, 2] = np.diff(angle)[5:, None] / 1e-3
    m = dem.model(x[0], rolling=dem.table("rolling", "spring", rolling_damping=0.0), dt=1e-3)
    _, couple = driven(m, x, np.zeros_like(x), w)
    assert couple[6, 0, 2] < -1.0
    np.testing.assert_allclose(couple[6:, 0], couple[6:7, 0] * np.ones((100, 1)), rtol=0, atol=1e-9)


def check_torsion_loop(dem):
    """The same about the normal."""
    torsion_law = dem.table("torsion", "spring", torsion_damping=0.0)
    spin = loop(10.0)[:, None] * [1.0, 0.0, 0.0]
    _, couple = on_a_path(dem, [0.1] * 240, spin=spin, normal=dem.table("normal", "linear"), torsion=torsion_law)
    limit, step = 0.5 * 0.15 * 1e3, 0.5 * 0.5 * 2e3 * 10.0 * 1e-3
    np.testing.assert_allclose(couple[:12, 0], -step * np.arange(12), atol=1e-9)
    np.testing.assert_allclose(couple[40:200, 0], -limit, rtol=1e-9)
    np.testing.assert_allclose(couple[201:230, 0], -limit + step * np.arange(29), atol=1.01 * step)


def check_couples_cancel(dem):
    """Two discs that roll on each other, without friction: what one loses in spin the other gains."""
    m = dem.model([[0.0, 0.0], [1.9, 0.0]], spin=[[8.0], [1.0]], rolling=dem.table("rolling", "spring"))
    spin = dem.run(dem.Simulation(m), 20).state.spin[0]
    assert abs(spin[0] - 8.0) > 0.1
    assert (m.inertia * spin).sum() == pytest.approx((m.inertia * m.spin[0]).sum(), rel=1e-12)


def check_constant_rolling(dem):
    """A sphere that turns on a floor loses mu_r R f_n/I of its spin in a second."""
    force, couple = on_a_path(dem, [0.1], spin=(0.0, 3.0, 4.0), count=1, normal=dem.table("normal", "linear"),
                              rolling=dem.table("rolling", "constant"))
    assert force[-1, 0] == pytest.approx(1e3)
    np.testing.assert_allclose(couple[-1], [0.0, -30.0, -40.0], rtol=1e-9, atol=1e-9)


def check_plain_rolling(dem):
    """A rubbing crowd with rolling resistance against the plain DEM."""
    m = dem.cluster(7, 2, squeeze=0.8, speed=3.0, mu=0.4, gn=12.0, gt=5.0, rolling=dem.table("rolling", "spring"))
    s, plain = dem.Simulation(m), dem.Plain(m)
    for _ in range(40):
        s.advance()
        plain.advance()
    np.testing.assert_allclose(s.state.spin[0, :9], np.array(plain.w)[:, 2], rtol=0, atol=1e-10)


CHECKS = [value for name, value in list(globals().items()) if name.startswith("check_")]


@pytest.mark.parametrize("check", CHECKS, ids=lambda c: c.__name__)
def test_the_kernel_passes(dem, check):
    check(dem)


# --- mutants ---------------------------------------------------------------------------------------

MOVE, TALK, DAMPING, ALGORITHMS = slider.Slider.move, slider._ALGORITHMS["talk"], spheres.damping, slider._ALGORITHMS
ROLL, TWIST, CONSTANT = rolling.SpringRolling, torsion.SpringTorsion, constant_rolling.ConstantRolling
ROLL_COUPLE, TWIST_COUPLE, CONSTANT_COUPLE = ROLL.couple, TWIST.couple, CONSTANT.couple
PLASTIC, GROWING = hysteretic.HystereticNormal, hysteretic_variable.VariableHystereticNormal
PLASTIC_FORCE, GROWING_FORCE = PLASTIC.elastic, GROWING.elastic
INTERACTION = interactions.Interaction


def uncut(s, c, advance):
    force, _, slides = TALK(s, c, advance)
    return force, c.xi + c.stretch, slides


def one_coefficient(self, memory, rate, base, n, dt, *, advance, mean_rate=None):
    return MOVE(dataclasses.replace(self, dynamic_friction=self.friction), memory, rate, base, n, dt, advance=advance)


def damping_on_twice_the_mass(restitution, stiffness, mass):
    return DAMPING(restitution, stiffness, 2.0 * mass)


def whole_moduli(young, poisson):
    return young / (1.0 - poisson**2)


def stiffnesses_swapped(self, contact, memory):
    swapped = dataclasses.replace(
        self, loading_stiffness=self.unloading_stiffness, unloading_stiffness=self.loading_stiffness)
    return PLASTIC_FORCE(swapped, contact, memory)


def no_adhesive_branch(force, overlap, largest, k_1, k_2, k_c):
    return force, largest[None]


def never_plastic(self, contact, memory):
    return PLASTIC_FORCE(self, contact, 0.0 * memory)


def stiffest_at_once(self, contact, memory):
    return PLASTIC_FORCE(
        PLASTIC(loading_stiffness=self.loading_stiffness, unloading_stiffness=self.largest_unloading_stiffness,
                adhesion_stiffness=self.adhesion_stiffness, normal_damping=0.0), contact, memory)


def diameters(self, contact, memory):
    return GROWING_FORCE(self, dataclasses.replace(contact, reduced_radius=2.0 * contact.reduced_radius), memory)


def base_not_shifted(self, contact, total, elastic):
    return total


def no_pull(self, contact):
    return 0.0 * contact.reduced_radius


def wall_as_a_twin(self, quantity, i, j):
    return 0.5 * quantity.take(i)


def no_limit_of_drag(self, contact, pressing, memory, dt, *, advance):
    return -self.shear_damping * contact.v_t, memory


def no_couple(self, contact, pressing, memory, dt, *, advance):
    couple, memory = ROLL_COUPLE(self, contact, pressing, memory, dt, advance=advance)
    return 0.0 * couple, memory


def rolling_helped(self, contact, pressing, memory, dt, *, advance):
    couple, memory = ROLL_COUPLE(self, contact, pressing, memory, dt, advance=advance)
    return -couple, memory


def twisting_helped(self, contact, pressing, memory, dt, *, advance):
    couple, memory = TWIST_COUPLE(self, contact, pressing, memory, dt, advance=advance)
    return -couple, memory


def constant_that_drives(self, contact, pressing, memory, dt, *, advance):
    couple, memory = CONSTANT_COUPLE(self, contact, pressing, memory, dt, advance=advance)
    return -couple, memory


def spun_by_one(self, state, spin, i, j, overlap):
    return spin.take(i, axis=1)


def couple_one_sided(self, forces, force, torque):
    if forces.couple is not None:
        torque[0] += np.bincount(forces.contact.i, forces.couple[0], force.shape[1])


MUTANTS = {
    "spring not cut on rolling": (ALGORITHMS, "talk", uncut, check_rolling_loop),
    "spring not cut on twisting": (ALGORITHMS, "talk", uncut, check_torsion_loop),
    "rolling spring not turned": (
        slider, "_rescaled", lambda turned, old: old, check_rolling_spring_turns_with_the_pair),
    "dynamic friction ignored": (slider.Slider, "move", one_coefficient, check_static_and_dynamic_friction),
    "damping on the wrong mass": (hertz, "damping", damping_on_twice_the_mass, check_hertz_restitution),
    "one modulus for both partners": (hertz, "effective_modulus", whole_moduli, check_hertz_duration),
    "one modulus for both, wall": (hertz, "effective_modulus", whole_moduli, check_sphere_on_wall),
    "Young's for the shear modulus": (hertz, "effective_shear_modulus", whole_moduli, check_no_slip_stiffness),
    "k_1 and k_2 swapped": (PLASTIC, "elastic", stiffnesses_swapped, check_plastic_restitution),
    "adhesive branch missing": (hysteretic, "with_adhesion", no_adhesive_branch, check_plastic_restitution),
    "largest overlap forgotten": (PLASTIC, "elastic", never_plastic, check_plastic_restitution),
    "k_2 constant": (GROWING, "elastic", stiffest_at_once, check_growing_stiffness),
    "diameters for radii": (GROWING, "elastic", diameters, check_growing_stiffness),
    "friction of adhesion missing": (
        law.NormalLaw, "gripping", base_not_shifted, check_friction_of_a_contact_that_adheres),
    "pull missing": (dmt.DmtNormal, "adhesion", no_pull, check_pull_off),
    "reduced radius at a wall": (INTERACTION, "_reduced", wall_as_a_twin, check_pull_off),
    "drag without limit": (viscous.ViscousSliding, "force", no_limit_of_drag, check_viscous_friction),
    "rolling couple dropped": (ROLL, "couple", no_couple, check_rolling_loop),
    "rolling couple of the wrong sign": (ROLL, "couple", rolling_helped, check_rolling_loop),
    "rolling couple on one partner": (INTERACTION, "add_to", couple_one_sided, check_couples_cancel),
    "rolling spun by one partner": (INTERACTION, "_relative_spin", spun_by_one, check_plain_rolling),
    "constant couple of the wrong sign": (
        CONSTANT, "couple", constant_that_drives, check_constant_rolling),
    "torsion of the wrong sign": (TWIST, "couple", twisting_helped, check_torsion_loop),
}


@pytest.mark.parametrize("name", MUTANTS)
def test_wrong_physics_is_caught(dem, name, monkeypatch):
    place, attribute, wrong, check = MUTANTS[name]
    put = monkeypatch.setitem if isinstance(place, dict) else monkeypatch.setattr
    put(place, attribute, wrong)
    with pytest.raises(AssertionError):
        check(dem)


def test_every_check_catches_something():
    assert {check for *_, check in MUTANTS.values()} == set(CHECKS)
