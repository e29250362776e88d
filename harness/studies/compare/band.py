"""The shear band of a ring: whether there is one, how fast its discs are at the wall, how wide it is."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from harness.scene.model import Couette
from harness.scene.system import System
from harness.studies.compare.profiles import RingProfiles
from harness.studies.verdict import Check, Rerun, not_checked
from postproc.macro.fits.shear_band import ShearBand, fit_shear_band
from postproc.results import Unavailable
from reference.values import Published, published_values

SLIPS = 0.05
"""Speed of the discs at the inner ring over the ring's below which nothing is sheared: the rough ring slips."""

FALLEN = 0.1
"""Speed at the outer ring over that at the inner one above which the discs turn as a body."""

WIDEST = 0.5
"""Width of a band over the gap above which it is none."""

KNOWN_TO = 0.25
"""Standard error of s/d above which its place in a range of 1 to 2 cannot be told."""

PUBLISHED = "talk_shear_band_width"
TWO_SIDED = 1.96
"""Standard errors beyond the range that the width may lie by chance (5 %)."""


@dataclass(frozen=True, kw_only=True)
class Band:
    """Velocity profile of one run against v_0 exp(-(r - R_i)/s).

    fit: None if there is none. why: "" if a shear band exists, else why there is none. diameter: mean of the discs, m.
    error: standard error of s, m, times the square root of chi2 if that is above 1: then one exponential is
    too simple a model, and the scatter about it says how well s is known.
    """

    fit: ShearBand | None
    why: str
    diameter: float
    error: float

    @property
    def width(self) -> float:
        """s/d."""
        return self.fit.s.value / self.diameter

    @property
    def width_error(self) -> float:
        """Standard error of s/d."""
        return self.error / self.diameter


def band_of(profiles: RingProfiles, scene: Couette, system: System) -> Band:
    """Fit the velocity profile within `compare.band` of the inner ring, and say whether this is a shear band."""
    rings, diameter = scene.rings, 2.0 * float(system.particles.radius.mean())
    wall, v = rings.omega * rings.inner_radius, profiles.profiles.get("v_phi")
    if v is None:
        return Band(fit=None, why=profiles.absent["v_phi"], diameter=diameter, error=math.nan)
    known = np.isfinite(v.mean)
    errors = v.error[known] if (v.error[known] > 0).all() else None
    fit = fit_shear_band(
        profiles.r[known], v.mean[known], errors, inner_radius=rings.inner_radius, wall_speed=wall, diameter=diameter,
        high=scene.compare.band / diameter,
    )
    if isinstance(fit, Unavailable):
        return Band(fit=None, why=fit.reason, diameter=diameter, error=math.nan)
    error = fit.s.error * math.sqrt(max(fit.chi2, 1.0)) if np.isfinite(fit.chi2) else fit.s.error
    why = _none(fit, v.mean[known] / wall, rings.outer_radius - rings.inner_radius)
    return Band(fit=fit, why=why, diameter=diameter, error=error)


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
    says = f"ours {width:.3g} +- {error:.2g}, v_0 = {np.mean([b.fit.v0.value for b in bands]):.3g}"
    if not error <= KNOWN_TO:
        return Check(**facts, verdict="inconclusive", why=f"{says}: not known to {KNOWN_TO:g}; average longer")
    if low <= width <= high:
        return Check(**facts, verdict="agrees", why=says)
    beyond = max(low - width, width - high) / error if error else math.inf
    if beyond <= TWO_SIDED:
        return Check(**facts, verdict="inconclusive", why=f"{says}: outside by {beyond:.2g} standard errors only")
    return Check(**facts, verdict="differs", why=f"{says}; rerun: {rerun}")


def _mean_width(bands: Sequence[Band]) -> tuple[float, float]:
    """Mean of s/d over packings and its standard error; of a single one the fit's."""
    widths = np.array([b.width for b in bands])
    if len(bands) == 1:
        return float(widths[0]), bands[0].width_error
    return float(widths.mean()), float(widths.std(ddof=1) / np.sqrt(len(bands)))
