"""The Heaviside kernel: a ball of constant density."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from postproc.averaging.coarse.kernels.kernel import Kernel, clipped
from postproc.snapshot import MissingColumn


@dataclass(frozen=True, kw_only=True)
class Heaviside(Kernel):
    """phi = 1/V_w for r < w, 0 beyond; V_w = pi w^2 in 2D, 4/3 pi w^3 in 3D: w is the radius of the ball.

    Its standard deviation along an axis is w/2 in 2D, w/sqrt(5) in 3D. It has no gradient (on its surface it
    would be infinite). Source: Goldhirsch, Granular Matter 12, 239 (2010).
    """

    VOLUME: ClassVar[dict[int, float]] = {2: np.pi, 3: 4.0 / 3.0 * np.pi}

    @property
    def reach(self) -> float:
        """Return w."""
        return self.width

    @property
    def _inside(self) -> float:
        return 1.0 / (self.VOLUME[self.dimension] * self.width**self.dimension)

    def value(self, r: np.ndarray) -> np.ndarray:
        """Return phi."""
        return np.where(r < self.width, self._inside, 0.0)

    def slope(self, r: np.ndarray) -> np.ndarray:
        """Raise MissingColumn: there is none."""
        del r
        raise MissingColumn("the kernel heaviside has no gradient; take lucy or gaussian")

    def line(self, start: np.ndarray, end: np.ndarray, across: np.ndarray) -> np.ndarray:
        """Length of the chord inside, over V_w."""
        low, high = clipped(start / self.width, end / self.width, across / self.width)
        return self._inside * self.width * (high - low)
