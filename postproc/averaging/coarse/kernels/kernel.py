"""What every kernel is: a normalised, round function that spreads a particle over space."""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True, kw_only=True)
class Kernel(ABC):
    """phi(r), r = |x - x^p|, in a space of `dimension` 2 or 3: its integral over all space is 1.

    width: w, m; each kernel says what it is of it. phi has the unit 1/m^dimension, in 2D per unit area.
    """

    width: float
    dimension: int

    @property
    @abstractmethod
    def reach(self) -> float:
        """Distance beyond which phi is 0, or counted as 0, m."""

    @abstractmethod
    def value(self, r: np.ndarray) -> np.ndarray:
        """phi at distances r (n,), 1/m^dimension."""

    @abstractmethod
    def slope(self, r: np.ndarray) -> np.ndarray:
        """(d phi/dr)/r at distances r (n,), 1/m^(dimension + 2): grad phi = slope (x - x^p)."""

    @abstractmethod
    def line(self, start: np.ndarray, end: np.ndarray, across: np.ndarray) -> np.ndarray:
        """Integral of phi along a straight line, exact, 1/m^(dimension - 1), (n,).

        The line passes at the distance `across` >= 0 from the kernel's centre; `start` < `end`: places on it, m,
        counted from the foot of the perpendicular. All (n,).
        """


def clipped(start: np.ndarray, end: np.ndarray, across: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return the places between which a line runs inside the unit sphere, both equal where it misses it."""
    half = np.sqrt(np.maximum(1.0 - across * across, 0.0))
    return np.clip(start, -half, half), np.clip(end, -half, half)
