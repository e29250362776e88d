"""Each particle as its own cell."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from postproc.averaging.cells import Cells
from postproc.geometry import particle_volumes


@dataclass(frozen=True, kw_only=True)
class Particles(Cells):
    """N cells, V = V^p and one particle in each, so that every average Q is the particle's own Q^p.

    The weights would be the identity matrix; it is not stored.
    """

    @cached_property
    def labels(self) -> tuple[str, ...]:
        """The particles' ids."""
        return tuple(str(int(i)) for i in self.snapshot.particles["id"])

    @cached_property
    def volumes(self) -> np.ndarray:
        """V^p, (N,)."""
        return particle_volumes(self.snapshot)

    def total(self, q: np.ndarray) -> np.ndarray:
        """Q^p itself."""
        return np.asarray(q, dtype=np.float64)

    def largest(self, q: np.ndarray) -> np.ndarray:
        """Q^p itself."""
        return np.asarray(q, dtype=np.float64)
