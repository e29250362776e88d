"""The numbers of one ring run: torques, the band, the exponents of its stresses; each with a standard error."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from harness.studies.compare.band import V_0, WIDTH, Band, band_in_time
from harness.studies.compare.profiles import ROUNDING, Profile, RingProfiles, mean_over
from harness.studies.compare.ring_balances import RingBalances
from postproc.macro.fits.least_squares import Parameter
from postproc.macro.fits.power_law import PowerLaw, fit_power_law
from postproc.results import Unavailable


@dataclass(frozen=True, kw_only=True)
class Number:
    """A value, its standard error (None: not known) and its unit."""

    value: float
    error: float | None
    unit: str


INNER, OUTER = "torque on the inner ring", "torque on the outer ring"
PRESSURE, IN_BAND = "pressure", "volume fraction in the band"
"""Names of numbers."""

EXPONENTS = ("stress_rr", "stress_phiphi", "stress_rphi", "stress_phir")
"""Stresses whose power of r is fitted, a mean diameter away from both rings.

The talk: sigma_rr ~ r^0, sigma_rphi ~ r^-2."""

FROM_RINGS = 1.0
"""Mean diameters next to a ring that the powers of r leave out: averages over grains do not resolve its layers."""


def ring_numbers(profiles: RingProfiles, balances: RingBalances, band: Band) -> Mapping[str, Number]:
    """Return the numbers by name; what there is not is left out."""
    found = {
        INNER: _of_profile(balances.inner),
        OUTER: _of_profile(balances.outer),
    }
    if balances.drag is not None:
        found["torque of the drag"] = _of_profile(balances.drag)
    if balances.mean_pressure is not None:
        found[PRESSURE] = _of_profile(balances.mean_pressure)
    inside = in_band(profiles, band)
    if inside is not None:
        found[IN_BAND] = _of_profile(inside)
    if band.fit is not None:
        v0, (v, dv, _) = band.fit.v0, band.nearest
        found[V_0] = Number(value=v0.value, error=v0.error * band.stretch, unit="1")
        found["velocity in the cell at the inner ring over its own"] = Number(value=v, error=dv, unit="1")
        found[WIDTH] = Number(value=band.width, error=band.width_error, unit="1")
    if band.weighted:
        found["chi^2/dof of the exponential"] = Number(value=band.fit.chi2, error=None, unit="1")
        found["degrees of freedom of the exponential"] = Number(value=float(band.freedom), error=None, unit="1")
    for name in EXPONENTS:
        power = exponent_of(profiles, name, band.diameter)
        if isinstance(power, PowerLaw):
            found[f"power of r of {name}"] = _of(power.exponent, "1")
    return found


def numbers_in_time(profiles: RingProfiles, balances: RingBalances, band: Band) -> dict[str, Profile]:
    """Return the numbers that codes are compared by, with the errors of their time averages; what there is not is
    left out."""
    numbers = {
        INNER: balances.inner, OUTER: balances.outer, PRESSURE: balances.mean_pressure,
        **band_in_time(profiles, band), IN_BAND: in_band(profiles, band),
    }
    return {name: p for name, p in numbers.items() if p is not None and np.isfinite(p.mean[0])}


def in_band(profiles: RingProfiles, band: Band) -> Profile | None:
    """Mean volume fraction of the cells within the reach of the band, by their areas; None without such a cell.

    That of the whole ring is set by the discs and their number; where they are is not.
    """
    p = profiles.profiles.get("volume_fraction")
    inside = profiles.edges[1:] <= (profiles.edges[0] + band.reach) * (1.0 + ROUNDING)
    if p is None or p.series is None or not inside.any():
        return None
    return mean_over(p, inside, np.diff(profiles.edges**2))


def exponent_of(profiles: RingProfiles, name: str, diameter: float) -> PowerLaw | Unavailable:
    """Fit a power of r to a stress between the layers at the rings."""
    p = profiles.profiles.get(name)
    if p is None:
        return Unavailable(reason=profiles.absent[name])
    low, high = profiles.edges[0] + FROM_RINGS * diameter, profiles.edges[-1] - FROM_RINGS * diameter
    known = p.error > 0
    return fit_power_law(profiles.r[known], p.mean[known], p.error[known], low=low, high=high)


def _of_profile(p: Profile) -> Number:
    return Number(value=float(p.mean[0]), error=float(p.error[0]), unit=p.unit)


def _of(p: Parameter, unit: str) -> Number:
    return Number(value=p.value, error=p.error, unit=unit)
