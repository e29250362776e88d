"""The box without a border layer along its walls, as one cell."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from postproc.averaging.cells import Entries, Weighted
from postproc.averaging.partition import AREA, entries_of, placed, shares_in_rectangles
from postproc.averaging.words import WrongSetting
from postproc.geometry import box_bounds, periodic_axes, volume_between
from postproc.snapshot import MissingColumn

DEFAULT_MARGIN = 4.0
"""Margin in mean radii (two mean diameters) when none is given: layering at flat walls has mostly
died out there; the right margin of a study is the one beyond which its answer stops changing."""


@dataclass(frozen=True, kw_only=True)
class Inner(Weighted):
    """The box inset by `margin` (m) on every axis with walls.

    weights "area": exact fractions of the particles that the border cuts. "centre": 1 for a centre inside, 0 outside;
    averages over many borders or packings are right (as many parts stick out as stick in), one snapshot scatters by
    about (border particles)^(1/2) / (particles), and in an ordered packing aligned with the border the error does not
    average out. A margin is inset from walls only; with none it is refused.
    """

    margin: float | None = None
    weights: str = AREA

    labels = ("inner",)

    def __post_init__(self) -> None:
        """Raise WrongSetting for a margin where no axis has walls."""
        if self.margin is not None and periodic_axes(self.snapshot).all():
            raise WrongSetting("margin: expected none in a box without walls, where there is no border to leave out")

    @cached_property
    def bounds(self) -> np.ndarray:
        """Lower and upper bound of each axis, (dim, 2), m."""
        inset = np.where(periodic_axes(self.snapshot), 0.0, self._margin())
        bounds = box_bounds(self.snapshot) + inset[:, None] * [1.0, -1.0]
        if not (bounds[:, 0] < bounds[:, 1]).all():
            raise MissingColumn(f"nothing is left of the box inside a margin of {inset.max():g} m")
        return bounds

    @cached_property
    def entries(self) -> Entries:
        """Parts inside. An axis without walls has no border: all of it is inside."""
        whole = np.array([-np.inf, np.inf])
        periodic = periodic_axes(self.snapshot)
        borders = [whole if free else limits for free, limits in zip(periodic, self.bounds, strict=True)]
        where = placed(self.snapshot, self.weights, axes=())
        return entries_of(shares_in_rectangles(borders, where, self.weights), where)

    @cached_property
    def volumes(self) -> np.ndarray:
        """Volume of the inset box, (1,)."""
        return np.array([volume_between(self.bounds, self.snapshot)])

    def _margin(self) -> float:
        if self.margin is not None:
            return self.margin
        return DEFAULT_MARGIN * float(self.snapshot.particles["radius"].mean())
