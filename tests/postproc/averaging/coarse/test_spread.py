"""Matrices of coarse graining against sums and integrals written out, in free space and with periodic images."""

import numpy as np
import pytest
from scipy.integrate import quad

from postproc.averaging.coarse import spread
from postproc.averaging.coarse.kernels.registry import KERNELS
from postproc.averaging.coarse.spread import Spread
from postproc.averaging.words import WrongSetting

CASES = [(name, dim) for name in KERNELS for dim in (2, 3)]


@pytest.fixture(params=CASES, ids=str)
def case(request, states):
    """A kernel on random points, and the points, in a state without periods."""
    name, dim = request.param
    at = np.random.default_rng(3).uniform(-1, 1, (40, dim))
    return Spread(kernel=KERNELS[name](width=0.4, dimension=dim), at=at, snapshot=states.random_contacts(1, dim))


def segments(dim):
    """Starts and arms, among them one of length 0 and very short ones."""
    rng = np.random.default_rng(4)
    x, l = rng.uniform(-1, 1, (30, dim)), rng.normal(0, 0.5, (30, dim))  # noqa: E741
    l[:4] *= np.array([0.0, 1e-9, 1e-4, 1e-2])[:, None]
    return x, l


def test_places_are_the_kernel_of_all_distances(case):
    x, _ = segments(case.at.shape[1])
    distance = np.linalg.norm(case.at[:, None] - x, axis=2)
    expected = np.where(distance < case.kernel.reach, case.kernel.value(distance), 0.0)
    np.testing.assert_allclose(case.places(x).toarray(), expected, rtol=1e-13)
    assert (expected > 0).any()


def crossings(d, l, reach):  # noqa: E741
    """Where on 0 .. 1 the segment enters and leaves the sphere, and passes closest to its centre."""
    a, b, c = l @ l, d @ l, d @ d - reach**2
    if a == 0 or b * b < a * c:
        return []
    root = np.sqrt(b * b - a * c)
    return sorted(s for s in ((b - root) / a, b / a, (b + root) / a) if 0 < s < 1)


def test_segments_are_the_mean_of_the_kernel_along_them(case):
    """Exact to 1e-12 of phi(0), by quadrature along every segment."""
    x, l = segments(case.at.shape[1])  # noqa: E741
    found, top = case.segments(x, l).toarray(), case.kernel.value(np.zeros(1))[0]
    cut = case.kernel.reach if case.kernel.reach < 2 else np.inf
    for k, r in enumerate(case.at[:8]):
        for e in range(len(x)):
            d = r - x[e]
            borders = [0.0, *(crossings(d, l[e], cut) if np.isfinite(cut) else []), 1.0]
            expected = 0.0
            for a, b in zip(borders[:-1], borders[1:], strict=True):
                if np.linalg.norm(d - (a + b) / 2 * l[e]) < cut:  # else outside, as a whole
                    shrink = 1 - 1e-14
                    expected += quad(
                        lambda s, d=d, e=e, shrink=shrink: case.kernel.value(
                            np.array([shrink * np.linalg.norm(d - s * l[e])]))[0],
                        a, b, epsabs=1e-14 * top, epsrel=1e-13, limit=200,
                    )[0]
            assert found[k, e] == pytest.approx(expected, abs=1.5e-12 * top), (k, e)


@pytest.mark.parametrize("name", KERNELS)
def test_shifting_a_segment_along_itself_changes_its_ends_only(states, name):
    """psi(r + h l) - psi(r) = h (mean over the stretch before its start - mean over the one before its end).

    Divided by h and with h -> 0: l . grad psi = phi(r - x) - phi(r - x - l), for every kernel.
    """
    rng = np.random.default_rng(0)
    at, x, l = rng.uniform(-1, 1, (3, 20, 2))  # noqa: E741
    kernel, state, h = KERNELS[name](width=0.4, dimension=2), states.random_contacts(1, 2), 0.1

    def psi(at, x, l):  # noqa: E741
        return Spread(kernel=kernel, at=at, snapshot=state).segments(x, l).toarray()

    for e in range(len(x)):
        start, arm = x[e : e + 1], l[e : e + 1]
        moved = psi(at + h * arm, start, arm) - psi(at, start, arm)
        ends = psi(at, start - h * arm, h * arm) - psi(at, start + (1 - h) * arm, h * arm)
        np.testing.assert_allclose(moved, h * ends, atol=1e-13 * kernel.value(np.zeros(1))[0])


@pytest.mark.parametrize("name", ["lucy", "gaussian"])
def test_slopes_are_the_gradient(states, cg, name):
    """Where the points of the difference are not on both sides of the reach: Lucy's third derivative jumps there."""
    (x, _), step = segments(2), 1e-4
    at = np.random.default_rng(3).uniform(-1, 1, (40, 2))
    kernel, state = KERNELS[name](width=0.4, dimension=2), states.random_contacts(1, 2)
    away = np.abs(np.linalg.norm(at[:, None] - x, axis=2) - kernel.reach) > 3 * step
    assert away.mean() > 0.99
    for axis, slope in enumerate(Spread(kernel=kernel, at=at, snapshot=state).slopes(x)):
        expected = cg.derivative(
            lambda t, axis=axis: Spread(kernel=kernel, at=at + t * np.eye(2)[axis], snapshot=state).places(x).toarray(),
            step,
        )
        np.testing.assert_allclose(slope.toarray()[away], expected[away], atol=3e-10 * np.abs(expected).max())


@pytest.mark.parametrize("width", [0.3, 1.1, 2.6])
@pytest.mark.parametrize("name", ["lucy", "heaviside"])
def test_periodic_images(states, name, width):
    """A kernel from narrow to wider than the box: the same as copies written out, wherever things were counted."""
    rng = np.random.default_rng(2)
    box = np.array([[-1.0, 1.5], [0.0, 2.0]])
    x, l = rng.uniform(-6, 6, (15, 2)), rng.normal(0, 0.3, (15, 2))  # noqa: E741
    at = rng.uniform(-4, 4, (30, 2))
    kernel = KERNELS[name](width=width, dimension=2)
    periodic = states.snapshot(x=x, radius=np.full(15, 0.3), box=box, periodic=(True, False))
    shifts = 2.5 * np.arange(-9, 10)[:, None] * [1.0, 0.0]
    free = Spread(kernel=kernel, at=at, snapshot=states.snapshot(x=x, radius=np.full(15, 0.3)))
    wrapped = Spread(kernel=kernel, at=at, snapshot=periodic)
    for of in (lambda s, x: s.places(x), lambda s, x: s.segments(x, l), lambda s, x: s.places(x + l)):
        copies = sum(of(free, x + shift).toarray() for shift in shifts)
        found = of(wrapped, x).toarray()
        np.testing.assert_allclose(found, copies, atol=1e-13 * kernel.value(np.zeros(1))[0])
        assert np.count_nonzero(found) > np.count_nonzero(of(free, x).toarray()) > 0


def test_blocks_do_not_show(case, monkeypatch):
    x, l = segments(case.at.shape[1])  # noqa: E741
    whole = case.segments(x, l).toarray()
    monkeypatch.setattr(spread, "BLOCK", 17)
    np.testing.assert_array_equal(case.segments(x, l).toarray(), whole)


def test_too_many_pairs_are_refused(case, monkeypatch):
    monkeypatch.setattr(spread, "MOST_PAIRS", 50)
    with pytest.raises(WrongSetting, match=r"at most 50 pairs .*, got \d+; take fewer points or a smaller width"):
        case.segments(*segments(case.at.shape[1]))


def test_nothing_to_spread(case):
    dim = case.at.shape[1]
    none = np.empty((0, dim))
    assert case.places(none).shape == case.segments(none, none).shape == (40, 0)
