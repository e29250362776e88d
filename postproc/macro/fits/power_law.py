"""Power laws, such as the stresses of the ring: sigma_rr ~ r^0, sigma_rphi ~ r^-2."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from postproc.macro.fits.least_squares import Parameter, Points, fit_line, points
from postproc.results import Unavailable


@dataclass(frozen=True, kw_only=True)
class PowerLaw:
    """y = amplitude (x/scale)^exponent for low <= x <= high; amplitude has the sign of y.

    scale: geometric mean of the abscissas, where the errors of both parameters are least entangled.
    """

    exponent: Parameter
    amplitude: Parameter
    scale: float
    low: float
    high: float
    chi2: float
    points: int


def fit_power_law(
    x: np.ndarray, y: np.ndarray, error: np.ndarray | None = None, *, low: float = 0.0, high: float = np.inf
) -> PowerLaw | Unavailable:
    """Straight line through ln |y| against ln x, weighted by (|y|/error)^2 if errors of y are given.

    Points within [low, high] only; x > 0. Unavailable with the reason when y changes its sign or
    vanishes there (a power law does neither), or when there are too few points.
    Source: the talk, "Stress equilibrium": sigma_rr ~ r^0, sigma_rphi ~ r^-2.
    """
    data = points(x, y, error)
    data = data.where((data.x > 0) & (data.x >= low) & (data.x <= high))
    signs = np.sign(data.y)
    if abs(signs.sum()) != data.count:
        return Unavailable(reason=f"no power law: of {data.count} values {int((signs > 0).sum())} are positive, "
                                  f"{int((signs < 0).sum())} negative")
    scale = float(np.exp(np.log(data.x).mean())) if data.count else np.nan
    fit = fit_line(logarithmic(data, np.log(data.x / scale)), place=f"with {low:g} <= x <= {high:g}")
    if isinstance(fit, Unavailable):
        return fit
    height = fit.parameter(1)
    amplitude = float(np.exp(height.value))
    return PowerLaw(
        exponent=fit.parameter(0), scale=scale, low=float(data.x.min()), high=float(data.x.max()),
        amplitude=Parameter(value=float(signs[0]) * amplitude, error=amplitude * height.error),
        chi2=fit.chi2, points=fit.points,
    )


def logarithmic(data: Points, x: np.ndarray) -> Points:
    """Return ln |y| over x; its error is error/|y|, right while that is small against 1."""
    return Points(x=x, y=np.log(np.abs(data.y)), error=None if data.error is None else data.error / np.abs(data.y))
