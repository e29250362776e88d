"""The numbers of a whole biaxial test: shown for every run, judged only with replicates."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from harness.scene.model import Biaxial
from harness.studies.compare.curves import BiaxialCurves

Plateau = tuple[float, float]

ROUNDING = 1e-12
"""Relative: a sample right at the end of a plateau belongs to it."""

MACRO: dict[str, tuple[str, Callable[[BiaxialCurves, Plateau], float]]] = {
    "peak stress ratio": ("1", lambda c, _: float(c.smoothed(c.ratio)[c.peak])),
    "peak friction angle": ("deg", lambda c, _: float(c.smoothed(c.friction_angle)[c.peak])),
    "strain at the peak": ("1", lambda c, _: float(c.strain[c.peak])),
    "plateau sigma_zz": ("N/m", lambda c, p: plateau_mean(c.stress_zz, c, p)),
    "plateau stress ratio": ("1", lambda c, p: plateau_mean(c.ratio, c, p)),
    "plateau friction angle": ("deg", lambda c, p: plateau_mean(c.friction_angle, c, p)),
    "left over right wall force": ("1", lambda c, _: mean_ratio(c.force_left, c.force_right, c)),
    "top over bottom wall force": ("1", lambda c, _: mean_ratio(c.force_top, c.force_bottom, c)),
    "volume strain at the end": ("1", lambda c, _: float(c.volume_strain[-1])),
}
"""Quantity: unit and how it is formed from curves and the plateau's strain range."""


def plateau_mean(values: np.ndarray, curves: BiaxialCurves, plateau: Plateau) -> float:
    """Return the mean over strain, not over time: the drive is slow at its ends.

    NaN (not computed) when fewer than two samples lie in the plateau.
    """
    low, high = np.array(plateau) * (1.0 - ROUNDING, 1.0 + ROUNDING)
    inside = (curves.strain >= low) & (curves.strain <= high)
    strain = curves.strain[inside]
    if len(strain) < 2:
        return float("nan")
    return float(np.trapezoid(values[inside], strain) / (strain[-1] - strain[0]))


def macro_values(curves: BiaxialCurves, scene: Biaxial) -> dict[str, float]:
    """Return the numbers of one test by name; plateau values only if the scene declares a plateau."""
    plateau = scene.compare.plateau
    wanted = {k: f for k, (_, f) in MACRO.items() if plateau is not None or not k.startswith("plateau")}
    return {name: f(curves, plateau) for name, f in wanted.items()}


def mean_ratio(force: np.ndarray, opposite: np.ndarray, curves: BiaxialCurves) -> float:
    """Return the ratio of two opposite walls' forces, each meaned over strain: 1 in equilibrium.

    Away from 1 something between the walls takes up force: a background drag, or acceleration.
    """
    return float(np.trapezoid(force, curves.strain) / np.trapezoid(opposite, curves.strain))
