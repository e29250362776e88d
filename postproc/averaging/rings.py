"""Concentric rings (in 3D cylinder shells about the z axis) as cells."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from postproc.averaging.cells import Entries, Weighted, divide
from postproc.averaging.fractions import disc_in_circle
from postproc.averaging.frame import CARTESIAN, POLAR
from postproc.averaging.partition import AREA, Below, Placed, below_centres, entries_of, shares_along
from postproc.averaging.shells import sphere_in_cylinder
from postproc.averaging.words import ROUND_OFF, at_walls, edges, refuse
from postproc.geometry import (
    box_lengths,
    centre,
    nearest_image,
    periodic_axes,
    positions,
    ring_bounds,
    ring_volumes,
    ring_walls,
)
from postproc.snapshot import MissingColumn, Snapshot

POKES = 0.5
"""Part of its radius that a particle may stick out over a ring wall (an overlap) and still count whole."""


@dataclass(frozen=True, kw_only=True)
class Rings(Weighted):
    """K rings between the radii `edges` (K+1,), m, about the centre of the ring walls (without them the origin).

    weights: "area", the exact fraction of each disc that lies in the ring (3D: of the sphere), or "centre".
    walls: whether the first and last radius are those of ring walls; what a particle overlaps with such a
    wall stays in the outermost ring, so that all rings together count every particle once.
    Volumes are those of the bare rings: discs glued on the walls are neither taken out of them nor counted.
    Source: Laetzel, Luding, Herrmann, Granular Matter 2, 123 (2000), section 3.
    """

    edges: np.ndarray
    weights: str = AREA
    frame: str = POLAR
    walls: tuple[bool, bool] = (False, False)

    @classmethod
    def settings(cls, words: Sequence[str], snapshot: Snapshot) -> dict[str, object]:
        """rings:NUMBER (between the ring walls), rings:NUMBER:R1:R2 or rings:R1,R2,R3,..."""
        try:
            centre(snapshot)
            whole = ring_bounds(snapshot)
        except MissingColumn as missing:
            whole = str(missing)
        borders = edges("rings", words, whole)
        if borders[0] < 0:
            raise refuse("rings", "radii of 0 and more", f"{borders[0]:g}")
        if not ring_walls(snapshot).size:
            _refuse_outside(borders[-1], snapshot)
            return {"edges": borders}
        if isinstance(whole, str):
            raise refuse("rings", "ring walls about one centre, around the particles", whole)
        return {"edges": borders, "walls": at_walls("rings", borders, whole, "between the ring walls,")}

    @cached_property
    def labels(self) -> tuple[str, ...]:
        """1 to K, from the inside."""
        return tuple(str(k) for k in range(1, len(self.edges)))

    @cached_property
    def volumes(self) -> np.ndarray:
        """pi (r_outer^2 - r_inner^2) times thickness (2D) or height of the box (3D), (K,)."""
        return ring_volumes(self.edges, self.snapshot)

    @property
    def coordinates(self) -> Mapping[str, np.ndarray]:
        """r in the middle, r_inner, r_outer."""
        return {"r": (self.edges[1:] + self.edges[:-1]) / 2.0, "r_inner": self.edges[:-1], "r_outer": self.edges[1:]}

    @cached_property
    def entries(self) -> Entries:
        """Fractions of particles by the lens of two circles."""
        arms = nearest_image(positions(self.snapshot) - centre(self.snapshot), self.snapshot)
        r = np.hypot(arms[:, 0], arms[:, 1])
        reach = self.snapshot.particles["radius"] if self.weights == AREA else np.zeros(len(r))
        where = Placed(particle=np.arange(len(r)), x=arms + centre(self.snapshot), radius=reach)
        return entries_of(shares_along(self.edges, r, reach, self._below(r)), where)

    def _below(self, r: np.ndarray) -> Below:
        """Fraction within a radius; over a wall nothing is cut off."""
        if self.weights != AREA:
            return below_centres(r)
        a, inside = self.snapshot.particles["radius"], (disc_in_circle, sphere_in_cylinder)[self.snapshot.dimension - 2]
        inner, outer = (edge if wall else np.nan for edge, wall in zip(self.edges[[0, -1]], self.walls, strict=True))

        def below(border: np.ndarray, row: np.ndarray) -> np.ndarray:
            at, reach = r[row], POKES * a[row]
            fraction = inside(border, a[row], at)
            fraction[(border == inner) & (at - reach > border)] = 0.0
            fraction[(border == outer) & (at + reach < border)] = 1.0
            return fraction

        return below

    def gradient(self, q: np.ndarray, mass: np.ndarray | None = None) -> np.ndarray:
        """Axisymmetric in the polar frame: least squares of q over the particles' r, and nothing changes with phi.

        Of a scalar: (dq/dr, 0). Of a vector, component (a, b) = d v_a / d x_b in cylinder coordinates:
        rr: dv_r/dr, r phi: -v_phi/r, phi r: dv_phi/dr, phi phi: v_r/r, with the weighted means of v and r, so that
        a rigid rotation has v_phi/r = dv_phi/dr = Omega to round-off. 3D: over r and z.
        In the Cartesian frame like any cell.
        """
        if self.frame == CARTESIAN:
            return super().gradient(q, mass)
        q, fit = np.asarray(q, dtype=np.float64), self.fit(mass)
        gradient = np.insert(fit.slope(q), 1, 0.0, axis=-1)
        gradient[..., 1] += np.where(np.isnan(gradient[..., 0]), np.nan, 0.0)
        if q.ndim > 1:
            turning = divide(fit.mean(q), fit.place[:, 0])
            gradient[:, 0, 1], gradient[:, 1, 1] = -turning[:, 1], turning[:, 0]
        return gradient

    def places(self, x: np.ndarray) -> np.ndarray:
        """r[, z] in the polar frame."""
        if self.frame == CARTESIAN:
            return x
        arms = x - centre(self.snapshot)
        return np.column_stack([np.hypot(arms[:, 0], arms[:, 1]), arms[:, 2:]])


def _refuse_outside(outermost: float, snapshot: Snapshot) -> None:
    """Rings must lie in the box, if there is one, and must not meet their own periodic images."""
    if snapshot.box is None:
        return
    low, high = np.asarray(snapshot.box, dtype=float)[:2].T
    middle = centre(snapshot)[:2]
    room = np.minimum(high - middle, middle - low)
    periodic = periodic_axes(snapshot)[:2]
    room = np.where(periodic, box_lengths(snapshot)[:2] / 2.0 - snapshot.particles["radius"].max(initial=0.0), room)
    if outermost > room.min() * (1.0 + ROUND_OFF):
        room = f"{max(room.min(), 0.0):.9g}"
        raise refuse("rings", f"cells inside the sample, radii up to {room} m about the centre", f"{outermost:.9g}")
