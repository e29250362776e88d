"""The exponential approach of the biaxial box: stress, fabric and stiffness deviators against strain."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from postproc.macro.fits.least_squares import Fit, Parameter, fit_curve, points, too_few
from postproc.results import Unavailable


@dataclass(frozen=True, kw_only=True)
class Saturation:
    """y(eps) = y_max - (y_max - y_0) exp(-beta eps), for low <= eps <= high.

    plateau: y_max. rate: beta. reached: 1 - exp(-beta high), the part of the way that the data cover.
    """

    plateau: Parameter
    rate: Parameter
    initial: float
    reached: float
    low: float
    high: float
    chi2: float
    points: int


def fit_saturation(
    strain: np.ndarray, value: np.ndarray, error: np.ndarray | None = None, *,
    initial: float = 0.0, low: float = 0.0, high: float = np.inf,
) -> Saturation | Unavailable:
    """Fit the solution of dy/d eps = beta (y_max - y), y(0) = initial.

    strain: deviatoric strain eps_D (P,), from 0. value: sigma_D/sigma_V, F_D/F_V, C_D, ... (P,).
    low, high: range of strain that is fitted: end it before the stress softens.
    With initial = 0 this is 1 - y/y_max = exp(-beta eps_D), the form of the talk (for C_D) and of
    Luding, Int. J. Sol. Struct. 41, 5821 (2004).
    Unavailable with the reason: too few points, no convergence, a rate that is not positive, or a
    plateau that is not known better than to itself (too short a range of strain).
    """
    data = points(strain, value, error)
    data = data.where((data.x >= low) & (data.x <= high))
    place = f"with {low:g} <= strain <= {high:g}"
    lacking = too_few(data, 2, place)
    if lacking is not None:
        return lacking
    if np.ptp(data.x) == 0.0:
        return Unavailable(reason=f"all points {place} have one strain")
    scale = float(data.x.max())  # rates are fitted in its unit, so that the step sizes are of order 1

    def approach(eps: np.ndarray, plateau: float, rate: float) -> np.ndarray:
        return plateau - (plateau - initial) * np.exp(-rate * eps / scale)

    fit = fit_curve(approach, data, (float(data.y[np.argmax(data.x)]), 3.0))
    return fit if isinstance(fit, Unavailable) else _judged(fit, initial, float(data.x.min()), scale)


def _judged(fit: Fit, initial: float, low: float, high: float) -> Saturation | Unavailable:
    plateau, rate = fit.parameter(0), fit.parameter(1)
    if rate.value <= 0:
        return Unavailable(reason=f"the approach does not decay: rate {rate.value / high:.3g}")
    if plateau.error >= abs(plateau.value - initial):
        return Unavailable(reason=f"the plateau is not determined up to a strain of {high:g}: "
                                  f"{plateau.value:.3g} +- {plateau.error:.3g}")
    return Saturation(
        plateau=plateau, rate=Parameter(value=rate.value / high, error=rate.error / high), initial=initial,
        reached=float(1.0 - np.exp(-rate.value)), low=low, high=high, chi2=fit.chi2, points=fit.points,
    )
