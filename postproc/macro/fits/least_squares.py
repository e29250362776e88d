"""What every fit here starts from and ends in: points with errors, parameters with errors; the two ways to fit."""

from __future__ import annotations

import warnings
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from postproc.results import Unavailable


@dataclass(frozen=True, kw_only=True)
class Parameter:
    """A fitted number and its standard error (one sigma); NaN when the data cannot tell the error."""

    value: float
    error: float


@dataclass(frozen=True, kw_only=True)
class Points:
    """P points of a curve: x, y (P,), and error (P,): standard errors of y, or None when not known.

    Points that are not finite are left out, and so are points whose error is not (a mean of one
    sample): they carry no weight.
    """

    x: np.ndarray
    y: np.ndarray
    error: np.ndarray | None

    @property
    def count(self) -> int:
        """P."""
        return len(self.x)

    def where(self, keep: np.ndarray) -> Points:
        """Return the points with keep (P,) true."""
        return Points(x=self.x[keep], y=self.y[keep], error=None if self.error is None else self.error[keep])


@dataclass(frozen=True, kw_only=True)
class Fit:
    """Parameters in the order of the model, their covariance, and how well the model describes the points.

    chi2: sum of squared residuals over (points - parameters), in units of the given errors, so that
    1 is a good model and much more a wrong one; without errors in units of y squared. NaN without a
    degree of freedom.
    """

    parameters: np.ndarray
    covariance: np.ndarray
    chi2: float
    points: int

    def parameter(self, k: int) -> Parameter:
        """Parameter k with its standard error."""
        return Parameter(value=float(self.parameters[k]), error=float(np.sqrt(self.covariance[k, k])))


def points(x: object, y: object, error: object = None) -> Points:
    """Return finite points. Raises ValueError for unequal lengths or an error that is not positive."""
    x, y = (np.asarray(a, dtype=np.float64) for a in (x, y))
    given = np.ones(len(y)) if error is None else np.asarray(error, dtype=np.float64)
    if not x.shape == y.shape == given.shape == (len(x),):
        raise ValueError(f"points: expected x, y and error of one length, got {x.shape}, {y.shape}, {given.shape}")
    keep = np.isfinite(x) & np.isfinite(y) & np.isfinite(given)
    if (given[keep] <= 0).any():
        raise ValueError(f"points: expected errors > 0, got {given[keep].min():g}")
    return Points(x=x[keep], y=y[keep], error=None if error is None else given[keep])


def too_few(data: Points, parameters: int, place: str) -> Unavailable | None:
    """Tell when there is nothing to fit: the parameters' errors need one point more, or errors of y."""
    needed = parameters + (data.error is None)
    if data.count >= needed:
        return None
    return Unavailable(reason=f"{data.count} usable points {place}, at least {needed} are needed")


def fit_curve(
    model: Callable[..., np.ndarray], data: Points, start: Sequence[float]
) -> Fit | Unavailable:
    """Least squares of model(x, *parameters) to the points, weighted by their errors if these are given.

    Levenberg-Marquardt (scipy.optimize.curve_fit). With errors the covariance is the one that they imply;
    without, all points are taken as equally good and the scatter about the curve sets the scale.
    """
    from scipy.optimize import OptimizeWarning, curve_fit

    known = data.error is not None
    scale = {"sigma": data.error, "absolute_sigma": True} if known else {}
    try:
        with warnings.catch_warnings(), np.errstate(over="ignore", invalid="ignore"):
            warnings.simplefilter("ignore", OptimizeWarning)  # a covariance that is not finite is told below
            found, covariance = curve_fit(model, data.x, data.y, p0=start, maxfev=20_000, **scale)
    except (RuntimeError, ValueError) as error:
        return Unavailable(reason=f"the fit did not converge: {' '.join(str(error).split())}")
    if not np.isfinite(covariance).all():
        return Unavailable(reason="the points do not determine all parameters")
    residual = (data.y - model(data.x, *found)) / (data.error if known else 1.0)
    return Fit(parameters=found, covariance=covariance, points=data.count,
               chi2=_per_degree_of_freedom(residual, len(found)))


def fit_line(data: Points, *, place: str = "to fit") -> Fit | Unavailable:
    """Weighted straight line y = a x + b; parameters (a, b).

    Closed form (numpy.polyfit). Unavailable with fewer points than `too_few` allows or a single x.
    """
    lacking = too_few(data, 2, place)
    if lacking is not None:
        return lacking
    if np.ptp(data.x) == 0.0:
        return Unavailable(reason=f"all points {place} have one abscissa")
    known = data.error is not None
    found, covariance = np.polyfit(
        data.x, data.y, 1, w=1.0 / data.error if known else None, cov="unscaled" if known else True
    )
    residual = (data.y - np.polyval(found, data.x)) / (data.error if known else 1.0)
    return Fit(parameters=found, covariance=covariance, points=data.count, chi2=_per_degree_of_freedom(residual, 2))


def _per_degree_of_freedom(residual: np.ndarray, parameters: int) -> float:
    free = len(residual) - parameters
    return float(residual @ residual / free) if free > 0 else np.nan
