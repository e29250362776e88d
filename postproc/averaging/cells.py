"""What every averaging cell is: weights of the particles, a volume, and ways to average over them.

The averaging formalism of the talk (Luding; Laetzel, Luding, Herrmann, Granular Matter 2, 123 (2000))::

    Q = <Q^p> = (1/V) sum_{p in V} w_V^p V^p Q^p

A set of K cells is one object. A new kind of cell is a module with a subclass of `Weighted` that says
which particles count in which cell with which weight (`entries`), labels and volumes, and a line in
`postproc.averaging.registry`; no formula knows which cells it averages over, nor in which frame.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from postproc.averaging.frame import CARTESIAN, axes_of, polar_turn, turn_tensors, turn_vectors
from postproc.averaging.gradient import Fit, affine_fit
from postproc.averaging.words import WrongSetting
from postproc.geometry import centre, positions
from postproc.snapshot import MissingColumn, Snapshot

if TYPE_CHECKING:
    from postproc.macro.contact_ends import ContactEnds

FEW = 4
"""Up to this many cells weights are a full matrix; beyond, a sparse one (each particle lies in a few cells only)."""


def per_cell(values: np.ndarray, like: np.ndarray) -> np.ndarray:
    """Give `values` (K,) trailing axes so that it multiplies or divides `like` (K, ...) row by row."""
    return values.reshape(values.shape + (1,) * (like.ndim - values.ndim))


def divide(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """Return a / b row by row, NaN where b is 0: an empty cell has no mean."""
    a = np.asarray(a, dtype=np.float64)
    b = per_cell(np.asarray(b, dtype=np.float64), a)
    return np.divide(a, b, out=np.full(a.shape, np.nan), where=b != 0)


@dataclass(frozen=True, kw_only=True)
class Cells(ABC):
    """K cells of a snapshot with N particles; Q below has shape (N, ...), a result (K, ...).

    frame: "cartesian", or "polar" about the centre of the state's ring walls (without them the origin):
    components of vectors and tensors are radial and tangential, see `postproc.averaging.frame`.
    """

    snapshot: Snapshot
    frame: str = CARTESIAN

    @classmethod
    def settings(cls, words: Sequence[str], snapshot: Snapshot) -> dict[str, object]:
        """Return the fields that the words after the kind's name mean for this state. Raises WrongSetting."""
        del snapshot
        if words:
            raise WrongSetting(f"cells: expected {cls.__name__.lower()} alone, got :{':'.join(words)} after it")
        return {}

    @property
    def how(self) -> Mapping[str, str | float]:
        """How particles count, in words and in m: the weights, or kernel and width; in the polar frame its centre."""
        weights = getattr(self, "weights", None)
        return ({} if weights is None else {"weights": weights}) | self._about

    @property
    def _about(self) -> Mapping[str, str]:
        """The centre that components are about, in the polar frame."""
        if self.frame == CARTESIAN:
            return {}
        return {"centre (m)": " ".join(f"{c:g}" for c in centre(self.snapshot))}

    @property
    @abstractmethod
    def labels(self) -> tuple[str, ...]:
        """One name a cell."""

    @property
    @abstractmethod
    def volumes(self) -> np.ndarray:
        """V of each cell, (K,), m^3 (2D: area times thickness). MissingColumn if there is none."""

    @property
    def coordinates(self) -> Mapping[str, np.ndarray]:
        """Where the cells are, m: columns (K,) by name, such as r, r_inner, r_outer; empty for one big cell."""
        return {}

    @abstractmethod
    def total(self, q: np.ndarray) -> np.ndarray:
        """Sum over particles: sum_p w_V^p Q^p."""

    @abstractmethod
    def largest(self, q: np.ndarray) -> np.ndarray:
        """Largest Q^p, shape (N,), among the particles with w_V^p > 0; NaN in an empty cell."""

    @abstractmethod
    def gradient(self, q: np.ndarray, mass: np.ndarray | None = None) -> np.ndarray:
        """Gradient of the mean of a particle property Q^p, in this frame: (K, ..., dim), last index the derivative's.

        q: scalars (N,) or vectors (N, dim) in the components of this frame, so that component (a, b) of a
        velocity's is d v_a / d x_b. mass: (N,), weighs the mean; without it all particles are alike.
        NaN where the cell cannot give one (too few particles).
        """

    def interaction_force_density(self, ends: ContactEnds) -> np.ndarray:
        """What walls do to grains as a field, (K, dim), N/m^3. MissingColumn where cells cannot spread it."""
        del ends
        raise MissingColumn("walls act along lines, which only a kernel spreads in space: --cells points:...")

    def density(self, q: np.ndarray) -> np.ndarray:
        """Per volume: (1/V) sum_p w_V^p Q^p."""
        total = self.total(q)
        return total / per_cell(self.volumes, total)

    def mean(self, q: np.ndarray) -> np.ndarray:
        """Per particle: sum_p w_V^p Q^p / sum_p w_V^p."""
        return divide(self.total(q), self.numbers)

    @cached_property
    def numbers(self) -> np.ndarray:
        """Number of particles in each cell, sum_p w_V^p, (K,)."""
        return self.total(np.ones(self.snapshot.particles.rows))

    def contact_density(self, ends: ContactEnds, q: np.ndarray) -> np.ndarray:
        """Per volume: (1/V) sum_p w_V^p sum_c Q^pc, Q per contact end (E, ...): a particle carries its contacts."""
        return self.density(ends.sum_c(q))

    def contact_mean(self, ends: ContactEnds, q: np.ndarray) -> np.ndarray:
        """Per contact end: sum_p w_V^p sum_c Q^pc / sum_p w_V^p C^p, Q (E, ...); NaN without contacts."""
        return divide(self.total(ends.sum_c(q)), self.total(ends.sum_c(np.ones(len(q)))))

    @property
    def axes(self) -> tuple[str, ...]:
        """Names of the components of a vector: x, y[, z] or r, phi[, z]."""
        return axes_of(self.frame, self.snapshot.dimension)

    @cached_property
    def turn(self) -> np.ndarray | None:
        """Matrices (N, dim, dim) from Cartesian components to each particle's own; None when these are Cartesian."""
        if self.frame == CARTESIAN:
            return None
        return polar_turn(positions(self.snapshot) - centre(self.snapshot))

    def turned(self, vectors: np.ndarray, particle: np.ndarray | slice = slice(None)) -> np.ndarray:
        """Return vectors of particles (rows, dim) in this frame; particle: row of the particle of each, default all."""
        return vectors if self.turn is None else turn_vectors(self.turn[particle], vectors)

    def into_frame(self, values: np.ndarray, order: int) -> np.ndarray:
        """Turn finished averages (K, ...) of tensors of this order (vector 1) into the frame.

        Nothing to do when particles' vectors were turned before averaging; cells that average at points
        (coarse graining) have `turn` None and turn their averages here.
        """
        del order
        return values


@dataclass(frozen=True, kw_only=True)
class Entries:
    """Which particle counts in which cell: n rows, ordered by cell, weights > 0.

    cell, particle: (n,) rows; weight: (n,) w_V^p; x: (n, dim) centre of the particle, or of that periodic
    image of it that lies in the cell, m. A particle may stand twice in a cell, with two images.
    """

    cell: np.ndarray
    particle: np.ndarray
    weight: np.ndarray
    x: np.ndarray


class Weighted(Cells):
    """Cells given by weights of particles."""

    @property
    @abstractmethod
    def entries(self) -> Entries:
        """The weights that are not zero."""

    @cached_property
    def matrix(self):
        """w_V^p, (K, N): the fraction of particle p that cell V counts; sparse for more than FEW cells."""
        e, shape = self.entries, (len(self.labels), self.snapshot.particles.rows)
        if len(self.labels) <= FEW:
            matrix = np.zeros(shape)
            np.add.at(matrix, (e.cell, e.particle), e.weight)
            return matrix
        from scipy.sparse import csr_array

        return csr_array((e.weight, e.particle, np.searchsorted(e.cell, np.arange(shape[0] + 1))), shape=shape)

    def total(self, q: np.ndarray) -> np.ndarray:
        """Sum over particles: sum_p w_V^p Q^p."""
        q = np.asarray(q, dtype=np.float64)
        total = self.matrix @ (q if q.ndim <= 2 else q.reshape(len(q), -1))
        return total.reshape(len(total), *q.shape[1:])

    def largest(self, q: np.ndarray) -> np.ndarray:
        """Largest Q^p among the particles with w_V^p > 0; NaN in an empty cell."""
        top = np.full(len(self.labels), -np.inf)
        with np.errstate(invalid="ignore"):  # a particle without a value leaves its cells without one
            np.maximum.at(top, self.entries.cell, np.asarray(q, dtype=np.float64)[self.entries.particle])
        return np.where(np.isneginf(top), np.nan, top)

    def gradient(self, q: np.ndarray, mass: np.ndarray | None = None) -> np.ndarray:
        """Weighted least squares in the cell: exact for affine fields, NaN where positions do not span the space.

        In the polar frame vectors are fitted in Cartesian components, and the gradient is turned by the
        angle of the cell's mean position.
        """
        q, fit = np.asarray(q, dtype=np.float64), self.fit(mass)
        if self.turn is None:
            return fit.slope(q)
        slope = fit.slope(q if q.ndim == 1 else turn_vectors(self.turn.swapaxes(1, 2), q))
        return turn_tensors(polar_turn(fit.place - centre(self.snapshot)), slope)

    def fit(self, mass: np.ndarray | None = None) -> Fit:
        """Affine fits over the places of the particles, weighted by w_V^p and, if given, mass (N,)."""
        key = None if mass is None else np.asarray(mass).tobytes()
        if key not in self._fits:
            e = self.entries
            weight = e.weight if mass is None else e.weight * mass[e.particle]
            self._fits[key] = affine_fit(
                cell=e.cell, row=e.particle, weight=weight, x=self.places(e.x), count=len(self.labels)
            )
        return self._fits[key]

    def places(self, x: np.ndarray) -> np.ndarray:
        """Coordinates (n, dims) that properties are fitted over; here the centres (n, dim) themselves."""
        return x

    @cached_property
    def _fits(self) -> dict[bytes | None, Fit]:
        return {}
