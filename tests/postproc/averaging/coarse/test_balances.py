"""Balances of coarse-grained fields: over all space, and at every point of states in motion.

What a field's rate of change is comes from moving the particles and taking differences of order six in time;
divergences of the stress likewise in space. So no side of a balance uses what the other does.
"""

import numpy as np
import pytest

from postproc.averaging.coarse.points import Points
from postproc.geometry import positions, vector
from postproc.macro.contact_ends import contact_ends
from postproc.macro.motion import mean_velocity, momentum_density, velocity_gradient
from postproc.macro.stress import kinetic_stress, stress
from postproc.macro.wall_stress import stress_from_wall_contacts

GRAVITY = {2: np.array([1.3, -9.81]), 3: np.array([1.3, 0.4, -9.81])}


SPACES = {
    ("lucy", 2): (4.0, 0.125, 9), ("gaussian", 2): (0.3, 0.2, 9),
    ("lucy", 3): (8.0, 0.5, 2), ("gaussian", 3): (0.5, 0.35, 9),
}
"""Width, spacing of points and number of particles at which a sum over points is an integral to TO_QUADRATURE: of the
Gaussian to 1e-12, of Lucy's to 2e-9, with an error of order five and more in the spacing."""

TO_QUADRATURE = 1e-8


@pytest.fixture(params=SPACES, ids=lambda p: f"{p[0]} {p[1]}D")
def space(request, states, cg):
    """A function from a builder of states to points over all space, and the volume of each."""
    (kernel, dim), (width, spacing, count) = request.param, SPACES[request.param]
    return lambda build: cg.everywhere(build(2, dim, count=count), kernel, width, spacing)


def integral_is(field, volume, total):
    scale = np.abs(total).max()
    assert scale > 0.01
    np.testing.assert_allclose(field.sum(axis=0) * volume, total, rtol=0, atol=TO_QUADRATURE * scale)


def test_integrals_over_all_space_are_totals(space, states):
    """Mass, momentum, contact stress (virial), interaction force."""
    points, volume = space(states.random_contacts)
    state, ends = points.snapshot, contact_ends(points.snapshot)
    m, v = state.particles["mass"], vector(state.particles, "v", state)
    at_wall = state.contacts["j"] < 0
    integral_is(points.density(m), volume, m.sum())
    integral_is(momentum_density(points, v), volume, (m[:, None] * v).sum(axis=0))
    integral_is(stress(ends, points), volume, -np.einsum("ea,eb->ab", ends.l, ends.f))
    on_grains = vector(state.contacts, "f", state)[at_wall].sum(axis=0)
    integral_is(points.interaction_force_density(ends), volume, on_grains)


@pytest.mark.parametrize(("kernel", "dim"), [key for key in SPACES if key != ("lucy", 3)])
def test_a_static_closed_sample_carries_its_boundary_forces(states, cg, kernel, dim):
    points, volume = cg.everywhere(states.balanced(2, dim), kernel, *SPACES[kernel, dim][:2])
    state = points.snapshot
    expected = stress_from_wall_contacts(state) * np.prod(np.diff(state.box, axis=1))
    integral_is(stress(contact_ends(state), points), volume, expected)


@pytest.mark.parametrize("dim", [2, 3])
def test_integral_of_the_heaviside(states, dim):
    """Discontinuous, so along lines beside a contact's: there fields change at known places, linearly in between.

    Over the distance from the contact's line by Gauss' rule in the angle, across = w sin(angle).
    """
    w, length = 0.7, 1.1
    force = np.array([-2.0, 3.0, 1.0])[:dim]
    state = states.snapshot(
        x=[[0.0] * dim], radius=[1.0], i=[1], j=[-1], point=[[length] + [0.0] * (dim - 1)], force=[force],
        thickness=0.3 if dim == 2 else 1.0,
    )
    mass, virial = 0.0, np.zeros((dim, dim))
    for node, weight in zip(*np.polynomial.legendre.leggauss(30), strict=True):
        across, half = w * np.sin((node + 1) * np.pi / 4), w * np.cos((node + 1) * np.pi / 4)
        borders = np.sort([-half, half, length - half, length + half])
        at = np.zeros((3, dim))
        at[:, 0], at[:, 1] = (borders[1:] + borders[:-1]) / 2, across
        points = Points(snapshot=state, points=at, kernel="heaviside", width=w)
        around = 2 * state.thickness if dim == 2 else 2 * np.pi * across
        area = around * half * weight * np.pi / 4
        virial += np.einsum("kab,k->ab", stress(contact_ends(state), points), np.diff(borders)) * area
        mass += Points(snapshot=state, points=at * np.eye(dim)[1], kernel="heaviside", width=w).density(
            np.array([5.0]))[0] * 2 * half * area
    np.testing.assert_allclose(virial, -np.outer(np.eye(dim)[0] * length, force), rtol=0, atol=1e-12)
    assert mass == pytest.approx(5.0, rel=1e-12)


class Moving:
    """A state of random velocities under gravity, at points; also a little later or earlier, on exact parabolas."""

    def __init__(self, states, dim, kernel, width):
        self.states, self.state, self.kernel, self.width = states, states.random_contacts(6, dim), kernel, width
        state = self.state
        self.ends = contact_ends(state)
        self.m, self.v = state.particles["mass"], vector(state.particles, "v", state)
        self.a = self.ends.sum_c(self.ends.f) / self.m[:, None] + GRAVITY[dim]
        rng = np.random.default_rng(8)
        self.at = rng.uniform(*(state.box + [-0.5, 0.5]).T, (60, dim))  # also beyond the walls

    def points(self, at=None, time=0.0):
        x = positions(self.state) + time * self.v + time**2 / 2 * self.a
        state = self.states.replace(self.state, particles={**self.state.particles, **self.states.columns("", x)})
        return Points(
            snapshot=state, points=self.at if at is None else at, kernel=self.kernel, width=self.width
        )

    def velocity(self, time):
        return self.v + time * self.a


WIDTHS = {("lucy", 2): 0.7, ("lucy", 3): 1.3, ("gaussian", 2): 0.4, ("gaussian", 3): 0.5}


@pytest.fixture(params=WIDTHS, ids=lambda p: f"{p[0]} {p[1]}D")
def moving(request, states):
    kernel, dim = request.param
    return Moving(states, dim, kernel, WIDTHS[kernel, dim])


STEP = 5e-4
"""Of differences in time and in space, s and m: of order six they lose 1e-13/STEP by round-off."""


def test_balance_of_mass(moving, cg):
    """d rho/dt + div j = 0, j from its own gradient and as rho V with the gradient of V by the quotient rule."""
    points, mv = moving.points(), moving.m[:, None] * moving.v
    rate = cg.derivative(lambda t: moving.points(time=t).density(moving.m), STEP)
    divergence = np.trace(points.density_gradient(mv), axis1=1, axis2=2)
    scale = np.abs(rate).max()
    np.testing.assert_allclose(rate + divergence, 0, atol=1e-8 * scale)
    rho, V, L = points.density(moving.m), mean_velocity(points, moving.v), velocity_gradient(points, moving.v)
    some = rho > 0
    by_parts = np.einsum("ka,ka->k", V, points.density_gradient(moving.m)) + rho * np.trace(L, axis1=1, axis2=2)
    assert some.mean() > 0.8
    np.testing.assert_allclose((rate + by_parts)[some], 0, atol=1e-8 * scale)


def test_balance_of_momentum(moving, cg):
    """dj/dt + div(rho V V + sigma^k) = -div sigma + t + rho g at every point, also beyond the walls."""
    points, m, v = moving.points(), moving.m, moving.v
    rate = cg.derivative(lambda t: momentum_density(moving.points(time=t), moving.velocity(t)), STEP)

    def flux(at):
        points = moving.points(at=at)
        rho, V = points.density(m), mean_velocity(points, v)
        convected = rho[:, None, None] * V[:, :, None] * V[:, None, :]
        return np.where(rho[:, None, None] > 0, convected, 0.0) + np.nan_to_num(kinetic_stress(v, points))

    def contacts(at):
        return stress(moving.ends, moving.points(at=at))

    terms = {
        "dj/dt": rate,
        "div flux": cg.divergence(flux, moving.at, STEP),
        "div sigma": cg.divergence(contacts, moving.at, STEP),
        "-t": -points.interaction_force_density(moving.ends),
        "-rho g": -points.density(m)[:, None] * GRAVITY[points.snapshot.dimension],
    }
    sizes = {name: np.abs(term).max() for name, term in terms.items()}
    left = sum(terms.values())
    np.testing.assert_allclose(left, 0, atol=1e-8 * max(sizes.values()))
    assert min(sizes.values()) > 1e-3 * max(sizes.values())  # every term counts


def test_kinetic_stress_is_of_the_fluctuation_about_the_velocity_at_the_point(moving):
    """Goldhirsch's v'(r, t) = v^p - V(r), written out; a common velocity changes nothing."""
    points, m, v = moving.points(), moving.m, moving.v
    V = mean_velocity(points, v)
    for k in np.flatnonzero(points.density(m) > 0)[:10]:
        at = Points(snapshot=points.snapshot, points=points.points[k : k + 1], kernel=moving.kernel, width=moving.width)
        prime = v - V[k]
        expected = at.density(m[:, None, None] * prime[:, :, None] * prime[:, None, :])[0]
        found = kinetic_stress(v, at)[0]
        np.testing.assert_allclose(found, expected, rtol=0, atol=1e-13 * np.abs(at.density(m)[0]))
        np.testing.assert_allclose(kinetic_stress(v + 3.0, at)[0], expected, rtol=0, atol=1e-12 * at.density(m)[0])
