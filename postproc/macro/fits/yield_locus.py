"""Mohr-Coulomb line through states at yield: friction angle and macroscopic cohesion."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from postproc.macro.fits.least_squares import Fit, Parameter, fit_line, points
from postproc.results import Unavailable


@dataclass(frozen=True, kw_only=True)
class MohrCoulomb:
    """sigma_1 = K sigma_3 + 2 c sqrt(K), K = (1 + sin phi)/(1 - sin phi).

    angle: phi, degrees. cohesion: c, unit of the stresses; a straight line through a curved locus has
    one too. Errors are NaN for two points without errors of their own: any line goes through two.
    """

    angle: Parameter
    cohesion: Parameter
    ratio: Parameter
    chi2: float
    points: int


def mohr_coulomb(
    sigma_3: np.ndarray, sigma_1: np.ndarray, error: np.ndarray | None = None
) -> MohrCoulomb | Unavailable:
    """Fit the line to principal stresses at yield (P,), compression positive.

    error: standard errors of sigma_1 (P,). Errors of sigma_3 are not counted: it is the controlled one.
    Unavailable with the reason: fewer than two points, one sigma_3 only, or K < 1 (no yield locus).
    Source: Mohr-Coulomb; the talk's c(k_c/k_2) and 13 degrees follow from its table this way.
    """
    data = points(sigma_3, sigma_1, error)
    fit = _through_two(data) if data.count == 2 and error is None else fit_line(data)
    if isinstance(fit, Unavailable):
        return fit
    K, b = (float(p) for p in fit.parameters)
    if K < 1.0:
        return Unavailable(reason=f"slope {K:.3g} of sigma_1 over sigma_3 is below 1: no Mohr-Coulomb line")
    root = np.sqrt(K)
    to_angle = np.array([1.0 / (root * (K + 1.0)), 0.0])  # phi = 2 atan(sqrt K) - 90 degrees
    to_cohesion = np.array([-b / (4.0 * K * root), 1.0 / (2.0 * root)])
    return MohrCoulomb(
        angle=Parameter(value=float(np.degrees(2.0 * np.arctan(root) - np.pi / 2.0)),
                       error=float(np.degrees(_error(fit, to_angle)))),
        cohesion=Parameter(value=b / (2.0 * root), error=_error(fit, to_cohesion)),
        ratio=fit.parameter(0), chi2=fit.chi2, points=fit.points,
    )


def _through_two(data) -> Fit | Unavailable:
    if data.x[0] == data.x[1]:
        return Unavailable(reason="both points have one sigma_3")
    slope = (data.y[1] - data.y[0]) / (data.x[1] - data.x[0])
    line = np.array([slope, data.y[0] - slope * data.x[0]])
    return Fit(parameters=line, covariance=np.full((2, 2), np.nan), chi2=np.nan, points=2)


def _error(fit: Fit, gradient: np.ndarray) -> float:
    return float(np.sqrt(gradient @ fit.covariance @ gradient))
