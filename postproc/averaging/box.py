"""The whole box as one cell."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from postproc.averaging.cells import Entries, Weighted
from postproc.geometry import positions, sample_volume


@dataclass(frozen=True, kw_only=True)
class Box(Weighted):
    """Every particle with weight 1, V the volume between the walls (or of the periodic box)."""

    labels = ("box",)

    @cached_property
    def entries(self) -> Entries:
        """Every particle, with weight 1."""
        rows = np.arange(self.snapshot.particles.rows)
        return Entries(
            cell=np.zeros_like(rows), particle=rows, weight=np.ones(len(rows)), x=positions(self.snapshot)
        )

    @cached_property
    def volumes(self) -> np.ndarray:
        """Product of the box lengths, or the annulus between ring walls; in 2D times the thickness, (1,)."""
        return np.array([sample_volume(self.snapshot)])
