"""The shear band of the ring: an exponential velocity profile at the inner wall."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from postproc.macro.fits.least_squares import Fit, Parameter, Points, fit_curve, fit_line, points, too_few
from postproc.macro.fits.power_law import logarithmic
from postproc.results import Unavailable

RANGE = 6.0
"""Mean diameters from the wall within which the profile is fitted by default: farther out the published
profiles end in a plateau of noise, 1e-3 to 1e-4 of the wall's speed."""


@dataclass(frozen=True, kw_only=True)
class ShearBand:
    """v_phi(r)/v_wall = v0 exp(-(r - R_i)/s) for low <= r - R_i <= high.

    v0: velocity of the grains at the wall over that of the wall, below 1 where they slip. s: m.
    method: "weighted" or "logarithmic".
    """

    v0: Parameter
    s: Parameter
    low: float
    high: float
    method: str
    chi2: float
    points: int


def fit_shear_band(
    r: np.ndarray, v_phi: np.ndarray, error: np.ndarray | None = None, *,
    inner_radius: float, wall_speed: float, diameter: float,
    low: float = 0.0, high: float = RANGE,
) -> ShearBand | Unavailable:
    """Fit v0 exp(-(r - R_i)/s) to a velocity profile.

    r: (K,) radii, m. v_phi: (K,), m/s; with errors (K,) the curve itself is fitted, weighted ("weighted"),
    and velocities may be of any sign; without, ln v is, every point with one relative error
    ("logarithmic"), which needs v of the wall's sign. wall_speed: Omega R_i, m/s, signed.
    low, high: range of (r - R_i) in diameters (m), both included.

    Unavailable with the reason: too few points, velocities of both signs without errors, no convergence,
    a profile that runs against the wall or does not decay, or a width that is not known better than to itself.
    Source: the talks, "Velocity field" and "width of shearband s/d ~ 1...2"; Laetzel, Luding,
    Herrmann, Granular Matter 2, 123 (2000).
    """
    if not (wall_speed != 0 and np.isfinite(wall_speed)):
        raise ValueError(f"wall_speed: expected a speed other than 0, got {wall_speed}")
    depth, scaled = np.asarray(r) - inner_radius, np.asarray(v_phi) / wall_speed
    data = points(depth, scaled, None if error is None else np.asarray(error) / abs(wall_speed))
    data = data.where((data.x >= low * diameter) & (data.x <= high * diameter))
    place = f"between {low:g} and {high:g} diameters from the wall"
    lacking = too_few(data, 2, place)
    if lacking is not None:
        return lacking
    found = _logarithmic(data, place) if error is None else _weighted(data, diameter)
    if isinstance(found, Unavailable):
        return found
    v0, s, fit = found
    if s.error >= s.value:
        return Unavailable(reason=f"the width is not determined {place}: {s.value:.3g} +- {s.error:.3g} m")
    return ShearBand(
        v0=v0, s=s, low=float(data.x.min()), high=float(data.x.max()), chi2=fit.chi2, points=fit.points,
        method="logarithmic" if error is None else "weighted",
    )


Found = tuple[Parameter, Parameter, Fit]


def _weighted(data: Points, diameter: float) -> Found | Unavailable:
    """Fit v0 exp(-q x/d), the decay q rather than s: a flat profile is q = 0 and not infinity."""
    def profile(x: np.ndarray, v0: float, q: float) -> np.ndarray:
        return v0 * np.exp(-q * x / diameter)

    fit = fit_curve(profile, data, (max(float(np.abs(data.y).max()), 1e-12), 1.0))
    if isinstance(fit, Unavailable):
        return fit
    v0, q = fit.parameter(0), fit.parameter(1)
    return _width(v0, q.value / diameter, q.error / diameter, fit)


def _logarithmic(data: Points, place: str) -> Found | Unavailable:
    backward = int((data.y <= 0).sum())
    if backward:
        return Unavailable(reason=f"{backward} of {data.count} velocities {place} do not point along the wall's; "
                                  "give standard errors, or a narrower range")
    fit = fit_line(logarithmic(data, data.x), place=place)
    if isinstance(fit, Unavailable):
        return fit
    slope, height = fit.parameter(0), fit.parameter(1)
    v0 = float(np.exp(height.value))
    return _width(Parameter(value=v0, error=v0 * height.error), -slope.value, slope.error, fit)


def _width(v0: Parameter, decay: float, error: float, fit: Fit) -> Found | Unavailable:
    """s = 1/decay, error(s) = error(decay)/decay^2."""
    if v0.value <= 0:
        return Unavailable(reason=f"the grains at the wall move against it: v0 = {v0.value:.3g} +- {v0.error:.3g}")
    if decay <= 0:
        return Unavailable(reason=f"the profile does not decay: slope of ln v {-decay:.3g} +- {error:.3g} 1/m")
    return v0, Parameter(value=1.0 / decay, error=error / decay**2), fit
