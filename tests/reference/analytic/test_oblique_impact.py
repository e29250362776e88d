"""The rigid-body formulas against integrated Coulomb friction, and against invariants."""

import math

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from reference.analytic.oblique_impact import ObliqueImpact, sticking_of_springs

SHAPES = {"sphere": 0.4, "disc": 0.5}


def impact(shape="sphere", friction=0.3, restitution=0.8):
    return ObliqueImpact(inertia_factor=SHAPES[shape], friction=friction, restitution=restitution)


def pulse(t, impulse):
    """A normal force over the unit of time with the given impulse."""
    return impulse * 0.5 * math.pi * math.sin(math.pi * t)


def slid_on_plane(q, friction, restitution, normal, tangential, spin, radius, integrate_until):
    """Integrate Coulomb's law through the pulse; the state at the end, or None if the slip ends before."""
    direction = math.copysign(1.0, tangential + radius * spin)

    def rates(t, y):
        push = -direction * friction * pulse(t, (1 + restitution) * normal)
        return [push, push / (q * radius)]

    slip_ends = integrate_until(rates, [tangential, spin], lambda t, y: y[0] + radius * y[1], span=1.0)
    if slip_ends is not None:
        return None
    return solve_ivp(rates, (0, 1), [tangential, spin], method="DOP853", rtol=1e-12, atol=1e-14).y[:, -1]


@pytest.mark.parametrize("shape", SHAPES)
@pytest.mark.parametrize(("tangential", "spin"), [(5.0, 0.0), (-5.0, 30.0), (0.5, 900.0), (2.0, -900.0)])
def test_sliding_on_plane(shape, tangential, spin, integrate_until):
    case = impact(shape)
    expected = slid_on_plane(SHAPES[shape], 0.3, 0.8, 0.7, tangential, spin, 0.01, integrate_until)
    u, w = case.on_plane(normal=0.7, tangential=tangential, spin=spin, radius=0.01)
    assert (u, w) == pytest.approx(expected, rel=1e-9)


@pytest.mark.parametrize(("shape", "factor"), [("sphere", 3.5), ("disc", 3.0)])
def test_threshold_of_gross_sliding(shape, factor, integrate_until):
    """A per mille of slip to either side decides whether the slip ends during the impact."""
    case = impact(shape)
    limit = factor * 0.3 * 1.8 * 0.7
    assert case.sliding_limit(0.7) == pytest.approx(limit, rel=1e-14)
    for part, slides in [(0.999, False), (1.001, True)]:
        outcome = slid_on_plane(SHAPES[shape], 0.3, 0.8, 0.7, part * limit, 0.0, 0.01, integrate_until)
        assert (outcome is not None) is slides
        assert case.slides(0.7, part * limit) == slides
    with pytest.raises(ValueError, match="no gross sliding"):
        case.on_plane(normal=0.7, tangential=0.999 * limit, spin=0.0, radius=0.01)


@pytest.mark.parametrize("shape", SHAPES)
def test_sliding_pair(shape, integrate_until):
    """Two unequal bodies, integrated with a force on each; momentum is kept."""
    q, mass, radius = SHAPES[shape], (2.0, 0.5), (0.02, 0.01)
    tangential, spin = (3.0, -1.0), (40.0, -20.0)
    impulse = 1.8 * 0.7 * mass[0] * mass[1] / sum(mass)

    def rates(t, y):
        push = -0.3 * pulse(t, impulse)
        return [push / mass[0], -push / mass[1], *(push / (q * m * r) for m, r in zip(mass, radius, strict=True))]

    end = solve_ivp(rates, (0, 1), [*tangential, *spin], method="DOP853", rtol=1e-12, atol=1e-14).y[:, -1]
    u, w = impact(shape).of_pair(normal=0.7, tangential=tangential, spin=spin, radius=radius, mass=mass)
    assert np.concatenate([u, w]) == pytest.approx(end, rel=1e-9)
    assert np.dot(mass, u) == pytest.approx(np.dot(mass, tangential), rel=1e-14)


def test_equal_bodies_share_the_kick():
    """Each body of an equal pair gets half of what a plane gives to one that comes with the relative velocity."""
    case = impact()
    u, w = case.of_pair(normal=1.0, tangential=(4.0, -4.0), spin=(0.0, 0.0), radius=(0.1, 0.1), mass=(3.0, 3.0))
    on_plane = case.on_plane(normal=1.0, tangential=8.0, spin=0.0, radius=0.1)
    assert u[0] - 4.0 == pytest.approx((on_plane[0] - 8.0) / 2, rel=1e-14)
    assert w[0] == pytest.approx(on_plane[1] / 2, rel=1e-14)
    assert (u[1], w[1]) == pytest.approx((-u[0], w[0]), rel=1e-14)


def test_a_heavy_partner_is_a_plane():
    case = impact()
    u, w = case.of_pair(normal=1.0, tangential=(8.0, 0.0), spin=(3.0, 0.0), radius=(0.1, 5.0), mass=(1.0, 1e15))
    assert (u[0], w[0]) == pytest.approx(case.on_plane(normal=1.0, tangential=8.0, spin=3.0, radius=0.1), rel=1e-13)


@pytest.mark.parametrize("sticking", [None, 0.44])
def test_opposite_spins_do_not_feel_each_other(sticking):
    """Equal spheres with spins w and -w have no slip: everything tangential stays, to the last bit."""
    u, w = impact(friction=0.4, restitution=0.5).of_pair(
        normal=0.4, tangential=(0.0, 0.0), spin=(17.3, -17.3), radius=(0.1, 0.1), mass=(1.0, 1.0), sticking=sticking
    )
    assert u == (0.0, 0.0)
    assert w == (17.3, -17.3)


@pytest.mark.parametrize("sticking", [0.0, 0.44, 1.0])
def test_walton_braun(sticking):
    """B is what the slip says, sticking below and sliding above the kink, and mu (1 + e) 7/2 cot(gamma) - 1 there."""
    case = impact(friction=0.25, restitution=0.87)
    angle = np.radians(np.linspace(1, 89, 200))
    normal, slip = np.cos(angle), np.sin(angle)
    u, w = case.on_plane(normal=normal, tangential=slip, spin=0.0, radius=0.003, sticking=sticking)
    found = -(u + 0.003 * w) / slip
    sliding = -1 + 0.25 * 1.87 * 3.5 / np.tan(angle)
    assert found == pytest.approx(np.minimum(sticking, sliding), abs=1e-12)
    assert case.tangential_restitution(normal, slip, sticking) == pytest.approx(found, abs=1e-12)
    kink = case.sliding_limit(1.0) / (1 + sticking)
    assert case.tangential_restitution(1.0, 0.999 * kink, sticking) == sticking
    assert case.tangential_restitution(1.0, 1.001 * kink, sticking) < sticking


@pytest.mark.parametrize("shape", SHAPES)
def test_contact_point_invariant_and_energy(shape):
    """q R w - u is kept (angular momentum about the contact); energy never grows for |B| <= 1, and stays for B = 1."""
    q, rng = SHAPES[shape], np.random.default_rng(1)
    u0, w0, normal = rng.normal(0, 2, 300), rng.normal(0, 100, 300), rng.uniform(0.1, 2, 300)
    for sticking in (-0.3, 0.0, 0.6, 1.0):
        u, w = impact(shape).on_plane(normal=normal, tangential=u0, spin=w0, radius=0.02, sticking=sticking)
        assert q * 0.02 * w - u == pytest.approx(q * 0.02 * w0 - u0, rel=1e-12, abs=1e-12)
        change = u**2 + q * (0.02 * w) ** 2 - u0**2 - q * (0.02 * w0) ** 2
        assert change.max() <= 1e-12
    stuck = ~impact(shape).slides(normal, 2 * (u0 + 0.02 * w0))
    assert stuck.sum() > 20
    assert change[stuck] == pytest.approx(0, abs=1e-12)


def test_published_cases():
    """Chung and Ooi 2011: threshold angles of test 4, sliding plateau of test 5, the line of test 6."""
    assert math.degrees(impact(friction=0.092, restitution=0.98).sliding_angle) == pytest.approx(32.5, abs=0.05)
    assert math.degrees(impact(friction=0.092, restitution=1.0).sliding_angle) == pytest.approx(32.8, abs=0.05)
    steel = impact(friction=0.3, restitution=1.0)
    _, w = steel.on_plane(normal=5.0, tangential=np.array([20.0, 50.0, 80.0]), spin=0.0, radius=1e-5)
    assert w * 1e-5 / (0.3 * 5.0) == pytest.approx(-5.0, rel=1e-12)
    spinning = impact(friction=0.4, restitution=0.5)
    x = 3.5 * 0.4 * 1.5 * 0.2 / (0.1 * 60.0)
    assert spinning.tangential_restitution(0.2, 0.1 * 60.0) == pytest.approx(x - 1, rel=1e-12)


@pytest.mark.parametrize("q", [0.4, 0.5, 1.0])
@pytest.mark.parametrize("ratio", [0.1, 2 / 7, 0.8, 1.0])
def test_sticking_of_springs(q, ratio, integrate_until):
    """A ball on two springs without Coulomb's limit, until its normal spring lets go."""
    radius, tangential, spin = 0.5, 0.3, 0.4

    def rates(t, y):
        overlap, rate, spring, u, w = y
        push = -ratio * spring
        return [rate, -overlap, u + radius * w, push, push / (q * radius)]

    _, end = integrate_until(rates, [0, 1, 0, tangential, spin], lambda t, y: y[0], span=10, direction=-1)
    b0 = sticking_of_springs(shear_to_normal_stiffness=ratio, inertia_factor=q)
    assert -(end[3] + radius * end[4]) / (tangential + radius * spin) == pytest.approx(b0, abs=1e-9)
    case = ObliqueImpact(inertia_factor=q, friction=1e6, restitution=1.0)
    assert case.on_plane(normal=1.0, tangential=tangential, spin=spin, radius=radius, sticking=b0) == pytest.approx(
        tuple(end[3:]), abs=1e-9
    )
