"""The numbers of a whole biaxial test: shown for every run, judged only with replicates."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from harness.scene.model import Biaxial
from harness.studies.compare.curves import BiaxialCurves

Plateau = tuple[float, float]

ROUNDING = 1e-12
"""Relative: a sample right at the end of a plateau belongs to it."""

Quantity = tuple[str, Callable[[BiaxialCurves, Plateau], float]]
"""Unit, and how it is formed from curves and the plateau's strain range."""

OF_THE_PEAK: dict[str, Quantity] = {
    "peak sigma_zz": ("N/m", lambda c, _: float(c.smoothed(c.stress_zz)[c.peak.sample])),
    "peak stress ratio": ("1", lambda c, _: float(c.smoothed(c.ratio)[c.peak.sample])),
    "peak friction angle": ("deg", lambda c, _: float(c.smoothed(c.friction_angle)[c.peak.sample])),
    "strain at the peak": ("1", lambda c, _: c.peak.strain),
    "strain at the peak, from": ("1", lambda c, _: c.peak.low),
    "strain at the peak, to": ("1", lambda c, _: c.peak.high),
}
"""Of the first loading branch; of tests that have a peak."""

OF_THE_PLATEAU: dict[str, Quantity] = {
    "plateau sigma_zz": ("N/m", lambda c, p: plateau_mean(c.stress_zz, c, p)),
    "plateau stress ratio": ("1", lambda c, p: plateau_mean(c.ratio, c, p)),
    "plateau friction angle": ("deg", lambda c, p: plateau_mean(c.friction_angle, c, p)),
}
"""Of scenes that declare a plateau."""

OF_THE_TEST: dict[str, Quantity] = {
    "left over right wall force": ("1", lambda c, _: mean_ratio(c.force_left, c.force_right, c)),
    "top over bottom wall force": ("1", lambda c, _: mean_ratio(c.force_top, c.force_bottom, c)),
    "volume strain at the end": ("1", lambda c, _: float(c.volume_strain[-1])),
}

MACRO: dict[str, Quantity] = OF_THE_PEAK | OF_THE_PLATEAU | OF_THE_TEST
"""All, in the order in which they are shown."""


def plateau_mean(values: np.ndarray, curves: BiaxialCurves, plateau: Plateau) -> float:
    """Return the mean over strain, not over time: the drive is slow at its ends.

    NaN (not computed) when fewer than two samples lie in the plateau.
    """
    inside = within(curves.strain, plateau)
    strain = curves.strain[inside]
    if len(strain) < 2:
        return float("nan")
    return float(np.trapezoid(values[inside], strain) / (strain[-1] - strain[0]))


def within(strain: np.ndarray, plateau: Plateau) -> np.ndarray:
    """Return a mask of the samples (S,) in a range of strains."""
    low, high = np.array(plateau) * (1.0 - ROUNDING, 1.0 + ROUNDING)
    return (strain >= low) & (strain <= high)


def macro_values(curves: BiaxialCurves, scene: Biaxial) -> dict[str, float]:
    """Return the numbers of one test by name, without those of a peak or a plateau that there is not."""
    plateau = scene.compare.plateau
    wanted = dict(OF_THE_TEST)
    if plateau is not None:
        wanted = OF_THE_PLATEAU | wanted
    if curves.peak is not None:
        wanted = OF_THE_PEAK | wanted
    return {name: f(curves, plateau) for name, (_, f) in wanted.items()}


def mean_ratio(force: np.ndarray, opposite: np.ndarray, curves: BiaxialCurves) -> float:
    """Return the ratio of two opposite walls' forces, each meaned over strain: 1 in equilibrium.

    Away from 1 something between the walls takes up force: a background drag, or acceleration.
    """
    return float(np.trapezoid(force, curves.path) / np.trapezoid(opposite, curves.path))
