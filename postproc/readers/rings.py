"""Rings of glued discs: where they are, their rows among the walls, their contacts among the pairs of a code.

Codes of the LAMMPS family hold glued discs as atoms N+1, N+2, ..., ring after ring; nothing of them is dumped, because
they follow from the time::

    x_g(t) = c + Q(omega t) (x_g(0) - c)
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from postproc.snapshot import Columns

COLUMNS = ("torque", "fx", "fy")
"""What a run writes of a ring: torque of the particles on it about its centre (N m) and their force (N)."""

PLANE_ONLY, RING_ONLY = ("nx", "ny"), ("radius", "torque")
"""Columns of the walls' table that one kind of wall lacks."""


@dataclass(frozen=True, kw_only=True)
class GluedRing:
    """A ring as the run had it: centre (2,) and radius of the circle, m; centres of its discs at the start (M, 2).

    radius: of the discs, (M,), m. omega: rad/s, counter-clockwise, 0 for a ring that rests.
    """

    index: int
    name: str
    centre: tuple[float, float]
    circle: float
    x: np.ndarray
    radius: np.ndarray
    omega: float

    def places(self, time: float) -> np.ndarray:
        """Return the centres of the discs, (M, 2), m."""
        arm = self.x - np.array(self.centre)
        c, s = np.cos(self.omega * time), np.sin(self.omega * time)
        return np.array(self.centre) + arm @ np.array([[c, s], [-s, c]])


def ring_series(rings: Sequence[GluedRing], time: np.ndarray) -> dict[str, np.ndarray]:
    """Return how far each ring has turned since the start, rad, by the name of the series' column."""
    return {f"{ring.name}_angle": ring.omega * time for ring in rings}


def with_glued_discs(particles: Columns, rings: Sequence[GluedRing], time: float) -> Columns:
    """Return x, y and radius of the particles, ids 1 to N, and of the glued discs behind them, at a time."""
    if not rings:
        return particles
    x = np.concatenate([particles.vector("x", "y"), *(ring.places(time) for ring in rings)])
    radius = np.concatenate([particles["radius"], *(ring.radius for ring in rings)])
    return Columns({"x": x[:, 0], "y": x[:, 1], "radius": radius}, "particles")


def name_rings(j: np.ndarray, count: int, rings: Sequence[GluedRing]) -> np.ndarray:
    """Return the ids of second partners, those of glued discs (above `count`) replaced by - the index of their ring."""
    named = np.concatenate([np.arange(1, count + 1), *(np.full(len(r.radius), -r.index) for r in rings)])
    return named[j - 1]


def with_ring_rows(walls: Columns | None, rings: Sequence[GluedRing], table: Columns, row: int) -> Columns | None:
    """Return the walls' table with the rings at one row of a series.

    A ring has no normal and a plane no radius and torque: NaN, where both kinds exist.
    """
    if not rings:
        return walls
    found = {
        "id": [r.index for r in rings], "px": [r.centre[0] for r in rings], "py": [r.centre[1] for r in rings],
        "radius": [r.circle for r in rings], **{c: [table[f"{r.name}_{c}"][row] for r in rings] for c in COLUMNS},
    }
    if walls is None:
        return Columns(found, "walls")
    names = [*walls, *RING_ONLY]
    missing = {"planes": np.full(walls.rows, np.nan), "rings": np.full(len(rings), np.nan)}
    joined = {
        c: np.concatenate([walls[c] if c in walls else missing["planes"], found.get(c, missing["rings"])])
        for c in names
    }
    return Columns(joined, "walls")
