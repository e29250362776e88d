"""The piecewise linear hysteretic law from measured curves: k_1, k_2, k_c with their uncertainties.

A cycle to the largest overlap D, the displacement counting from an unknown contact point x_0, d = x - x_0::

    way in      f = k_1 d                                       d > 0, else 0
    way back    f = max(k_2 d - (k_2 - k_1) D, -k_c d)          d > 0, else 0

    pull-off against load        f_min = s f_max,   s = k_c (k_2 - k_1)/(k_1 (k_2 + k_c))
    hysteresis against force     d_back - d_in = (f_max - f) (1/k_1 - 1/k_2) at force f, so its largest, at f = 0,
                                 grows with f_max by b = 1/k_1 - 1/k_2

(S. Luding, Granular Matter 10, 235 (2008).) Lines give s or b, not the three stiffnesses: one number each. Noise is
taken to be in the force, independent from point to point; its size is that of the scatter unless the file says.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from harness.errors import InputError
from harness.studies.reproduce.contact.curves import Cycle, Measurements

NAMES = ("k_1", "k_2", "k_c", "x_0")
DRAWS = 400
"""Of the bootstrap."""


@dataclass(frozen=True, kw_only=True, eq=False)
class LawFit:
    """values, errors (4,) of NAMES (N/m, m): one standard error of the covariance; bootstrap (draws, 4).

    noise: standard deviation of the force about the curve, N. largest: D, m. adhesive: whether points lie on the
    adhesive branch: else k_c is only that which the deepest pull allows at least, and its error NaN.
    """

    values: np.ndarray
    errors: np.ndarray
    covariance: np.ndarray
    bootstrap: np.ndarray
    noise: float
    largest: float
    adhesive: bool

    @property
    def bootstrap_errors(self) -> np.ndarray:
        """Standard deviations of the bootstrap (4,)."""
        return self.bootstrap.std(axis=0, ddof=1)

    def named(self) -> dict[str, float]:
        """Values by name."""
        return dict(zip(NAMES, self.values.tolist(), strict=True))


@dataclass(frozen=True, kw_only=True)
class LineFit:
    """slope and offset of a line with one standard error each; unit of the slope: 1 or m/N."""

    slope: float
    slope_error: float
    offset: float
    offset_error: float
    points: int


def law_force(
    displacement: np.ndarray, loading: np.ndarray, largest: float, k_1: float, k_2: float, k_c: float, x_0: float
) -> np.ndarray:
    """Return the force (P,), N, at displacements (P,), m; loading (P,): way in; largest: deepest displacement, m."""
    d, deepest = displacement - x_0, largest - x_0
    back = np.maximum(k_2 * d - (k_2 - k_1) * deepest, -k_c * d)
    return np.where(d > 0, np.where(loading, k_1 * d, back), 0.0)


def fit_cycle(cycle: Cycle, *, draws: int = DRAWS, seed: int = 1, name: str = "the cycle") -> LawFit:
    """Fit one cycle by least squares (Levenberg-Marquardt) and draw its residuals again for the bootstrap.

    Raises InputError with the file's `name` where the cycle is none of this law: no force rises on the way in, or the
    fit does not converge.
    """
    values, covariance = _fitted(cycle, cycle.force, _start(cycle, name), name)
    left = cycle.force - _model(cycle)(cycle.displacement, *values)
    rng, drawn = np.random.default_rng(seed), []
    scale = np.sqrt(len(left) / (len(left) - len(values)))  # residuals are smaller than the noise by the fitted numbers
    weight = np.ones(len(left)) if cycle.error is None else cycle.error
    for _ in range(draws):
        noise = weight * scale * rng.choice(left / weight, len(left))
        drawn.append(_fitted(cycle, cycle.force - left + noise, values, name)[0])
    adhesive = int(_on_adhesive_branch(cycle, values).sum()) >= 2
    errors = np.sqrt(np.diag(covariance))
    return LawFit(
        values=values, errors=np.where([True, True, adhesive, True], errors, np.nan), covariance=covariance,
        bootstrap=np.array(drawn).reshape(draws, len(values)), noise=float(left.std(ddof=len(values))),
        largest=float(cycle.displacement.max() - values[3]), adhesive=adhesive,
    )


def fit_line(found: Measurements) -> LineFit:
    """Fit pull-off or largest hysteresis by a straight line."""
    from postproc.macro.fits.least_squares import fit_line as line
    from postproc.macro.fits.least_squares import points
    from postproc.results import Unavailable

    fit = line(points(found.x, found.y, found.error))
    if isinstance(fit, Unavailable):
        raise InputError(file=found.name, expected="points on a line", got=fit.reason)
    slope, offset = fit.parameter(0), fit.parameter(1)
    return LineFit(slope=slope.value, slope_error=slope.error, offset=offset.value, offset_error=offset.error,
                   points=fit.points)


def pull_off_slope(k_1: float, k_2: float, k_c: float) -> float:
    """Return s = f_min/f_max of the law: k_c (k_2 - k_1)/(k_1 (k_2 + k_c)).

    >>> pull_off_slope(50.0, 100.0, 100.0)
    0.5
    """
    return k_c * (k_2 - k_1) / (k_1 * (k_2 + k_c))


def propagated(fit: LawFit, function: Callable[[float, float, float], float]) -> tuple[float, float]:
    """Return a function of k_1, k_2, k_c at the fit, and its standard error by first-order propagation."""
    k = fit.values[:3]
    steps = 1e-6 * np.abs(k)
    slopes = np.array([
        (function(*(k + h)) - function(*(k - h))) / (2 * h.max()) for h in np.diag(steps)
    ])
    return float(function(*k)), float(np.sqrt(slopes @ fit.covariance[:3, :3] @ slopes))


def _model(cycle: Cycle) -> Callable[..., np.ndarray]:
    loading, largest = cycle.loading, float(cycle.displacement.max())
    return lambda x, *p: law_force(x, loading, largest, *p)


def _fitted(cycle: Cycle, force: np.ndarray, start: np.ndarray, name: str) -> tuple[np.ndarray, np.ndarray]:
    import warnings

    from scipy.optimize import OptimizeWarning, curve_fit

    unit = np.array([*[np.abs(start[:3]).max()] * 3, np.ptp(cycle.displacement)])
    model, size = _model(cycle), float(np.abs(force).max())
    known = {} if cycle.error is None else {"sigma": cycle.error / size, "absolute_sigma": True}
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", OptimizeWarning)  # without adhesion k_c is not told: see `fit_cycle`
            found, covariance = curve_fit(
                lambda x, *p: model(x, *(unit * p)) / size, cycle.displacement, force / size, p0=start / unit,
                maxfev=10_000, **known,
            )
    except RuntimeError as error:
        raise InputError(file=name, expected="a cycle of the piecewise linear law",
                         got=f"a fit that does not converge ({error})") from None
    return found * unit, covariance * np.outer(unit, unit)


def _start(cycle: Cycle, name: str) -> np.ndarray:
    """Return starting values: lines through the upper way in and the top of the way back, and the deepest pull."""
    x, f = cycle.displacement, cycle.force
    top = float(f[cycle.loading].max())
    rising = cycle.loading & (f > 0.3 * top)
    if top <= 0 or rising.sum() < 2 or np.ptp(x[rising]) == 0:
        raise InputError(
            file=name, expected="a force that rises on the way in",
            got=f"{top:g} N at most up to the deepest point, {int(rising.sum())} points above 30 % of that",
            fix="rows in the order of time, displacement growing with compression, force positive when pressed",
        )
    k_1, at = np.polyfit(x[rising], f[rising], 1)
    if k_1 <= 0:
        raise InputError(file=name, expected="a force that rises on the way in",
                         got=f"one that falls, by {-k_1:g} N/m",
                         fix="compression is positive, in displacement and force")
    x_0 = -at / k_1
    falling = ~cycle.loading & (f > 0.3 * top)
    k_2 = np.polyfit(x[falling], f[falling], 1)[0] if falling.sum() > 1 and np.ptp(x[falling]) > 0 else 2 * k_1
    k_2 = max(float(k_2), 1.01 * k_1)
    deepest = int(np.argmin(f))
    pull, depth = -float(f[deepest]), float(x[deepest] - x_0)
    k_c = pull / depth if pull > 0 and depth > 0 else 0.01 * k_1
    return np.array([k_1, k_2, k_c, x_0])


def _on_adhesive_branch(cycle: Cycle, values: np.ndarray) -> np.ndarray:
    k_1, k_2, k_c, x_0 = values
    d, deepest = cycle.displacement - x_0, cycle.displacement.max() - x_0
    return ~cycle.loading & (d > 0) & (k_2 * d - (k_2 - k_1) * deepest < -k_c * d)
