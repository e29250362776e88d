"""Every kernel keeps the same promises: normalised, its slope, its line integral; each its width."""

import numpy as np
import pytest
from scipy.integrate import quad

from postproc.averaging.coarse.kernels.registry import KERNELS
from postproc.snapshot import MissingColumn

WIDTH = 0.7
SPHERE = {2: lambda r: 2 * np.pi * r, 3: lambda r: 4 * np.pi * r**2}


@pytest.fixture(params=[(name, dim) for name in KERNELS for dim in (2, 3)], ids=str)
def kernel(request):
    name, dim = request.param
    return KERNELS[name](width=WIDTH, dimension=dim)


def moment(kernel, power: int) -> float:
    """Integral of phi r^power over all space up to its reach."""
    surface = SPHERE[kernel.dimension]
    return quad(
        lambda r: kernel.value(np.array([r]))[0] * surface(r) * r**power, 0, kernel.reach, epsabs=1e-13, epsrel=1e-13
    )[0]


def test_the_integral_is_one(kernel):
    assert moment(kernel, 0) == pytest.approx(1.0, abs=1e-12)


def test_nothing_beyond_reach(kernel):
    if kernel.reach < 3 * WIDTH:
        assert kernel.value(kernel.reach * np.array([1.0, 1.1, 3.0])).tolist() == [0.0, 0.0, 0.0]
    assert (kernel.value(np.linspace(0, 0.999 * kernel.reach, 50)) > 0).all()


@pytest.mark.parametrize(("name", "dim", "deviation"), [
    ("gaussian", 2, 1.0), ("gaussian", 3, 1.0), ("lucy", 2, np.sqrt(5 / 14)), ("lucy", 3, np.sqrt(1 / 3)),
    ("heaviside", 2, 1 / 2), ("heaviside", 3, 1 / np.sqrt(5)),
])
def test_what_the_width_is(name, dim, deviation):
    """Standard deviation along an axis, in w."""
    kernel = KERNELS[name](width=WIDTH, dimension=dim)
    assert np.sqrt(moment(kernel, 2) / dim) / WIDTH == pytest.approx(deviation, rel=1e-11)


def test_slope_is_the_derivative(kernel, cg):
    r = np.linspace(0.05, 0.95, 40) * kernel.reach
    if isinstance(kernel, KERNELS["heaviside"]):
        with pytest.raises(MissingColumn, match="heaviside has no gradient; take lucy or gaussian"):
            kernel.slope(r)
        return
    slope = cg.derivative(lambda t: kernel.value(r + t), 1e-3 * WIDTH)
    np.testing.assert_allclose(kernel.slope(r) * r, slope, rtol=1e-9, atol=1e-12 * np.abs(slope).max())


def line_by_quadrature(kernel, start, end, across):
    """With the places where the line enters and leaves the sphere as break points."""
    half = np.sqrt(max(kernel.reach**2 - across**2, 0.0))
    low, high = (start, end) if kernel.reach > 3 * WIDTH else np.clip([start, end], -half, half)
    middle = [p for p in (0.0,) if low < p < high]
    borders = [low, *middle, high]
    if low == high:
        return 0.0
    inside = 1 - 1e-15  # the last place inside a Heaviside
    return sum(
        quad(lambda t: kernel.value(np.array([np.hypot(inside * across, inside * t)]))[0], a, b,
             epsabs=1e-14, epsrel=1e-13, limit=200)[0]
        for a, b in zip(borders[:-1], borders[1:], strict=True)
    )


def lines():
    """Start, length and distance of lines in units of the width: anyhow, then through the centre, grazing, missing."""
    rng = np.random.default_rng(1)
    anyhow = np.stack([rng.uniform(-3, 2, 60), rng.exponential(1.0, 60), rng.uniform(0, 2.2, 60)], axis=1)
    special = [(-1, 2, 0), (0, 1, 0), (-3, 6, 0), (-0.5, 0.3, 1e-9), (-1, 2, 0.999999), (-4, 8, 1.9999), (1, 1, 5)]
    return np.concatenate([anyhow, special])


def test_line_integrals_are_exact(kernel):
    start, length, across = WIDTH * lines().T
    expected = [line_by_quadrature(kernel, *row) for row in zip(start, start + length, across, strict=True)]
    scale = kernel.value(np.zeros(1))[0] * WIDTH
    np.testing.assert_allclose(kernel.line(start, start + length, across) / scale, expected / scale, atol=1e-12)


def test_the_tail_of_the_gaussian_keeps_its_digits():
    """Beside the centre on either side: relative, not only against the top."""
    kernel = KERNELS["gaussian"](width=WIDTH, dimension=2)
    start, end = WIDTH * np.array([[4.0, 5.0], [-5.0, -4.0], [6.0, 6.1]]).T
    expected = [line_by_quadrature(kernel, a, b, 0.3) for a, b in zip(start, end, strict=True)]
    np.testing.assert_allclose(kernel.line(start, end, np.full(3, 0.3)), expected, rtol=1e-12)
