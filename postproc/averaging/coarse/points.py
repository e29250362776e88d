"""Points with a kernel around each as cells: coarse graining."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import product
from typing import TYPE_CHECKING

import numpy as np

from postproc.averaging.cells import Cells, divide
from postproc.averaging.coarse.images import check_reach
from postproc.averaging.coarse.kernels.kernel import Kernel
from postproc.averaging.coarse.kernels.registry import KERNELS
from postproc.averaging.coarse.settings import points_of
from postproc.averaging.coarse.spread import Spread
from postproc.averaging.frame import POLAR, polar_turn, turn_tensors
from postproc.averaging.words import WrongSetting
from postproc.geometry import centre, positions
from postproc.macro.contact_ends import WALL
from postproc.snapshot import Snapshot

if TYPE_CHECKING:
    from postproc.macro.contact_ends import ContactEnds

DEFAULT_WIDTH = 1.0
"""Width in mean diameters when none is given: about where densities of a packing stop to show single grains."""


@dataclass(frozen=True, kw_only=True)
class Points(Cells):
    """K points r, at which averages are coarse-grained fields: Q(r) = sum_p phi(r - r^p) Q^p.

    points: (K, dim), m. shape: points an axis of a grid, () if they are not one. kernel: name in `KERNELS`.
    width: w of the kernel, m, which says what it is of it; default one mean diameter.

    A quantity of contacts is spread along the segment from the particle's centre to the contact point, exactly
    (`contact_density`): the two ends of a contact between particles together cover the branch from centre to centre,
    also by way of a contact point beside the line of centres; an end at a wall stops at the wall.

    Velocities fluctuate about the mean at the point, v' = v^p - V(r) (Goldhirsch's v'(r, t)), so that balances are
    exact: d rho/dt + div j = 0, dj/dt + div(rho V V + sigma^k) = -div sigma + t + rho g, with stresses positive in
    compression, first index the normal's, and t of `interaction_force_density`.

    Where no particle is in reach, densities and sums are 0 (there is nothing) and means are NaN. Points near a wall
    have part of their kernel beyond it; nothing is renormalised. In the polar frame averages are turned by the
    angle of the point. Source: Goldhirsch, Granular Matter 12, 239 (2010).
    """

    points: np.ndarray
    shape: tuple[int, ...] = ()
    kernel: str = next(iter(KERNELS))
    width: float | None = None

    turn = None

    def __post_init__(self) -> None:
        """Raise WrongSetting for a kernel that reaches over many periods of the box, and without any width."""
        check_reach(self.phi.reach, self.snapshot)

    @classmethod
    def settings(cls, words: Sequence[str], snapshot: Snapshot) -> dict[str, object]:
        """points:FILE.csv (columns x, y[, z]) or points:NXxNY[xNZ], the middles of rectangles over the box.

        Without a box: over the square around the ring walls, or else over the particles with their radii.
        """
        return points_of(words, snapshot)

    @cached_property
    def phi(self) -> Kernel:
        """The kernel, of this width and in this dimension."""
        width = _default_width(self.snapshot) if self.width is None else self.width
        return KERNELS[self.kernel](width=width, dimension=self.snapshot.dimension)

    @property
    def how(self) -> Mapping[str, str | float]:
        """Kernel and width, m."""
        return {"kernel": self.kernel, "width (m)": float(self.phi.width)} | self._about

    @cached_property
    def labels(self) -> tuple[str, ...]:
        """Numbers from 1 along each axis of a grid, "3 5", else in the order of the file."""
        ways = self.shape or (len(self.points),)
        return tuple(" ".join(str(k + 1) for k in place) for place in product(*(range(n) for n in ways)))

    @cached_property
    def volumes(self) -> np.ndarray:
        """V = 1/phi(0) (2D: times thickness), (K,): the space that a kernel's height spreads a particle over.

        A particle has the weight phi(r - r^p)/phi(0), 1 at the point itself, so that sums over a "cell" are
        densities times V.
        """
        return np.full(len(self.points), self._depth / self._top)

    @property
    def coordinates(self) -> Mapping[str, np.ndarray]:
        """x, y[, z] of the points; in the polar frame also r."""
        columns = {axis: self.points[:, k] for k, axis in enumerate(self.snapshot.axes)}
        if self.frame == POLAR:
            columns["r"] = np.hypot(*(self.points - centre(self.snapshot))[:, :2].T)
        return columns

    @cached_property
    def _top(self) -> float:
        return float(self.phi.value(np.zeros(1))[0])

    @cached_property
    def _depth(self) -> float:
        return self.snapshot.thickness if self.snapshot.dimension == 2 else 1.0

    @cached_property
    def _spread(self) -> Spread:
        return Spread(kernel=self.phi, at=self.points, snapshot=self.snapshot)

    @cached_property
    def matrix(self):
        """Weights phi(r - r^p)/phi(0), sparse, (K, N)."""
        return self._spread.places(positions(self.snapshot)) / self._top

    def total(self, q: np.ndarray) -> np.ndarray:
        """V times the density: sum_p Q^p phi(r - r^p)/phi(0)."""
        return _apply(self.matrix, q)

    def largest(self, q: np.ndarray) -> np.ndarray:
        """Largest Q^p among the particles in reach; NaN where there is none."""
        weights = self.matrix.tocoo()
        top = np.full(len(self.points), -np.inf)
        np.maximum.at(top, weights.coords[0], np.asarray(q, dtype=np.float64)[weights.coords[1]])
        return np.where(np.isneginf(top), np.nan, top)

    def density_at(self, x: np.ndarray, q: np.ndarray) -> np.ndarray:
        """Sum of phi(r - x) Q over places x (n, dim), Q (n, ...), per volume: (K, ...)."""
        return _apply(self._spread.places(x), q) / self._depth

    @cached_property
    def _slopes(self) -> list:
        return self._spread.slopes(positions(self.snapshot))

    def interaction_force_density(self, ends: ContactEnds) -> np.ndarray:
        """t = sum_c f^c phi(r - c) over contacts with walls, (K, dim), N/m^3 (2D per unit thickness: N/m^2), Cartesian.

        f: force of the wall on the particle, c: contact point, where the particle's segment of the stress ends. It
        carries the sign with which dj/dt + div(rho V V + sigma^k) = -div sigma + t + rho g holds at every point
        (compression positive); what grains do to the wall is -t. It vanishes farther from walls than the kernel
        reaches. Source: Weinhart, Thornton, Luding, Bokhove, Granular Matter 14, 289 (2012).
        """
        at_wall = np.flatnonzero(ends.partner == WALL)
        x = positions(self.snapshot)[ends.particle[at_wall]] + ends.l[at_wall]
        return self.density_at(x, ends.f[at_wall])

    def density_gradient(self, q: np.ndarray) -> np.ndarray:
        """Gradient of the density, sum_p grad phi(r - r^p) Q^p, analytic: (K, ..., dim), Cartesian, last index its.

        MissingColumn with a kernel that has no gradient.
        """
        return np.stack([_apply(slope, q) for slope in self._slopes], axis=-1) / self._depth

    def gradient(self, q: np.ndarray, mass: np.ndarray | None = None) -> np.ndarray:
        """Gradient of the mean sum phi m Q/sum phi m by the quotient rule, analytic: (K, ..., dim).

        Cartesian, to be turned by `into_frame`. NaN where no particle is in reach. MissingColumn with a kernel
        that has no gradient.
        """
        q = np.asarray(q, dtype=np.float64)
        mass = np.ones(len(q)) if mass is None else mass
        # a constant changes no gradient, and without it less cancels
        rest = (q - q.mean(axis=0)) if len(q) else q
        weighted = mass.reshape(-1, *(1,) * (q.ndim - 1)) * rest
        rho = self.density(mass)
        mean = divide(self.density(weighted), rho)
        slope = self.density_gradient(weighted) - np.einsum("k...,kb->k...b", mean, self.density_gradient(mass))
        return divide(slope, rho)

    @cached_property
    def _kept(self) -> dict[str, object]:
        return {}

    def _lines(self, ends: ContactEnds):
        """Line integrals along the ends, (K, E); kept for the ends that were asked for last."""
        if self._kept.get("ends") is not ends:
            x = positions(self.snapshot)[ends.particle]
            self._kept.update(ends=ends, lines=self._spread.segments(x, ends.l))
        return self._kept["lines"]

    def contact_density(self, ends: ContactEnds, q: np.ndarray) -> np.ndarray:
        """sum_pc Q^pc int_0^1 phi(r - r^p - s l^pc) ds per volume, Q (E, ...): spread along the contacts' segments."""
        return _apply(self._lines(ends), q) / self._depth

    def contact_mean(self, ends: ContactEnds, q: np.ndarray) -> np.ndarray:
        """Mean over contact ends weighted by their line integrals, Q (E, ...); NaN where none is in reach."""
        return divide(self.contact_density(ends, q), self.contact_density(ends, np.ones(len(q))))

    def into_frame(self, values: np.ndarray, order: int) -> np.ndarray:
        """Turn averages (K, ...) of tensors of this order by the angle of the point, in the polar frame."""
        if self.frame != POLAR or order == 0:
            return values
        return turn_tensors(polar_turn(self.points - centre(self.snapshot)), values)


def _default_width(snapshot: Snapshot) -> float:
    if not snapshot.particles.rows:
        raise WrongSetting("width: expected a width in m, as there are no particles to take it from, got none")
    return DEFAULT_WIDTH * 2.0 * float(snapshot.particles["radius"].mean())


def _apply(matrix, q: np.ndarray) -> np.ndarray:
    """Sum of weights times Q (n, ...): (K, ...)."""
    q = np.asarray(q, dtype=np.float64)
    found = matrix @ q.reshape(len(q), int(np.prod(q.shape[1:])))
    return found.reshape(len(found), *q.shape[1:])
