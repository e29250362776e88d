"""The shear band of a ring: whether there is one, how fast its discs are at the wall, how wide it is.

One exponential is a model, and the longer the average, the surer it fails: velocities fall fast next to the ring and
slowly where the discs creep. Its chi^2 says whether it holds. Where it does, s has the error of the fit. Where it does
not, no error bar of the fit means what it says: the square root of chi^2 (R. T. Birge, Phys. Rev. 40, 207 (1932)) makes
up for errors that are too small, not for a curve that is another one. Then there are several widths, and the range of
the talk is met or missed only if all of them say so: that of the whole fit and those of its inner and its outer half.

That a width lies outside the range is seen at a rate of false alarms that is shared with all other tests of a report
(`harness.studies.compare.alarms`). That several do has the largest of their p-values (an intersection of refutations:
R. L. Berger, Technometrics 24, 295 (1982), doi 10.1080/00401706.1982.10487790).
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from harness.scene.judged import FALSE_ALARMS
from harness.scene.model import Couette
from harness.scene.system import System
from harness.studies.compare.alarms import judged_together
from harness.studies.compare.profiles import Profile, RingProfiles, number_of
from harness.studies.statistics.difference import Difference, p_value
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


@dataclass(frozen=True, kw_only=True)
class Width:
    """s/d over packings, of a single one that of its fit: value, standard error, degrees of freedom; NaN if unknown."""

    value: float
    error: float
    freedom: float

    def outside(self, low: float, high: float) -> float:
        """Return the p-value of "the true width lies from low to high" (Student's t); 1 where the error is unknown."""
        if not (math.isfinite(self.value) and self.error >= 0.0 and self.freedom > 0.0):
            return 1.0
        middle, half = 0.5 * (low + high), 0.5 * (high - low)
        off = Difference(value=self.value - middle, error=self.error, dof=self.freedom, count=1, paired=False)
        return p_value(off, half)


@dataclass(frozen=True, kw_only=True)
class BandTest:
    """Is the width of an engine's band that of the talk? bands: of its packings."""

    published: Published
    engine: str
    bands: tuple[Band, ...]
    rerun: str

    @property
    def range(self) -> tuple[float, float]:
        """Of the talk."""
        low, high = (self.published.value * (1.0 + sign * self.published.tolerance) for sign in (-1, 1))
        return low, high

    @property
    def absent(self) -> str:
        """Why there is nothing to test, "" if there is."""
        if not self.bands:
            return f"no completed run of {self.engine}"
        none = next((b.why for b in self.bands if b.why), "")
        return f"no shear band: {none}" if none else ""

    @property
    def misfit(self) -> str:
        """Why one exponential does not describe the velocities, "" if it does."""
        return next((b.misfit for b in self.bands if b.misfit), "")

    @cached_property
    def width(self) -> Width:
        """Of the whole fit."""
        return _over_packings([Width(value=b.width, error=b.width_error, freedom=b.freedom) for b in self.bands])

    @property
    def p(self) -> float | None:
        """The p-value of "a width of it lies in the range"; None without a band, 1 where the width is not known."""
        if self.absent:
            return None
        if not self.misfit:
            return self.width.outside(*self.range) if self.width.error <= KNOWN_TO else 1.0
        halves = (_over_packings([_half(b, k) for b in self.bands]) for k in range(len(PARTS)))
        return max(w.outside(*self.range) for w in (self.width, *halves))

    def check(self, level: float) -> Check:
        """Return the verdict of a test at this level."""
        low, high = self.range
        facts = {
            "level": "L3", "quantity": f"{self.published.quantity} against {low:g} to {high:g}", "left": self.engine,
            "right": self.published.origin,
        }
        if self.absent:
            return not_checked(**facts, why=self.absent)
        off = abs(self.width.value - self.published.value) / self.published.value
        facts |= {"deviation": off, "tolerance": self.published.tolerance}
        says = _says(self.width, self.bands)
        judge = _of_several_widths if self.misfit else _of_one_width
        return judge(self, facts, says, seen=self.p <= level)


def band_checks(
    engines: Sequence[str], bands: Mapping[str, Mapping[int, Band]], rerun: Rerun, false_alarms: float = FALSE_ALARMS
) -> list[Check]:
    """Judge widths that share their rate of false alarms with nothing else."""
    return judged_together(band_tests(engines, bands, rerun), false_alarms)


def band_tests(
    engines: Sequence[str], bands: Mapping[str, Mapping[int, Band]], rerun: Rerun
) -> list[BandTest]:
    """Return the test of each engine's width against the talk's range, in the sheared regime only (L3)."""
    published = published_values()[PUBLISHED]
    return [
        BandTest(published=published, engine=e, bands=tuple(bands.get(e, {}).values()), rerun=rerun(e)) for e in engines
    ]


def _half(band: Band, part: int) -> Width:
    """The width of one half of the range, its error stretched as that of the whole."""
    fit = band.halves[part]
    if isinstance(fit, Unavailable):
        return Width(value=math.nan, error=math.nan, freedom=math.nan)
    weighted = fit.method == "weighted" and math.isfinite(fit.chi2)
    error = fit.s.error * (math.sqrt(max(fit.chi2, 1.0)) if weighted else 1.0)
    return Width(value=fit.s.value / band.diameter, error=error / band.diameter, freedom=fit.points - PARAMETERS)


def _over_packings(widths: Sequence[Width]) -> Width:
    """Mean over packings and its standard error; a single one has its own."""
    if len(widths) == 1:
        return widths[0]
    values = np.array([w.value for w in widths])
    error = float(values.std(ddof=1) / np.sqrt(len(values)))
    return Width(value=float(values.mean()), error=error, freedom=len(values) - 1.0)


def _says(width: Width, bands: Sequence[Band]) -> str:
    """Say what was found, and what was measured next to the ring where v_0 is the fit's."""
    v0, (v, dv, depth) = np.mean([b.fit.v0.value for b in bands]), bands[0].nearest
    fit = bands[0].fit
    there = fit.v0.value * math.exp(-depth / fit.s.value)
    return (
        f"ours {width.value:.3g} +- {width.error:.2g}, v_0 = {v0:.3g} (in the cell {1e3 * depth:.2g} mm from the ring "
        f"measured {v:.3g} +- {dv:.2g}, by the fit {there:.3g})"
    )


def _of_one_width(test: BandTest, facts: dict, says: str, *, seen: bool) -> Check:
    """Judge a profile that is one exponential."""
    width, error, (low, high) = test.width.value, test.width.error, test.range
    if not error <= KNOWN_TO:
        return Check(**facts, verdict="inconclusive", why=f"{says}: not known to {KNOWN_TO:g}; average longer")
    if low <= width <= high:
        return Check(**facts, verdict="agrees", why=says)
    if seen:
        return Check(**facts, verdict="differs", why=f"{says}; rerun: {test.rerun}")
    beyond = max(low - width, width - high) / error
    return Check(**facts, verdict="inconclusive", why=f"{says}: outside by {beyond:.2g} standard errors only")


def _of_several_widths(test: BandTest, facts: dict, says: str, *, seen: bool) -> Check:
    """Judge a profile that is no single exponential by all its widths, see the module; NaN lies nowhere."""
    says, (low, high) = f"{says}; {test.misfit}", test.range
    found = [
        half.s.value / b.diameter if isinstance(half, ShearBand) else math.nan for b in test.bands for half in b.halves
    ]
    widths = np.array([test.width.value, *found])
    if ((widths >= low) & (widths <= high)).all():
        return Check(**facts, verdict="agrees", why=f"{says}: all within")
    if seen and ((widths < low).all() or (widths > high).all()):
        return Check(**facts, verdict="differs", why=f"{says}: all outside; rerun: {test.rerun}")
    return Check(
        **facts, verdict="inconclusive",
        why=f"{says}: not all of these widths lie within {low:g} to {high:g}, nor are all seen outside",
    )
