"""Particles shared out among neighbouring cells: from borders and cut fractions to entries.

Cells in a row have K+1 borders e_0 < ... < e_K. Cell k counts the fraction of a particle below e_{k+1} less that
below e_k, so that the weights of a particle telescope to 1 over cells that cover it.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import product

import numpy as np

from postproc.averaging.cells import Entries
from postproc.averaging.corners import sphere_below_corner
from postproc.averaging.fractions import disc_below_corner
from postproc.geometry import box_bounds, box_lengths, periodic_axes, positions
from postproc.snapshot import Snapshot

AREA, CENTRE = "area", "centre"
WEIGHTS = (AREA, CENTRE)

NOTHING = 1e-14
"""Fraction that differences of the closed forms may leave of nothing by round-off: a particle with less is not
there."""

SHORT = 2**15
"""Cell numbers below this are sorted as 16-bit integers, by radix: five times as fast."""

Below = Callable[[np.ndarray, np.ndarray], np.ndarray]
"""Fraction of rows of `Placed` below borders: (border (n,), row (n,)) -> (n,)."""


@dataclass(frozen=True, kw_only=True)
class Placed:
    """Particles where they lie in the cells: with their periodic images that reach into the box.

    particle: (P,) row of the particle; x: (P, dim), m; radius: (P,), m (the reach: 0 with centre weights).
    """

    particle: np.ndarray
    x: np.ndarray
    radius: np.ndarray


def placed(snapshot: Snapshot, weights: str, axes: Sequence[int]) -> Placed:
    """Return the particles, on periodic `axes` wrapped into the box, with images of those that cut its faces."""
    x = positions(snapshot).copy()
    radius = snapshot.particles["radius"] if weights == AREA else np.zeros(len(x))
    particle = np.arange(len(x))
    for axis in axes:
        if not periodic_axes(snapshot)[axis]:
            continue
        (low, _), length = box_bounds(snapshot)[axis], box_lengths(snapshot)[axis]
        x[:, axis] = low + np.mod(x[:, axis] - low, length)
        reach = radius[particle]
        over_low = np.flatnonzero(x[:, axis] - reach < low)
        over_high = np.flatnonzero(x[:, axis] + reach > low + length)
        particle = np.concatenate([particle, particle[over_low], particle[over_high]])
        step = np.eye(snapshot.dimension)[axis] * length
        x = np.concatenate([x, x[over_low] + step, x[over_high] - step])
    return Placed(particle=particle, x=x, radius=radius[particle])


@dataclass(frozen=True, kw_only=True)
class Shares:
    """Which row of `Placed` has which part in which of K cells in a row: row, cell, weight (n,)."""

    row: np.ndarray
    cell: np.ndarray
    weight: np.ndarray


def reached(edges: np.ndarray, place: np.ndarray, reach: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return all pairs (row, cell) of cells between `edges` that [place - reach, place + reach] overlaps.

    What lies outside all cells is paired with the outermost.
    """
    last_cell = len(edges) - 2
    first = np.clip(np.searchsorted(edges, place - reach, side="right") - 1, 0, last_cell)
    last = np.clip(np.searchsorted(edges, place + reach, side="left") - 1, first, last_cell)
    count = last - first + 1
    row = np.repeat(np.arange(len(place)), count)
    step = np.arange(len(row)) - np.repeat(np.cumsum(count) - count, count)
    return row, first[row] + step


def shares_along(edges: np.ndarray, place: np.ndarray, reach: np.ndarray, below: Below) -> Shares:
    """Share particles out among the cells between `edges` (K+1,) along one coordinate.

    place, reach: (P,) m. An edge may be -inf or inf: everything lies above or below it.
    """
    row, cell = reached(edges, place, reach)
    # every border once: the upper one of a cell is the lower one of the next, unless the particle ends there
    last = np.append(row[1:] != row[:-1], True)[: len(row)]
    upper = below(edges[cell + 1], row)
    first = np.roll(last, 1)
    lower = np.roll(upper, 1)
    lower[first] = below(edges[cell[first]], row[first])
    weight = upper - lower
    keep = weight > NOTHING
    return Shares(row=row[keep], cell=cell[keep], weight=weight[keep])


def shares_in_rectangles(borders: Sequence[np.ndarray], where: Placed, weights: str) -> Shares:
    """Share particles out among rectangles, K_x x K_y [x K_z] cells between `borders` along each axis.

    Cells are numbered with the last axis running fastest.
    """
    row, cells = _in_reach(borders, where)
    weight = (_corners if weights == AREA else _centres)(borders, cells, where, row)
    keep = weight > NOTHING
    shape = tuple(len(edges) - 1 for edges in borders)
    cell = np.ravel_multi_index([c[keep] for c in cells], shape)
    return Shares(row=row[keep], cell=cell, weight=weight[keep])


def _in_reach(borders: Sequence[np.ndarray], where: Placed) -> tuple[np.ndarray, list[np.ndarray]]:
    """Return pairs of a row and a cell that it may touch, given by the cell's index along each axis."""
    row, cells = np.arange(len(where.x)), []
    for axis, edges in enumerate(borders):
        pair, cell = reached(edges, where.x[row, axis], where.radius[row])
        row, cells = row[pair], [*(c[pair] for c in cells), cell]
    return row, cells


def _corners(
    borders: Sequence[np.ndarray], cells: Sequence[np.ndarray], where: Placed, row: np.ndarray
) -> np.ndarray:
    """Part in a rectangle or box: sum over its corners of the part below them, lower borders with a minus."""
    sides = [
        [(edges[cell + side] - where.x[row, axis]) / where.radius[row] for side in (0, 1)]
        for axis, (edges, cell) in enumerate(zip(borders, cells, strict=True))
    ]
    below = disc_below_corner if len(borders) == 2 else sphere_below_corner
    return sum(
        (-1) ** (len(borders) - sum(corner)) * below(*(side[k] for side, k in zip(sides, corner, strict=True)))
        for corner in product((0, 1), repeat=len(borders))
    )


def _centres(
    borders: Sequence[np.ndarray], cells: Sequence[np.ndarray], where: Placed, row: np.ndarray
) -> np.ndarray:
    weight = np.ones(len(row))
    for axis, (edges, cell) in enumerate(zip(borders, cells, strict=True)):
        below = below_centres(where.x[:, axis])
        weight *= below(edges[cell + 1], row) - below(edges[cell], row)
    return weight


def below_centres(place: np.ndarray) -> Below:
    """Centre weights: a particle is below a border, whole, when its centre is."""
    return lambda border, row: (place[row] < border).astype(np.float64)


def entries_of(shares: Shares, where: Placed) -> Entries:
    """Turn shares into entries, ordered by cell."""
    small = shares.cell.max(initial=0) < SHORT
    order = np.argsort(shares.cell.astype(np.int16) if small else shares.cell, kind="stable")
    row = shares.row[order]
    return Entries(
        cell=shares.cell[order], particle=where.particle[row], weight=shares.weight[order], x=where.x[row]
    )


def open_edges(edges: np.ndarray, axis: int, walls: tuple[bool, bool], snapshot: Snapshot) -> np.ndarray:
    """Move the outermost borders to infinity where they are walls: what overlaps a wall stays in the cell at it."""
    borders = edges.copy()
    if not periodic_axes(snapshot)[axis]:
        borders[0] = -np.inf if walls[0] else borders[0]
        borders[-1] = np.inf if walls[1] else borders[-1]
    return borders
