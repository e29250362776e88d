"""What is measured in one run of a ring: profiles, balances, the band, and numbers formed of them.

Profiles, balances and the band are those of `grainproof compare` (`harness.studies.compare`); here stand the forms in
which the talk puts them: powers of r, decay of the dynamic stress, layers at the inner ring, distributions.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from harness.scene.model import Couette
from harness.studies.compare.band import Band, band_of
from harness.studies.compare.profiles import RingProfiles, ring_profiles, steady_frames, subject_of
from harness.studies.compare.ring_balances import RingBalances, ring_balances
from harness.studies.compare.ring_curves import RingCurves, ring_curves
from harness.studies.compare.ring_numbers import FROM_RINGS, Number
from postproc.macro.distributions import Distribution, distribution
from postproc.macro.fits.least_squares import Points, fit_line, points
from postproc.macro.fits.power_law import fit_power_law, logarithmic
from postproc.results import Unavailable

if TYPE_CHECKING:
    from harness.scene.system import System
    from harness.studies.reproduce.protocol import Case
    from postproc.fields import Subject
    from postproc.snapshot import Snapshot
    from postproc.trajectory import Trajectory

LAYER = 2.0
"""Mean diameters from the inner ring within which discs belong to the band, in distributions."""

BINS = 60

STATIC = {
    "power of r of r sigma_rr": ("stress_rr", 1), "power of r of r sigma_phiphi": ("stress_phiphi", 1),
    "power of r of sigma_rphi": ("stress_rphi", 0), "power of r of sigma_phir": ("stress_phir", 0),
}
"""Profile, and the power of r that it is multiplied by: the talk's sigma_rr ~ r^0 is r sigma_rr ~ r^1, which has a size
that a deviation can be a part of, as it stands in d(r sigma_rr)/dr = sigma_phiphi."""

COMPONENTS = {"stress_rr": (0, 0), "stress_phiphi": (1, 1), "stress_rphi": (0, 1), "stress_phir": (1, 0)}

BLOCKS = 10
"""Parts of the steady time that the jackknife leaves out one by one."""

KINETIC = ("kinetic_stress_rr", "kinetic_stress_phiphi")


@dataclass(frozen=True, kw_only=True, eq=False)
class RingRun:
    """One run of a ring. numbers: by name. speeds, spins: distributions of discs next to the inner ring over its own.

    inside: (K,) cells a mean diameter away from both rings, which averages over grains resolve.
    """

    scene: Couette
    system: System
    curves: RingCurves
    profiles: RingProfiles
    balances: RingBalances
    band: Band
    inside: np.ndarray
    numbers: Mapping[str, Number]
    speeds: Distribution
    spins: Distribution

    @property
    def depth(self) -> np.ndarray:
        """(r - R_i)/d of the cells, (K,)."""
        return (self.profiles.r - self.scene.rings.inner_radius) / self.band.diameter


def measure_ring(case: Case, trajectory: Trajectory, system: System) -> RingRun:
    """Measure a finished run over its steady frames."""
    scene, curves = case.scene, ring_curves(trajectory)
    frames = steady_frames(trajectory, scene)
    subjects = [subject_of(f, scene, system) for f in frames]
    profiles = ring_profiles(subjects, system)
    band = band_of(profiles, scene, system)
    away = FROM_RINGS * band.diameter
    inside = (profiles.edges[:-1] >= profiles.edges[0] + away) & (profiles.edges[1:] <= profiles.edges[-1] - away)
    balances = ring_balances(curves, subjects, system)
    return RingRun(
        scene=scene, system=system, curves=curves, profiles=profiles, balances=balances, band=band, inside=inside,
        numbers=_numbers(scene, profiles, balances, band, inside) | _exponents(profiles, subjects, inside),
        speeds=_distribution(frames, scene, band, _speed), spins=_distribution(frames, scene, band, _spin),
    )


def _numbers(
    scene: Couette, profiles: RingProfiles, balances: RingBalances, band: Band, inside: np.ndarray
) -> dict[str, Number]:
    found = {"torque on the inner ring": _of_mean(balances.inner), "torque on the outer ring": _of_mean(balances.outer)}
    if band.fit is not None:
        found["v_0"] = Number(value=band.fit.v0.value, error=band.fit.v0.error, unit="1")
        found["s/d"] = Number(value=band.width, error=band.width_error, unit="1")
    for stress in KINETIC:
        _put(found, f"decay length of {stress} over d", _decay(profiles, stress, scene, band))
    return found | _layers(scene, profiles, band, inside) | _angles(profiles, inside)


def _put(found: dict[str, Number], name: str, number: Number | Unavailable) -> None:
    if not isinstance(number, Unavailable):
        found[name] = number


def _of_mean(profile) -> Number:
    return Number(value=float(profile.mean[0]), error=float(profile.error[0]), unit="N m")


# --- powers and decays ---------------------------------------------------------------------------


def _exponents(profiles: RingProfiles, subjects: Sequence[Subject], inside: np.ndarray) -> dict[str, Number]:
    """Fit powers of r to the static stresses, each times a power of r; errors by the jackknife over BLOCKS of time.

    The torque fluctuates as a whole, so that all cells move up and down together: their error bars say how well its
    size is known, and its power of r is known much better.
    """
    if "stress_rr" not in profiles.profiles:
        return {}
    series = np.array([s.stress for s in subjects])
    parts = np.array_split(np.arange(len(series)), BLOCKS)
    sums, total = np.array([series[p].sum(axis=0) for p in parts]), len(series)
    without = [(series.sum(axis=0) - of) / (total - len(p)) for of, p in zip(sums, parts, strict=True)]
    found = {}
    for name, (stress, power) in STATIC.items():
        a, b = COMPONENTS[stress]
        weight = profiles.profiles[stress].error
        used = inside & (weight > 0)
        fits = [_power(profiles.r, m[:, a, b], weight, power, used) for m in (series.mean(axis=0), *without)]
        if any(isinstance(f, Unavailable) for f in fits):
            continue
        values = np.array([f.exponent.value for f in fits])
        jackknife = math.sqrt((BLOCKS - 1) / BLOCKS * float(((values[1:] - values[1:].mean()) ** 2).sum()))
        found[name] = Number(value=float(values[0]), error=jackknife, unit="1")
    return found


def _power(r: np.ndarray, stress: np.ndarray, weight: np.ndarray, power: int, used: np.ndarray):
    factor = r[used] ** power
    return fit_power_law(r[used], factor * stress[used], factor * weight[used])


def _decay(profiles: RingProfiles, stress: str, scene: Couette, band: Band) -> Number | Unavailable:
    """Fit exp(-(r - R_i)/L) to a dynamic stress within the band's range; L over d."""
    p = profiles.profiles.get(stress)
    if p is None:
        return Unavailable(reason=profiles.absent[stress])
    depth = (profiles.r - scene.rings.inner_radius) / band.diameter
    used = (depth <= scene.compare.band / band.diameter) & (p.error > 0) & (p.mean > 0)
    line = fit_line(logarithmic(_points(depth[used], p.mean[used], p.error[used]), depth[used]))
    if isinstance(line, Unavailable):
        return line
    slope = line.parameter(0)
    if slope.value >= 0:
        return Unavailable(reason="the dynamic stress does not decay")
    error = _scattered(slope.error, line.chi2) / slope.value**2
    return Number(value=-1 / slope.value, error=error, unit="1")


def _points(x: np.ndarray, y: np.ndarray, error: np.ndarray) -> Points:
    return points(x, y, error)


def _scattered(error: float, chi2: float) -> float:
    return error * math.sqrt(max(chi2, 1.0)) if np.isfinite(chi2) else error


# --- layers at the inner ring, angles ------------------------------------------------------------


def _layers(scene: Couette, profiles: RingProfiles, band: Band, inside: np.ndarray) -> dict[str, Number]:
    """Return the density of the first layers and outside, the spin of the first ones, the fabric at both places."""
    depth = (profiles.r - scene.rings.inner_radius) / band.diameter
    near, far = inside & (depth <= scene.compare.band / band.diameter / 2), inside & (depth > depth.max() / 2)
    found = {}
    for name, profile, unit in (("area fraction", "volume_fraction", "1"), ("tr F", "fabric_trace", "1"),
                                ("dev F", "fabric_deviator", "1")):
        p = profiles.profiles.get(profile)
        if p is not None:
            found[f"{name} in the band"] = _over_cells(p, near, unit)
            found[f"{name} outside"] = _over_cells(p, far, unit)
    spin = profiles.profiles.get("eigen_rotation")
    if spin is not None:
        found |= _oscillation(spin, depth, scene.rings.omega)
    return found


def _over_cells(profile, cells: np.ndarray, unit: str) -> Number:
    """Mean over cells; their errors move together, so that of the mean is the mean of the errors."""
    value, error = (float(np.nanmean(v[cells])) for v in (profile.mean, profile.error))
    return Number(value=value, error=error, unit=unit)


def _oscillation(spin, depth: np.ndarray, omega: float) -> dict[str, Number]:
    """Return the eigen-rotation's extremes within four diameters over Omega: layers that roll on each other."""
    near = (depth <= 2 * LAYER) & np.isfinite(spin.mean)
    if not near.any():
        return {}
    value, error = spin.mean[near] / omega, spin.error[near] / abs(omega)
    low, high = int(np.argmin(value)), int(np.argmax(value))
    return {
        f"eigen-rotation over Omega, {word} near the inner ring":
        Number(value=float(value[k]), error=float(error[k]), unit="1")
        for word, k in (("lowest", low), ("highest", high))
    }


def _angles(profiles: RingProfiles, inside: np.ndarray) -> dict[str, Number]:
    """Return the mean angle from the stress's major direction to those of strain and fabric, degrees."""
    found = {}
    for other in ("strain", "fabric"):
        p = profiles.profiles.get(f"non_colinearity_stress_{other}")
        if p is None:
            continue
        used = inside & np.isfinite(p.mean) & (p.error > 0)
        if used.sum() < 2:
            continue
        weight = 1 / p.error[used] ** 2
        mean = float((weight * p.mean[used]).sum() / weight.sum())
        chi2 = float((weight * (p.mean[used] - mean) ** 2).sum() / (used.sum() - 1))
        error = _scattered(float(1 / np.sqrt(weight.sum())), chi2)
        found[f"angle from stress to {other}"] = Number(value=mean, error=error, unit="deg")
    return found


# --- distributions -------------------------------------------------------------------------------


def _distribution(
    frames: Sequence[Snapshot], scene: Couette, band: Band, of: Callable[[Snapshot], np.ndarray]
) -> Distribution:
    """Distribution of a number of the discs within LAYER diameters of the inner ring, over that of the ring."""
    rings = scene.rings
    values = []
    for frame in frames:
        r = np.hypot(frame.particles["x"], frame.particles["y"])
        near = r - rings.inner_radius <= LAYER * band.diameter
        values.append(of(frame)[near])
    scale = rings.omega if of is _spin else rings.omega * rings.inner_radius
    edges = np.linspace(-25, 15, BINS + 1) if of is _spin else np.linspace(-0.5, 1.5, BINS + 1)
    return distribution([v / scale for v in values], edges)


def _speed(frame: Snapshot) -> np.ndarray:
    """v_phi of each disc about the origin, m/s."""
    p = frame.particles
    return (p["x"] * p["vy"] - p["y"] * p["vx"]) / np.hypot(p["x"], p["y"])


def _spin(frame: Snapshot) -> np.ndarray:
    return frame.particles["wz"]
