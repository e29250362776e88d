"""What every averaging cell is: weights of the particles, a volume, and three ways to average.

The averaging formalism of the talk (Luding; Laetzel, Luding, Herrmann, Granular Matter 2, 123 (2000))::

    Q = <Q^p> = (1/V) sum_{p in V} w_V^p V^p Q^p

A set of K cells is one object. A new kind of cell (rings, strips, exact area fractions) is a module
with a subclass of `Weighted` that gives labels, weights and volumes, and a line in
`postproc.averaging.registry`; no formula knows which cells it averages over.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass

import numpy as np

from postproc.snapshot import Snapshot


def per_cell(values: np.ndarray, like: np.ndarray) -> np.ndarray:
    """Give `values` (K,) trailing axes so that it multiplies or divides `like` (K, ...) row by row."""
    return values.reshape(values.shape + (1,) * (like.ndim - values.ndim))


def divide(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """Return a / b row by row, NaN where b is 0: an empty cell has no mean."""
    a = np.asarray(a, dtype=np.float64)
    b = np.broadcast_to(per_cell(np.asarray(b, dtype=np.float64), a), a.shape)
    return np.divide(a, b, out=np.full(a.shape, np.nan), where=b != 0)


@dataclass(frozen=True, kw_only=True)
class Cells(ABC):
    """K cells of a snapshot with N particles; Q below has shape (N, ...), a result (K, ...)."""

    snapshot: Snapshot

    @property
    @abstractmethod
    def labels(self) -> tuple[str, ...]:
        """One name a cell."""

    @property
    @abstractmethod
    def volumes(self) -> np.ndarray:
        """V of each cell, (K,), m^3 (2D: area times thickness). MissingColumn if there is none."""

    @abstractmethod
    def total(self, q: np.ndarray) -> np.ndarray:
        """Sum over particles: sum_p w_V^p Q^p."""

    @abstractmethod
    def largest(self, q: np.ndarray) -> np.ndarray:
        """Largest Q^p, shape (N,), among the particles with w_V^p > 0; NaN in an empty cell."""

    def density(self, q: np.ndarray) -> np.ndarray:
        """Per volume: (1/V) sum_p w_V^p Q^p."""
        total = self.total(q)
        return total / per_cell(self.volumes, total)

    def mean(self, q: np.ndarray) -> np.ndarray:
        """Per particle: sum_p w_V^p Q^p / sum_p w_V^p."""
        return divide(self.total(q), self.total(np.ones(len(q))))


class Weighted(Cells):
    """Cells whose weights are a matrix."""

    @property
    @abstractmethod
    def weights(self) -> np.ndarray:
        """w_V^p, shape (K, N), the fraction of particle p that cell V counts."""

    def total(self, q: np.ndarray) -> np.ndarray:
        """Sum over particles: sum_p w_V^p Q^p."""
        return np.tensordot(self.weights, q, axes=1)

    def largest(self, q: np.ndarray) -> np.ndarray:
        """Largest Q^p among the particles with w_V^p > 0; NaN in an empty cell."""
        inside = self.weights > 0
        top = np.where(inside, q, -np.inf).max(axis=1, initial=-np.inf)
        return np.where(inside.any(axis=1), top, np.nan)
