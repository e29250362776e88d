"""A grid of rectangles over the whole box as cells."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import product

import numpy as np

from postproc.averaging.cells import Entries, Weighted
from postproc.averaging.partition import AREA, entries_of, open_edges, placed, shares_in_rectangles
from postproc.averaging.words import counts, refuse
from postproc.geometry import region, volume_between
from postproc.snapshot import MissingColumn, Snapshot


@dataclass(frozen=True, kw_only=True)
class Grid(Weighted):
    """`shape` cells an axis, equal, over the box (without one over the square around the ring walls).

    Ordered with the last axis running fastest. weights: "area", the exact fraction of each disc in the rectangle
    (3D: of the sphere in the box), or "centre". What overlaps a wall stays in the cell at it; on periodic axes it
    counts on the other side. Cells that lie across a ring wall have the volume of their whole rectangle.
    """

    shape: tuple[int, ...]
    weights: str = AREA

    @classmethod
    def settings(cls, words: Sequence[str], snapshot: Snapshot) -> dict[str, object]:
        """grid:NXxNY, in 3D grid:NXxNYxNZ."""
        if len(words) != 1:
            raise refuse("grid", "cells an axis, as in grid:32x32", repr(":".join(words)))
        try:
            region(snapshot)
        except MissingColumn as missing:
            raise refuse("grid", "a box", str(missing)) from None
        return {"shape": counts("grid", words[0], snapshot.dimension)}

    @cached_property
    def edges(self) -> list[np.ndarray]:
        """Borders along each axis, m."""
        bounds = region(self.snapshot)
        return [np.linspace(*limits, n + 1) for limits, n in zip(bounds, self.shape, strict=True)]

    @cached_property
    def labels(self) -> tuple[str, ...]:
        """Numbers from 1 along each axis, "3 5"."""
        return tuple(" ".join(str(k + 1) for k in place) for place in product(*(range(n) for n in self.shape)))

    @property
    def volumes(self) -> np.ndarray:
        """The box' volume over the number of cells, (K,)."""
        count = int(np.prod(self.shape))
        return np.full(count, volume_between(region(self.snapshot), self.snapshot) / count)

    @property
    def coordinates(self) -> Mapping[str, np.ndarray]:
        """x, y[, z] in the middle."""
        middles = np.meshgrid(*((e[1:] + e[:-1]) / 2.0 for e in self.edges), indexing="ij")
        return {axis: middle.ravel() for axis, middle in zip(self.snapshot.axes, middles, strict=True)}

    @cached_property
    def entries(self) -> Entries:
        """Fractions of particles by the corners of the rectangles."""
        walls = (True, True)
        borders = [open_edges(e, axis, walls, self.snapshot) for axis, e in enumerate(self.edges)]
        where = placed(self.snapshot, self.weights, range(self.snapshot.dimension))
        return entries_of(shares_in_rectangles(borders, where, self.weights), where)
