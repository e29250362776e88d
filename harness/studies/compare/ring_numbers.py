"""The numbers of one ring run: torques, the band, the exponents of its stresses; each with a standard error."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from harness.studies.compare.band import Band
from harness.studies.compare.profiles import Profile, RingProfiles
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


EXPONENTS = ("stress_rr", "stress_phiphi", "stress_rphi", "stress_phir")
"""Stresses whose power of r is fitted, a mean diameter away from both rings.

The talk: sigma_rr ~ r^0, sigma_rphi ~ r^-2."""

FROM_RINGS = 1.0
"""Mean diameters next to a ring that the powers of r leave out: averages over grains do not resolve its layers."""


def ring_numbers(profiles: RingProfiles, balances: RingBalances, band: Band) -> Mapping[str, Number]:
    """Return the numbers by name; what there is not is left out."""
    found = {
        "torque on the inner ring": _of_profile(balances.inner),
        "torque on the outer ring": _of_profile(balances.outer),
    }
    if balances.drag is not None:
        found["torque of the drag"] = _of_profile(balances.drag)
    if np.isfinite(balances.pressure):
        found["pressure"] = Number(value=balances.pressure, error=None, unit="N/m")
    if band.fit is not None:
        found["v_0 (velocity at the inner ring over its own)"] = _of(band.fit.v0, "1")
        found["s/d (width of the band)"] = Number(value=band.width, error=band.width_error, unit="1")
        found["chi^2 of the exponential"] = Number(value=band.fit.chi2, error=None, unit="1")
    for name in EXPONENTS:
        power = exponent_of(profiles, name, band.diameter)
        if isinstance(power, PowerLaw):
            found[f"power of r of {name}"] = _of(power.exponent, "1")
    return found


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
