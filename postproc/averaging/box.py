"""The whole box as one cell."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from postproc.averaging.cells import Weighted
from postproc.geometry import box_bounds, volume_between


@dataclass(frozen=True, kw_only=True)
class Box(Weighted):
    """Every particle with weight 1, V the volume between the walls (or of the periodic box)."""

    labels = ("box",)

    @cached_property
    def weights(self) -> np.ndarray:
        """Ones, (1, N)."""
        return np.ones((1, self.snapshot.particles.rows))

    @cached_property
    def volumes(self) -> np.ndarray:
        """Product of the box lengths, in 2D times the thickness, (1,)."""
        return np.array([volume_between(box_bounds(self.snapshot), self.snapshot)])
