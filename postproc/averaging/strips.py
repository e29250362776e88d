"""Strips (in 3D slabs) across one axis of the box as cells."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from postproc.averaging.cells import Entries, Weighted
from postproc.averaging.fractions import disc_below_line, sphere_below_plane
from postproc.averaging.partition import AREA, below_centres, entries_of, open_edges, placed, shares_along
from postproc.averaging.words import at_walls, edges, refuse
from postproc.geometry import region, volume_between
from postproc.snapshot import MissingColumn, Snapshot


@dataclass(frozen=True, kw_only=True)
class Strips(Weighted):
    """K strips between the borders `edges` (K+1,), m, across `axis` (0: x, 1: y, 2: z), over the rest of the box.

    weights: "area", the exact fraction of each disc (3D: sphere) in the strip, or "centre". walls: whether the
    first and last border are the box's own; what sticks out there (overlaps with walls) stays in the outermost
    strip. On a periodic axis it counts on the other side.
    """

    axis: int
    edges: np.ndarray
    weights: str = AREA
    walls: tuple[bool, bool] = (False, False)

    @classmethod
    def settings(cls, words: Sequence[str], snapshot: Snapshot) -> dict[str, object]:
        """strips:x:NUMBER (over the whole box), strips:x:NUMBER:LOW:HIGH or strips:x:a,b,c,..."""
        if not words or words[0] not in snapshot.axes:
            expected = f"an axis ({', '.join(snapshot.axes)}), as in strips:x:20"
            raise refuse("strips", expected, repr(":".join(words)))
        axis = snapshot.axes.index(words[0])
        try:
            whole = region(snapshot)[axis]
        except MissingColumn as missing:
            raise refuse("strips", "a box", str(missing)) from None
        borders = edges("strips", words[1:], whole)
        return {"axis": axis, "edges": borders, "walls": at_walls("strips", borders, whole, words[0])}

    @cached_property
    def labels(self) -> tuple[str, ...]:
        """1 to K, from below."""
        return tuple(str(k) for k in range(1, len(self.edges)))

    @property
    def volumes(self) -> np.ndarray:
        """Width times the other lengths of the box, in 2D times the thickness, (K,)."""
        bounds = region(self.snapshot)
        bounds[self.axis] = 0.0, 1.0
        return np.diff(self.edges) * volume_between(bounds, self.snapshot)

    @property
    def coordinates(self) -> Mapping[str, np.ndarray]:
        """The place across in the middle, at the lower and at the upper border, such as x, x_lower, x_upper."""
        name, low, high = self.snapshot.axes[self.axis], self.edges[:-1], self.edges[1:]
        return {name: (low + high) / 2.0, f"{name}_lower": low, f"{name}_upper": high}

    @cached_property
    def entries(self) -> Entries:
        """Fractions of particles by segments."""
        where = placed(self.snapshot, self.weights, [self.axis])
        x, a = where.x[:, self.axis], where.radius
        below_plane = (disc_below_line, sphere_below_plane)[self.snapshot.dimension - 2]
        below = below_centres(x)
        if self.weights == AREA:
            def below(border: np.ndarray, row: np.ndarray) -> np.ndarray:
                return below_plane((border - x[row]) / a[row])

        borders = open_edges(self.edges, self.axis, self.walls, self.snapshot)
        return entries_of(shares_along(borders, x, a, below), where)
