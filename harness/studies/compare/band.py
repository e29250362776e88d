"""The shear band of a ring: whether there is one, how fast its discs are at the wall, how wide it is.

One exponential is a model, and the longer the average, the surer it fails: velocities fall fast next to the ring and
slowly where the discs creep. Its chi^2 says whether it holds. Where it does, s has the error of the fit. Where it does
not, no error bar of the fit means what it says: the square root of chi^2 (R. T. Birge, Phys. Rev. 40, 207 (1932)) makes
up for errors that are too small, not for a curve that is another one. Then there are several widths, and the range of
the talk is met or missed only if all of them say so: that of the whole fit and those of its inner and its outer half.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from harness.scene.model import Couette
from harness.scene.system import System
from harness.studies.compare.profiles import Profile, RingProfiles, number_of
from harness.studies.verdict import Check, Rerun, not_checked
from postproc.macro.fits.shear_band import ShearBand, fit_shear_band
from postproc.propagation import linearised
from postproc.results import Unavailable
from reference.values import Published, published_values

SLIPS = 0.05
"""Speed of the discs at the inner ring over the ring's below which nothing is sheared: the rough ring slips."""

FALLEN = 0.1
"""Speed at the outer ring over that at the inner one above which the discs turn as a body."""

WIDEST = 0.5
"""Width of a band over the gap above which it is none."""

MISFIT = 0.01
"""Probability of a chi^2 as large as found below which one exponential does not describe the velocities."""

KNOWN_TO = 0.25
"""Standard error of s/d above which its place in a range of 1 to 2 cannot be told."""

V_0, WIDTH = "v_0 (velocity at the inner ring over its own)", "s/d (width of the band)"
"""The numbers of a band by name."""

PUBLISHED = "talk_shear_band_width"
TWO_SIDED = 1.96
"""Standard errors beyond the range that the width may lie by chance (5 %)."""


@dataclass(frozen=True, kw_only=True)
class Band:
    """Velocity profile of one run against v_0 exp(-(r - R_i)/s).

    fit: None if there is none. why: "" if a shear band exists, else why there is none. diameter: mean of the discs, m.
    wall: velocity of the inner ring, m/s. reach: distance from it up to which was fitted, m. error: standard error of
    s, m, times the square root of chi2 if that is above 1. halves: fits to the inner and the outer half of the range,
    or why there is none. nearest: velocity in the cell at the ring over the ring's, its error, distance of the cell's
    middle, m.
    """

    fit: ShearBand | None
    why: str
    diameter: float
    wall: float
    reach: float
    error: float = math.nan
    halves: tuple[ShearBand | Unavailable, ...] = ()
    nearest: tuple[float, float, float] = (math.nan, math.nan, math.nan)

    @property
    def width(self) -> float:
        """s/d."""
        return self.fit.s.value / self.diameter

    @property
    def width_error(self) -> float:
        """Standard error of s/d."""
        return self.error / self.diameter

    @property
    def stretch(self) -> float:
        """What errors of the fit are to be multiplied by, sqrt(chi2) or 1."""
        return math.sqrt(max(self.fit.chi2, 1.0)) if self.weighted else 1.0

    @property
    def weighted(self) -> bool:
        """Whether there are error bars, so that chi2 means something."""
        return self.fit is not None and self.fit.method == "weighted" and math.isfinite(self.fit.chi2)

    @property
    def freedom(self) -> int:
        """Degrees of freedom of the fit."""
        return self.fit.points - PARAMETERS

    @property
    def misfit(self) -> str:
        """Why one exponential does not describe the velocities, "" if it does."""
        from scipy.stats import chi2

        if not self.weighted:
            return ""
        p = float(chi2.sf(self.fit.chi2 * self.freedom, self.freedom))
        if p >= MISFIT:
            return ""
        widths = ", ".join(f"{at} {_width_in_words(half, self.diameter)}" for at, half in zip(PARTS, self.halves,
                                                                                          strict=True))
        return (
            f"one exponential does not describe it: chi^2/dof = {self.fit.chi2:.3g} ({self.freedom} degrees of "
            f"freedom, p = {p:.1g}); s/d in the halves of its range: {widths}"
        )


PARAMETERS = 2
"""Of the fit: v_0 and s."""

PARTS = ("inner", "outer")
"""Halves of the range."""


def _width_in_words(half: ShearBand | Unavailable, diameter: float) -> str:
    if isinstance(half, Unavailable):
        return f"none ({half.reason})"
    return f"{half.s.value / diameter:.3g} +- {half.s.error / diameter:.2g}"


def band_of(profiles: RingProfiles, scene: Couette, system: System) -> Band:
    """Fit the velocity profile within `compare.band` of the inner ring, and say whether this is a shear band."""
    rings, diameter = scene.rings, 2.0 * float(system.particles.radius.mean())
    facts = {"diameter": diameter, "wall": rings.omega * rings.inner_radius, "reach": scene.compare.band}
    v = profiles.profiles.get("v_phi")
    if v is None:
        return Band(fit=None, why=profiles.absent["v_phi"], **facts)
    none = Band(fit=None, why="", **facts)
    fit = _fit(profiles, v.mean, none)
    if isinstance(fit, Unavailable):
        return replace(none, why=fit.reason)
    known = np.isfinite(v.mean)
    why = _none(fit, v.mean[known] / none.wall, rings.outer_radius - rings.inner_radius)
    halves = tuple(_fit(profiles, v.mean, none, *part) for part in ((0.0, 0.5), (0.5, 1.0)))
    at = int(np.argmax(known))
    nearest = (v.mean[at] / none.wall, v.error[at] / abs(none.wall), profiles.r[at] - rings.inner_radius)
    band = replace(none, fit=fit, why=why, halves=halves, nearest=tuple(map(float, nearest)))
    return replace(band, error=fit.s.error * band.stretch)


def _fit(
    profiles: RingProfiles, velocity: np.ndarray, band: Band, low: float = 0.0, high: float = 1.0
) -> ShearBand | Unavailable:
    """Fit velocities (K,), with the errors of the average, from `low` to `high` of the reach."""
    known, error = np.isfinite(velocity), profiles.profiles["v_phi"].error
    errors = error[known] if (error[known] > 0).all() else None
    reach = band.reach / band.diameter
    return fit_shear_band(
        profiles.r[known], velocity[known], errors, inner_radius=float(profiles.edges[0]), wall_speed=band.wall,
        diameter=band.diameter, low=low * reach, high=high * reach,
    )


def band_in_time(profiles: RingProfiles, band: Band) -> dict[str, Profile]:
    """Return v_0 and s/d as numbers with the errors of their time averages (`postproc.propagation`).

    These say how far the same fit to another run of the same code may lie; what the model misses is in both alike.
    Nothing without a band.
    """
    if band.fit is None or band.why:
        return {}
    v = profiles.profiles["v_phi"]
    series = np.where(np.isfinite(v.series), v.series, v.mean)

    def fitted(means: Mapping[str, np.ndarray]) -> np.ndarray:
        fit = _fit(profiles, means["v_phi"], band)
        failed = isinstance(fit, Unavailable)
        return np.full(PARAMETERS, np.nan) if failed else np.array([fit.v0.value, fit.s.value / band.diameter])

    both = linearised(fitted, {"v_phi": series})
    return {name: number_of(both[:, k], "1") for k, name in enumerate((V_0, WIDTH))}


def _none(fit: ShearBand, speed: np.ndarray, gap: float) -> str:
    """Say why a fitted profile is no shear band, "" if it is one. speed: of the discs over the ring's, by radius."""
    if fit.v0.value < SLIPS:
        return f"the inner ring slips: discs at it have {fit.v0.value:.2g} of its speed, a band needs {SLIPS:g}"
    if speed[-1] > FALLEN * speed[0]:
        return (
            f"the discs turn as a body: at the outer ring they have {speed[-1] / speed[0]:.2g} of the speed at the "
            f"inner one, in a band at most {FALLEN:g}"
        )
    if fit.s.value > WIDEST * gap:
        return f"the velocity falls over {fit.s.value / gap:.2g} of the gap, in a band over {WIDEST:g} at most"
    return ""


def band_checks(engines: Sequence[str], bands: Mapping[str, Mapping[int, Band]], rerun: Rerun) -> list[Check]:
    """Each engine's width against the talk's range, in the sheared regime only (L3)."""
    published = published_values()[PUBLISHED]
    return [_band_check(published, e, list(bands.get(e, {}).values()), rerun(e)) for e in engines]


def _band_check(published: Published, engine: str, bands: Sequence[Band], rerun: str) -> Check:
    low, high = (published.value * (1.0 + sign * published.tolerance) for sign in (-1, 1))
    facts = {
        "level": "L3", "quantity": f"{published.quantity} against {low:g} to {high:g}", "left": engine,
        "right": published.origin,
    }
    if not bands:
        return not_checked(**facts, why=f"no completed run of {engine}")
    none = next((b.why for b in bands if b.why), "")
    if none:
        return not_checked(**facts, why=f"no shear band: {none}")
    width, error = _mean_width(bands)
    facts |= {"deviation": abs(width - published.value) / published.value, "tolerance": published.tolerance}
    says = _says(width, error, bands)
    misfit = next((b.misfit for b in bands if b.misfit), "")
    if misfit:
        return _of_several_widths(facts, width, bands, (low, high), f"{says}; {misfit}", rerun)
    if not error <= KNOWN_TO:
        return Check(**facts, verdict="inconclusive", why=f"{says}: not known to {KNOWN_TO:g}; average longer")
    if low <= width <= high:
        return Check(**facts, verdict="agrees", why=says)
    beyond = max(low - width, width - high) / error if error else math.inf
    if beyond <= TWO_SIDED:
        return Check(**facts, verdict="inconclusive", why=f"{says}: outside by {beyond:.2g} standard errors only")
    return Check(**facts, verdict="differs", why=f"{says}; rerun: {rerun}")


def _says(width: float, error: float, bands: Sequence[Band]) -> str:
    """Say what was found, and what was measured next to the ring where v_0 is the fit's."""
    v0, (v, dv, depth) = np.mean([b.fit.v0.value for b in bands]), bands[0].nearest
    fit = bands[0].fit
    there = fit.v0.value * math.exp(-depth / fit.s.value)
    return (
        f"ours {width:.3g} +- {error:.2g}, v_0 = {v0:.3g} (in the cell {1e3 * depth:.2g} mm from the ring measured "
        f"{v:.3g} +- {dv:.2g}, by the fit {there:.3g})"
    )


def _of_several_widths(
    facts: dict, width: float, bands: Sequence[Band], wanted: tuple[float, float], says: str, rerun: str
) -> Check:
    """Judge a profile that is no single exponential by all its widths, see the module; NaN lies nowhere."""
    low, high = wanted
    found = [half.s.value / b.diameter if isinstance(half, ShearBand) else math.nan for b in bands for half in b.halves]
    widths = np.array([width, *found])
    if ((widths >= low) & (widths <= high)).all():
        return Check(**facts, verdict="agrees", why=f"{says}: all within")
    if (widths < low).all() or (widths > high).all():
        return Check(**facts, verdict="differs", why=f"{says}: all outside; rerun: {rerun}")
    return Check(**facts, verdict="inconclusive", why=f"{says}: not all of these widths lie within {low:g} to {high:g}")


def _mean_width(bands: Sequence[Band]) -> tuple[float, float]:
    """Mean of s/d over packings and its standard error; of a single one the fit's."""
    widths = np.array([b.width for b in bands])
    if len(bands) == 1:
        return float(widths[0]), bands[0].width_error
    return float(widths.mean()), float(widths.std(ddof=1) / np.sqrt(len(bands)))
