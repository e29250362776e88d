"""One state of a granular system: particles, contacts, walls; the one in-memory form.

Conventions: SI, float64; compression positive in stresses and overlaps; the contact normal points
from j to i. All quantities of a 2D state are per unit thickness unless it has a thickness other than 1 m.

Columns (arrays of one length a group; optional ones may be absent, never filled with zeros):

particles
    id, x, y[, z], radius[, mass, vx, vy, vz, wx, wy, wz, inertia (moment, kg m^2),
    rotation (2D: angle turned since the start, rad, counter-clockwise)]
contacts
    i, j (particle ids; j < 0: wall -j), px, py[, pz] (contact point), fx, fy[, fz] (force on i)
    [, mx, my, mz (couple on i), ux, uy, uz (spring elongation: elastic displacement of i relative
    to j at the contact, tangential part), overlap, kn, kt]
walls
    id, px, py[, pz], then for a flat wall nx, ny[, nz] (unit normal, from the wall to the particles; px, py[, pz]
    is any point of it), for a ring radius (px, py its centre; in 3D a cylinder along z), either one NaN where it is
    the other; fx, fy[, fz] (force of the particles on the wall, so a pressed wall's points against its normal)
    [, torque (of the particles on a ring about its centre, N m, counter-clockwise)]

What ring walls give: bounds and centre of ring cells, the centre of the polar frame, the annulus as the volume of the
whole sample. Discs that are glued on them are not particles: volumes are those of the bare annulus.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass

import numpy as np


class MissingColumn(KeyError):
    """A quantity needs a column that the state does not have; the message names it."""

    def __str__(self) -> str:
        return str(self.args[0])


class Columns(Mapping[str, np.ndarray]):
    """Named float64 columns of one length, read-only.

    >>> c = Columns({"id": [1, 2], "x": [0.0, 1.0]})
    >>> len(c["x"]), c.rows, "y" in c
    (2, 2, False)
    """

    def __init__(self, columns: Mapping[str, object], group: str = "table"):
        self.group = group
        self._columns = {k: _frozen(v) for k, v in columns.items()}
        lengths = {k: len(v) for k, v in self._columns.items()}
        if len(set(lengths.values())) > 1:
            raise ValueError(f"{group}: columns of unequal length: {lengths}")
        self.rows = next(iter(lengths.values()), 0)

    def __getitem__(self, name: str) -> np.ndarray:
        if name not in self._columns:
            raise MissingColumn(f"{self.group} has no column '{name}'")
        return self._columns[name]

    def __iter__(self) -> Iterator[str]:
        return iter(self._columns)

    def __len__(self) -> int:
        return len(self._columns)

    def __contains__(self, name: object) -> bool:
        return name in self._columns

    def vector(self, *names: str) -> np.ndarray:
        """Stack columns into an array of shape (rows, len(names))."""
        return np.column_stack([self[n] for n in names]) if self.rows else np.empty((0, len(names)))


@dataclass(frozen=True, kw_only=True)
class Snapshot:
    """One state. `contacts` is None when they were not recorded (which differs from having none).

    box: (dim, 2) lower and upper bounds of the region the particles live in (for a box with four
    walls: the walls' positions), or None. periodic: one bool an axis. centre: (dim,), what polar components and rings
    are about where no ring walls say it, None for the origin.
    """

    time: float
    dimension: int
    particles: Columns
    contacts: Columns | None = None
    walls: Columns | None = None
    box: np.ndarray | None = None
    periodic: tuple[bool, ...] | None = None
    thickness: float = 1.0
    centre: tuple[float, ...] | None = None

    @property
    def per_thickness(self) -> bool:
        """Whether quantities are those of a unit of thickness, so that stresses are in N/m, not in Pa."""
        return self.dimension == 2 and self.thickness == 1.0

    @property
    def axes(self) -> tuple[str, ...]:
        """("x", "y") or ("x", "y", "z")."""
        return ("x", "y", "z")[: self.dimension]


def _frozen(values: object) -> np.ndarray:
    array = np.array(values, dtype=np.float64)
    array.flags.writeable = False
    return array
