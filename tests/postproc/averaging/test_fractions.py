"""Parts of discs and spheres against independent quadrature, closed special cases and limits."""

import warnings

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.integrate import quad

from postproc.averaging.corners import sphere_below_corner
from postproc.averaging.fractions import disc_below_corner, disc_below_line, disc_in_circle, sphere_below_plane
from postproc.averaging.shells import sphere_in_cylinder

TOLERANCE = 1e-13
"""Of fractions of 1: what the quadrature can be asked for."""


def integral(function, places):
    """Between neighbouring places, with square roots at the ends taken care of by x = sin."""
    total = 0.0
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # that round-off is reached, as it should be
        for low, high in zip(places[:-1], places[1:], strict=True):
            middle, half = (low + high) / 2, (high - low) / 2
            total += quad(
                lambda s, m=middle, h=half: function(m + h * np.sin(s)) * np.cos(s) * h, -np.pi / 2, np.pi / 2,
                epsabs=1e-15, epsrel=1e-14, limit=400,
            )[0]
    return total


def within(low, high, *places):
    return [low, *sorted({p for p in places if low < p < high}), high]


def arc(rho, R, c):
    """Angle that a circle of radius rho spans inside one of radius R, centres c apart."""
    cosine = (rho**2 + c**2 - R**2) / (2 * c * rho) if rho * c > 0 else np.sign(c - R)
    return 2 * np.arccos(np.clip(cosine, -1.0, 1.0))


def cases(seed, count=40):
    """Circles of all sizes across a disc of radius 1, a third of them touching it from the inside nearly."""
    rng = np.random.default_rng(seed)
    for k in range(count):
        R = 10 ** rng.uniform(-1.5, 1.5)
        c = abs(R + rng.uniform(-1, 1))
        if k % 3 == 0:
            R = rng.uniform(0, 1)
            c = abs(1 - R + 10 ** rng.uniform(-9, -1) * rng.choice([-1, 1]))
        yield R, c


def test_discs_in_circles():
    for R, c in cases(1):
        expected = integral(lambda r, R=R, c=c: r * arc(r, R, c), within(0, 1, abs(c - R), c + R)) / np.pi
        assert disc_in_circle(R, 1.0, c) == pytest.approx(expected, abs=TOLERANCE)


def test_spheres_in_cylinders():
    for R, c in cases(2, count=20):
        def shell(r, R=R, c=c):
            return 2 * np.sqrt(max(1 - r * r, 0)) * r * arc(r, R, c)

        expected = integral(shell, within(0, 1, abs(c - R), c + R)) / (4 / 3 * np.pi)
        assert sphere_in_cylinder(R, 1.0, c) == pytest.approx(expected, abs=1e-12)


def test_a_cylinder_through_the_middle_of_a_sphere_leaves_the_napkin_ring():
    R = np.array([0.0, 0.1, 0.5, 0.9, 1.0, 2.0])
    expected = 1 - (1 - np.minimum(R, 1) ** 2) ** 1.5
    np.testing.assert_allclose(sphere_in_cylinder(R, 1.0, 0.0), expected, atol=1e-14)
    np.testing.assert_allclose(sphere_in_cylinder(R, 1.0, 1e-13), expected, atol=1e-12)


def test_discs_below_corners():
    rng = np.random.default_rng(3)
    for u, v in rng.uniform(-1.2, 1.2, (40, 2)):
        edge = np.sqrt(max(1 - v * v, 0))

        def height(x, v=v):
            h = np.sqrt(max(1 - x * x, 0))
            return np.clip(v, -h, h) + h

        expected = integral(height, within(-1, np.clip(u, -1, 1), -edge, edge)) / np.pi if u > -1 else 0.0
        assert disc_below_corner(u, v) == pytest.approx(expected, abs=TOLERANCE)


def test_spheres_below_corners():
    rng = np.random.default_rng(4)
    for k, (u, v, w) in enumerate(rng.uniform(-1, 1, (20, 3))):
        v = u if k % 5 == 0 else v  # noqa: PLW2901

        def slice_(z, u=u, v=v):
            s = np.sqrt(max(1 - z * z, 1e-300))
            return np.pi * s * s * float(disc_below_corner(u / s, v / s))

        roots = [sign * np.sqrt(q) for q in (1 - u * u, 1 - v * v, 1 - u * u - v * v) if q > 0 for sign in (-1, 1)]
        expected = integral(slice_, within(-1, w, *roots)) / (4 / 3 * np.pi)
        assert sphere_below_corner(u, v, w) == pytest.approx(expected, abs=TOLERANCE)


def test_halves_quarters_and_eighths():
    assert disc_below_line(0.0) == sphere_below_plane(0.0) == 0.5
    assert disc_below_corner(0.0, 0.0) == pytest.approx(0.25, abs=1e-16)
    assert sphere_below_corner(0.0, 0.0, 0.0) == pytest.approx(0.125, abs=1e-16)
    assert sphere_below_corner(0.0, 0.0, 1.0) == pytest.approx(0.25, abs=1e-16)
    assert disc_in_circle(2.0, 1.0, [0.0, 1.0, 3.0, 5.0]).tolist() == [1.0, 1.0, 0.0, 0.0]
    assert disc_in_circle(0.5, 1.0, [0.0, 0.5, 1.5]).tolist() == [0.25, 0.25, 0.0]
    assert disc_in_circle(1.0, 1.0, 1.0) == pytest.approx(2 / 3 - np.sqrt(3) / (2 * np.pi), abs=1e-15)
    assert disc_in_circle(0.0, 1.0, 0.0) == 0.0


def test_what_is_below_and_above_is_the_whole():
    t = np.linspace(-1.5, 1.5, 301)
    np.testing.assert_allclose(disc_below_line(t) + disc_below_line(-t), 1.0, rtol=1e-15)
    np.testing.assert_allclose(sphere_below_plane(t) + sphere_below_plane(-t), 1.0, rtol=1e-15)


@pytest.mark.parametrize("depth", [1e-4, 1e-8, 1e-12])
def test_slivers_keep_their_digits(depth):
    """A segment of depth d << 1 has the area 4 sqrt(2)/3 d^(3/2) (1 - 3 d/20), a cap pi d^2 (1 - d/3)."""
    depth = 1.0 - (1.0 - depth)  # what is left of it in -1 + depth
    segment = 4 * np.sqrt(2) / 3 * depth**1.5 * (1 - 3 * depth / 20) / np.pi
    assert disc_below_line(-1 + depth) == pytest.approx(segment, rel=1e-8)
    assert sphere_below_plane(-1 + depth) == pytest.approx(0.75 * depth**2 * (1 - depth / 3), rel=1e-8)


def test_a_large_circle_cuts_like_a_line():
    """The lens with a circle of radius R differs from the segment by the order 1/R, down to the last digits."""
    t = np.linspace(-0.99, 0.99, 37)
    errors = [np.abs(disc_in_circle(R, 1.0, R - t) - disc_below_line(t)).max() for R in (1e2, 1e4, 1e6)]
    assert errors[0] < 0.01
    np.testing.assert_allclose(np.array(errors[1:]) / errors[:-1], 1e-2, rtol=0.02)


@settings(max_examples=100, deadline=None)
@given(st.floats(0, 3), st.floats(0, 3), st.floats(0, 4), st.floats(1e-6, 10))
def test_more_circle_holds_more_and_units_do_not_matter(R, more, c, unit):
    small, large = disc_in_circle(R, 1.0, c), disc_in_circle(R + more, 1.0, c)
    assert 0.0 <= small <= large + 1e-15
    assert large <= 1.0
    assert disc_in_circle(unit * R, unit, unit * c) == pytest.approx(small, abs=1e-13)
