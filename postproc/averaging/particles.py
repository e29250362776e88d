"""Each particle as its own cell."""

from __future__ import annotations

from collections.abc import Mapping
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

    @property
    def coordinates(self) -> Mapping[str, np.ndarray]:
        """x, y[, z]: the centres."""
        return {axis: self.snapshot.particles[axis] for axis in self.snapshot.axes}

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

    def gradient(self, q: np.ndarray, mass: np.ndarray | None = None) -> np.ndarray:
        """NaN: one particle has no gradient."""
        del mass
        return np.full((*np.shape(q), self.snapshot.dimension), np.nan)

    def largest(self, q: np.ndarray) -> np.ndarray:
        """Q^p itself."""
        return np.asarray(q, dtype=np.float64)
