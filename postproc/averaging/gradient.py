"""Gradients of particle properties inside a cell, by weighted least squares."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from postproc.sums import grouped_sum

SPANS = 1e-12
"""Least over largest moment of the positions in a cell below which they do not span the space: three orders
above what rounding makes of points on a line, far below what a packing has (1e-2 and more)."""

APART = 1e-12
"""The same for their distance from the mean, over the largest coordinate: a single layer of discs has no slope in r."""


@dataclass(frozen=True, kw_only=True)
class Fit:
    """Affine fits q = mean + slope . (x - place) in K cells, ready for any q: n weighted rows of the data.

    cell, row: (n,) which row of q counts in which cell. share: (n,) its part of the mean. slant: (n, dims) its
    part of the slope. place: (K, dims) weighted mean position, m.
    """

    cell: np.ndarray
    row: np.ndarray
    share: np.ndarray
    slant: np.ndarray
    place: np.ndarray

    def mean(self, q: np.ndarray) -> np.ndarray:
        """Weighted mean of q (rows, ...): (K, ...)."""
        return self._sum(self.share, q)

    def slope(self, q: np.ndarray) -> np.ndarray:
        """Slope of q (rows, ...): (K, ..., dims). A constant part is taken off first, it would only cost digits."""
        q = q - q.mean(axis=0) if len(q) else q
        return np.stack([self._sum(part, q) for part in self.slant.T], axis=-1)

    def _sum(self, part: np.ndarray, q: np.ndarray) -> np.ndarray:
        rows = q[self.row]
        return grouped_sum(part.reshape(part.shape + (1,) * (rows.ndim - 1)) * rows, self.cell, len(self.place))


def affine_fit(*, cell: np.ndarray, row: np.ndarray, weight: np.ndarray, x: np.ndarray, count: int) -> Fit:
    """Prepare to minimise sum weight |q - mean - slope . (x - place)|^2 in each cell.

    cell, row, weight: (n,); x: (n, dims); count: K. The normal equations of moments about the means:
    slope = (sum w q (x - place)) . (sum w (x - place) (x - place))^-1. Exact for affine q. NaN where the positions
    of a cell do not span the space (fewer than dims + 1 particles, or all in one line or one layer), and everything
    NaN in an empty cell.
    """
    total = grouped_sum(weight, cell, count)
    total[total == 0.0] = np.nan
    share = weight / total[cell]
    place = grouped_sum(share[:, None] * x, cell, count)
    place[np.isnan(total)] = np.nan
    dx = x - place[cell]
    weighted = share[:, None] * dx
    moments = grouped_sum(weighted[:, :, None] * dx[:, None, :], cell, count)
    inverse = _inverse(moments, least=(APART * np.abs(x).max(initial=0.0)) ** 2)
    slant = np.einsum("nab,nb->na", inverse[cell], weighted)
    return _known(Fit(cell=cell, row=row, share=share, slant=slant, place=place), total)


def _inverse(moments: np.ndarray, *, least: float) -> np.ndarray:
    """Inverse moments, NaN where the positions do not span the space. least: moment that rounding may make."""
    sizes = np.linalg.eigvalsh(moments)
    good = (sizes[:, 0] > SPANS * sizes[:, -1]) & (sizes[:, 0] > least)
    inverse = np.full(moments.shape, np.nan)
    inverse[good] = np.linalg.inv(moments[good])
    return inverse


def _known(fit: Fit, total: np.ndarray) -> Fit:
    """Add one row of NaN to every empty cell, so that its sums are NaN and not 0."""
    empty = np.flatnonzero(np.isnan(total))
    if not empty.size:
        return fit
    unknown = np.full(len(empty), np.nan)
    return Fit(
        cell=np.concatenate([fit.cell, empty]),
        row=np.concatenate([fit.row, np.zeros(len(empty), dtype=fit.row.dtype)]),
        share=np.concatenate([fit.share, unknown]),
        slant=np.concatenate([fit.slant, np.full((len(empty), fit.slant.shape[1]), np.nan)]),
        place=fit.place,
    )
