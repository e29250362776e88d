"""How calm a biaxial test was, before its peak and after it: numbers to be shown, without a verdict.

The drive may be slow and the side wall obey while the sample moves in bursts between. What tells is the
kinetic over the elastic energy of the frames, and how far sigma_zz swings about its mean.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from harness.studies.compare.curves import BiaxialCurves
from harness.studies.compare.states import ENERGY, StateCurves


@dataclass(frozen=True, kw_only=True)
class Swing:
    """sigma_zz over a range of strain: mean in N/m; standard deviation, lowest and highest relative to the mean.

    Mean and standard deviation are over strain: the drive is slow at its ends.
    """

    mean: float
    deviation: float
    lowest: float
    highest: float


@dataclass(frozen=True, kw_only=True)
class Phase:
    """A part of a test, from `low` to `high` strain.

    control: largest |F_x - p_x z|/(p_x z). energy: median and largest E_kin/E_el of the frames inside,
    None if the frames do not tell. swing: None while the stress is meant to rise.
    """

    name: str
    low: float
    high: float
    control: float
    energy: tuple[float, float] | None
    swing: Swing | None


def phases_of(
    curves: BiaxialCurves, states: StateCurves, plateau: tuple[float, float] | None
) -> tuple[Phase, ...]:
    """Return the parts up to the peak and after it, or the whole test if it has no peak, and the plateau."""
    strain, peak = curves.strain, curves.peak
    start, end = float(strain[0]), float(strain[-1])
    ranges = [("whole test", start, end, False)]
    if peak is not None:
        ranges = [("up to the peak", start, peak.strain, False), ("after the peak", peak.strain, end, True)]
    if plateau is not None:
        ranges.append(("plateau", *plateau, True))
    found = (_phase(curves, states, *r) for r in ranges)
    return tuple(p for p in found if p is not None)


def _phase(
    curves: BiaxialCurves, states: StateCurves, name: str, low: float, high: float, level: bool
) -> Phase | None:
    """Return the part, None if fewer than two samples lie in it."""
    inside = _between(curves.strain, low, high)
    if inside.sum() < 2:
        return None
    return Phase(
        name=name, low=low, high=high, control=float(np.abs(curves.control_error[inside]).max()),
        energy=_energy(states, low, high),
        swing=swing(curves.strain[inside], curves.stress_zz[inside]) if level else None,
    )


def swing(strain: np.ndarray, stress: np.ndarray) -> Swing:
    """Return how `stress` swings about its mean over `strain`, both (S,), S >= 2; NaN about a mean of 0."""
    length = strain[-1] - strain[0]
    mean = float(np.trapezoid(stress, strain) / length)
    variance = float(np.trapezoid((stress - mean) ** 2, strain) / length)
    scale = mean or float("nan")
    return Swing(
        mean=mean, deviation=variance**0.5 / scale,
        lowest=float(stress.min()) / scale - 1.0, highest=float(stress.max()) / scale - 1.0,
    )


def _energy(states: StateCurves, low: float, high: float) -> tuple[float, float] | None:
    values = states.values.get(ENERGY)
    inside = _between(states.strain, low, high)
    if values is None or not inside.any():
        return None
    return float(np.median(values[inside])), float(values[inside].max())


def _between(strain: np.ndarray, low: float, high: float) -> np.ndarray:
    return (strain >= low * (1.0 - 1e-12)) & (strain <= high * (1.0 + 1e-12))
