"""The two parts into which a line (in 3D a plane) cuts the box as cells."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from postproc.averaging.cells import Entries, Weighted
from postproc.averaging.fractions import disc_below_line, sphere_below_plane
from postproc.averaging.partition import AREA, below_centres, entries_of, placed, shares_along
from postproc.averaging.words import number, refuse
from postproc.geometry import box_bounds, periodic_axes, volume_between
from postproc.snapshot import MissingColumn, Snapshot


@dataclass(frozen=True, kw_only=True)
class HalfPlane(Weighted):
    """Below (n . x < distance) and above the line with the unit normal n = `normal` (dim,); distance in m.

    weights: "area", the exact fraction of each disc (3D: sphere), or "centre". What overlaps a wall of the box
    counts on its side of the line; the volumes are those of the two parts of the box.
    """

    normal: tuple[float, ...]
    distance: float
    weights: str = AREA

    labels = ("below", "above")

    @classmethod
    def settings(cls, words: Sequence[str], snapshot: Snapshot) -> dict[str, object]:
        """halfplane:NX,NY:DISTANCE, in 3D halfplane:NX,NY,NZ:DISTANCE; the normal needs no unit length."""
        parts = words[0].split(",") if words else ()
        if len(words) != 2 or len(parts) != snapshot.dimension:
            example = "halfplane:1,0:0.05" if snapshot.dimension == 2 else "halfplane:1,0,0:0.05"
            raise refuse("halfplane", f"a normal and a distance, as in {example}", repr(":".join(words)))
        normal = np.array([number("halfplane", part, "the normal") for part in parts])
        length = float(np.linalg.norm(normal))
        if not 0.0 < length < np.inf:
            raise refuse("halfplane", "a normal that has a direction", words[0])
        settings = {"normal": tuple(normal / length), "distance": number("halfplane", words[1], "the distance")}
        _refuse_outside(cls(snapshot=snapshot, **settings), words[1])
        return settings

    @cached_property
    def volumes(self) -> np.ndarray:
        """Of the parts of the box, in 2D times the thickness, (2,)."""
        box = box_bounds(self.snapshot)
        below = self.distance - np.array(self.normal) @ box[:, 0]
        part = _below((box[:, 1] - box[:, 0]).tolist(), list(self.normal), float(below))
        whole = volume_between(box, self.snapshot)
        part *= self.snapshot.thickness if self.snapshot.dimension == 2 else 1.0
        return np.array([part, whole - part])

    @cached_property
    def entries(self) -> Entries:
        """Fractions of particles by segments."""
        normal = np.array(self.normal)
        crossing = [a for a in np.flatnonzero(periodic_axes(self.snapshot)) if normal[a] != 0]
        if crossing:
            raise MissingColumn(f"the line cuts the periodic axis {self.snapshot.axes[crossing[0]]}; ask for strips")
        where = placed(self.snapshot, self.weights, [])
        s, a = where.x @ normal, where.radius
        below_plane = (disc_below_line, sphere_below_plane)[self.snapshot.dimension - 2]
        below = below_centres(s)
        if self.weights == AREA:
            def below(border: np.ndarray, row: np.ndarray) -> np.ndarray:
                return below_plane((border - s[row]) / a[row])

        return entries_of(shares_along(np.array([-np.inf, self.distance, np.inf]), s, a, below), where)


def _refuse_outside(cells: HalfPlane, word: str) -> None:
    """Both parts must be there."""
    try:
        volumes = cells.volumes
    except MissingColumn as missing:
        raise refuse("halfplane", "a box", str(missing)) from None
    if not (volumes > 0).all():
        raise refuse("halfplane", "a line that cuts the box", f"the distance {word}, outside the sample")


def _below(lengths: list[float], normal: list[float], distance: float) -> float:
    """Volume of {0 <= x <= lengths, n . x <= distance}.

    Axes along the plane multiply. Across one axis: a length. Across more, the cross-section is continuous and piecewise
    a polynomial of degree dim - 1 <= 2 along the last axis, with breaks where the plane passes a corner, so that
    Simpson's rule between the breaks is exact.
    """
    along = math.prod(length for length, n in zip(lengths, normal, strict=True) if n == 0)
    across = [(length, n) for length, n in zip(lengths, normal, strict=True) if n != 0]
    return along * _below_across(*map(list, zip(*across, strict=True)), distance)


def _below_across(lengths: list[float], normal: list[float], distance: float) -> float:
    """The same where no component of the normal is 0."""
    (*rest, length), (*others, n) = lengths, normal
    if not rest:
        end = min(max(distance / n, 0.0), length)
        return end if n > 0 else length - end
    corners = np.array([0.0])
    for edge, m in zip(rest, others, strict=True):
        corners = np.concatenate([corners, corners + edge * m])
    breaks = np.unique(np.clip((distance - corners) / n, 0.0, length))
    breaks = np.unique(np.concatenate([[0.0], breaks, [length]]))
    volume = 0.0
    for low, high in zip(breaks[:-1], breaks[1:], strict=True):
        ends, middle = ((low, high), (low + high) / 2.0)
        sections = [_below_across(rest, others, distance - n * z) for z in (*ends, middle)]
        volume += (high - low) / 6.0 * (sections[0] + sections[1] + 4.0 * sections[2])
    return float(volume)
