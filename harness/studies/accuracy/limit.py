"""What a bulk quantity tends to as a knob is turned all the way up, from a ladder that is full of noise.

There is no exact friction angle of a packing. What there is: values y_i on rungs x_i (the step, 1/stiffness, the rate,
1/side of the sample, the width of an average; all tend to 0), each of the same n packings::

    y = y_0 + c x^p        y_0 the limit, p the order  (L. F. Richardson, Phil. Trans. R. Soc. A 210, 307 (1911);
                           observed orders and their use: P. J. Roache, Annu. Rev. Fluid Mech. 29, 123 (1997))

Everything is formed packing by packing, so that what a packing does to all rungs alike cancels. A limit is linear in
the values, y_0 = sum w_i y_i; its standard error is that of sum w_i y_ik over packings k. Cases, told apart by
tests of such sums over the finest three rungs:

    flat           they differ by no more than noise: y_0 is their mean, its error the difference that noise can hide
    extrapolated   they differ, and what is left of the line in x^p with the expected p is noise: least squares. Else,
                   if they show an order of their own that is well known: least squares with that one, and how far
                   the expected one would be off as a further error
    outside        they differ, but not like a power, or there are only two: the finest two with the expected order,
                   and the whole correction as an error
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np

LEAST, MOST = 0.2, 5.0
"""Orders between which one is looked for."""

USED = 3
"""Rungs that a limit is formed of."""

LEVEL = 0.05
"""Probability of taking noise for a difference between rungs."""

ROUNDING = 1e-12
"""Of the values: what rounding leaves of a difference."""

State = Literal["extrapolated", "outside", "flat"]


@dataclass(frozen=True, kw_only=True)
class Order:
    """p in y = y_0 + c x^p over `rungs` rungs; error: one standard error over packings (jackknife)."""

    value: float
    error: float
    rungs: int


@dataclass(frozen=True, kw_only=True, eq=False)
class Limit:
    """Limit of S numbers over n packings.

    value (S,). each (n, S): packing by packing. packings (n,): their numbers. error (S,): standard error over packings.
    systematic (S,): of the extrapolation itself. order: used. says: in words, how it was found. weights (R,): y_0 =
    sum of weights times rungs, 0 for rungs that were not used.
    """

    value: np.ndarray
    each: np.ndarray
    packings: np.ndarray
    error: np.ndarray
    systematic: np.ndarray
    order: float
    state: State
    says: str
    weights: np.ndarray

    @property
    def bar(self) -> np.ndarray:
        """Both errors together, (S,)."""
        return np.hypot(self.error, self.systematic)


def find_limit(x: Sequence[float], values: np.ndarray, expected: float) -> Limit | None:
    """Return the limit for x to 0 of values (R, K, S), NaN where a packing has none on a rung.

    expected: the order that theory expects. None with fewer than two packings that have values on two rungs.
    """
    x, values = np.asarray(x, float), np.asarray(values, float)
    used = _finest(x, values)
    if used is None:
        return None
    rungs, packings = used
    state, weights, order, systematic, says = _choose(x[rungs], values[np.ix_(rungs, packings)], expected)
    each = np.tensordot(weights, values[np.ix_(rungs, packings)], axes=1)
    whole = np.zeros(len(x))
    whole[rungs] = weights
    return Limit(
        value=each.mean(axis=0), each=each, packings=packings, error=standard_error(each), systematic=systematic,
        order=order, state=state, says=says, weights=whole,
    )


def find_order(x: Sequence[float], values: np.ndarray) -> Order | None:
    """Return the order of values (R, K, S) over all rungs; None where `order_or_why` says why there is none."""
    found = order_or_why(x, values)
    return found if isinstance(found, Order) else None


def order_or_why(x: Sequence[float], values: np.ndarray) -> Order | str:
    """Return the order of values (R, K, S) over all rungs, or why they show none.

    Fewer than three rungs, no more than noise between them, or no power that fits: with all packings, or with any of
    them left out.
    """
    x, values = np.asarray(x, float), np.asarray(values, float)
    whole = np.isfinite(values).all(axis=(0, 2))
    if len(x) < USED:
        return f"{len(x)} rung{'s' * (len(x) != 1)} with values; an order needs {USED}"
    if whole.sum() < 2:
        return "fewer than two packings have values on all rungs"
    if not _differs((values[np.argmax(x)] - values[np.argmin(x)])[whole]):
        return "coarsest and finest rung differ by no more than noise"
    flat = _projected(x, values[:, whole])
    best = _best_order(x, flat.mean(axis=1))
    if best is None:
        return f"the rungs follow no power between {LEAST:g} and {MOST:g}"
    error = _jackknife(x, flat)
    if not np.isfinite(error):
        return "it hangs on one packing: without that one the rungs follow no power"
    return Order(value=best, error=error, rungs=len(x))


def standard_error(each: np.ndarray) -> np.ndarray:
    """Return s/sqrt(n) over the first axis, n >= 2."""
    return each.std(axis=0, ddof=1) / np.sqrt(len(each))


# --- which rungs, which case ---------------------------------------------------------------------------


def _finest(x: np.ndarray, values: np.ndarray) -> tuple[np.ndarray, np.ndarray] | None:
    """Return up to USED rungs, finest first, and the packings that have values on all of them."""
    finite = np.isfinite(values).all(axis=2)
    rungs = [k for k in np.argsort(x) if finite[k].sum() >= 2][:USED]
    while len(rungs) >= 2:
        packings = np.flatnonzero(finite[rungs].all(axis=0))
        if len(packings) >= 2:
            return np.array(rungs), packings
        rungs = rungs[:-1]
    return None


def _choose(x: np.ndarray, values: np.ndarray, expected: float):
    """Return state, weights (R,), order, systematic error (S,) and words; x is sorted, finest first."""
    none, count = np.zeros(values.shape[2]), len(x)
    if not _differs(values[-1] - values[0]):
        says = f"the finest {count} rungs differ by no more than noise: their mean; the floor dominates"
        return "flat", np.full(count, 1.0 / count), expected, standard_error(values[-1] - values[0]), says
    if count == USED:
        order = find_order(x, values)
        shown = f"; they show {order.value:.2f} +- {order.error:.2g}" if order else ""
        if not _differs(np.tensordot(_bend(x, expected), values, axes=1), ROUNDING * np.abs(values).max()):
            says = f"{count} rungs, order {expected:g} as expected{shown}"
            return "extrapolated", power_weights(x, expected), expected, none, says
        if order is not None and order.error < 0.5 * order.value:
            weights = power_weights(x, order.value)
            off = np.abs(_apart(power_weights(x, expected), weights, values))
            says = f"{count} rungs, order as they show it, {order.value:.2f} +- {order.error:.2g}, not {expected:g}"
            return "extrapolated", weights, order.value, off, says
    weights = np.concatenate([power_weights(x[:2], expected), np.zeros(count - 2)])
    why = "only two rungs" if count < USED else "not in the asymptotic range"
    return (
        "outside", weights, expected, np.abs(_apart(weights, np.eye(count)[0], values)),
        f"{why}: the finest two with order {expected:g}, not checked",
    )


def _bend(x: np.ndarray, order: float) -> np.ndarray:
    """Return c (3,) so that sum c_i y_i = 0 for every y_0 + a x^p: what three rungs are off a line in x^p."""
    u = x**order
    return np.array([u[2] - u[1], u[0] - u[2], u[1] - u[0]]) / (u[2] - u[0])


def _apart(weights: np.ndarray, others: np.ndarray, values: np.ndarray) -> np.ndarray:
    return np.tensordot(weights - others, values.mean(axis=1), axes=1)


def _differs(apart: np.ndarray, rounding: float = 0.0) -> bool:
    """Whether differences (n, S) over packings are more than noise, at LEVEL; of one number this is Student's t.

    Of several: n |mean|^2/tr V > F(nu, nu (n - 1)), V the covariance, nu = tr(V)^2/tr(V^2) how many of them are of
    their own (G. E. P. Box, Ann. Math. Stat. 25, 290 (1954)). rounding: size of a mean that is none.
    """
    from scipy.stats import f

    n, mean = len(apart), apart.mean(axis=0)
    size = float(mean @ mean)
    if size <= rounding**2 * len(mean):
        return False
    rest = apart - mean
    gram = rest @ rest.T / (n - 1)
    trace, square = float(np.trace(gram)), float((gram**2).sum())
    if trace == 0.0:
        return True
    own = trace**2 / square
    return bool(n * size / trace > f.isf(LEVEL, own, own * (n - 1)))


def _projected(x: np.ndarray, values: np.ndarray) -> np.ndarray:
    """Return (R, K): values (R, K, S) along the way from the finest to the coarsest rung."""
    way = (values[np.argmax(x)] - values[np.argmin(x)]).mean(axis=0)
    return values @ (way / np.linalg.norm(way))


# --- powers --------------------------------------------------------------------------------------------


def power_weights(x: np.ndarray, order: float) -> np.ndarray:
    """Return w (R,) so that sum w_i y_i is the y_0 of the least-squares line in x^p; of two rungs Richardson's.

    >>> power_weights(np.array([1.0, 2.0]), 1.0).tolist()
    [2.0, -1.0]
    """
    u = np.asarray(x, float) ** order
    du = u - u.mean()
    return 1.0 / len(u) - u.mean() * du / float(du @ du)


def _rest(order: float, x: np.ndarray, y: np.ndarray) -> float:
    """Sum of squares about the best y_0 + c x^p, over that about the mean."""
    u = x**order
    du, dy = u - u.mean(), y - y.mean()
    return float(1.0 - (du @ dy) ** 2 / ((du @ du) * (dy @ dy)))


def _best_order(x: np.ndarray, y: np.ndarray) -> float | None:
    """Return the p that fits y (R,) best, None where it lies at an end of the range: then it is no power."""
    from scipy.optimize import minimize_scalar

    if np.ptp(y) == 0.0:
        return None
    grid = np.geomspace(LEAST, MOST, 40)
    rest = [_rest(p, x, y) for p in grid]
    k = int(np.argmin(rest))
    if k in (0, len(grid) - 1):
        return None
    found = minimize_scalar(lambda p: _rest(p, x, y), bounds=(grid[k - 1], grid[k + 1]), method="bounded",
                            options={"xatol": 1e-10})
    return float(found.x)


def _jackknife(x: np.ndarray, flat: np.ndarray) -> float:
    """Return the standard error of the order of (R, K), each packing left out in turn; infinite if one decides all.

    (n - 1)/n sum (p_(k) - mean)^2 (J. W. Tukey, Ann. Math. Stat. 29, 614 (1958)).
    """
    n = flat.shape[1]
    left = [_best_order(x, np.delete(flat, k, axis=1).mean(axis=1)) for k in range(n)]
    if n < 2 or any(p is None for p in left):
        return float("inf")
    return float(np.sqrt((n - 1) / n * ((np.array(left) - np.mean(left)) ** 2).sum()))
