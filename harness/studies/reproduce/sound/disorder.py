"""Weak disorder of sizes: strong disorder of contacts. The packing at rest, and what linear theory says of it.

Radii are R + w delta u, u uniform in (-1, 1), on a lattice whose spacing stays: w is of the order of one while the
sizes differ by a part in a thousand. The forces then balance where the energy sum k (overlap)^2/2 in a periodic box of
fixed size is least (Newton's method on the contacts that are closed, which may open and close on the way).

Small waves in this packing follow m u'' = -K u with the dynamic matrix K of its closed contacts, k n n - F/r (1 - n n)
each. Its leapfrog with the time step of a run tells what that run must give, whatever the code.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from harness.errors import InputError
from harness.studies.reproduce.sound.column import Column

REACH = 1.02
"""Bonds of the regular lattice, and no others, are shorter than this times the spacing."""

SOFT = 1e-7
"""Stiffness of a spring to its place that every sphere gets in a Newton step, over k: spheres without contacts stay."""

BALANCED, MOST_STEPS = 1e-9, 100
"""Largest force left, over that of a contact of the regular packing (rounding leaves 1e-10); Newton steps allowed."""

SHORTEST = 2.0**-20
"""Part of a Newton step below which none lowers the energy: what is left is rounding."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Sample:
    """A packing at rest. places (N, 3), radius (N,), m. first, second (C,): bonds; closed (C,): those that touch.

    residual: largest force left over that of a contact of the regular packing.
    """

    column: Column
    places: np.ndarray
    radius: np.ndarray
    first: np.ndarray
    second: np.ndarray
    closed: np.ndarray
    residual: float

    @classmethod
    def regular(cls, column: Column, radius: np.ndarray) -> Sample:
        """Return the regular packing with all its contacts closed, which rests by symmetry."""
        first, second = lattice_bonds(column)
        return cls(column=column, places=column.places(), radius=radius, first=first, second=second,
                   closed=np.ones(len(first), dtype=bool), residual=0.0)

    @property
    def contacts_per_sphere(self) -> float:
        """12 in the regular packing."""
        return 2 * float(self.closed.sum()) / len(self.radius)


def relaxed_sample(column: Column, width: float, seed: int) -> Sample:
    """Return the packing of disorder w = `width` with this seed.

    Raises InputError when the forces cannot be balanced.
    """
    material = column.material
    drawn = np.random.default_rng(seed).uniform(-1, 1, column.count)
    radius = material.radius * (1 + width * material.overlap * drawn)
    first, second = lattice_bonds(column)
    bonds = _Bonds.of(column, column.places(), radius, first, second)
    for _ in range(MOST_STEPS):
        residual = float(np.abs(bonds.force()).max()) / (material.stiffness * material.overlap * material.radius)
        if residual < BALANCED:
            return Sample(column=column, places=bonds.places, radius=radius, first=first, second=second,
                          closed=bonds.overlap > 0, residual=residual)
        bonds = _downhill(bonds, column, radius)
    raise InputError(
        file="packing", place=f"disorder {width:g}, seed {seed}", expected="a packing in balance",
        got=f"a force of {residual:.2g} of a contact's left after {MOST_STEPS} steps", fix="lower the disorder",
    )


def lattice_bonds(column: Column) -> tuple[np.ndarray, np.ndarray]:
    """Return the nearest neighbours (C,), (C,) of the regular packing, first < second, each pair once."""
    from scipy.spatial import cKDTree

    reach = REACH * column.material.waves().spacing
    pairs = cKDTree(column.places(), boxsize=column.box).query_pairs(reach, output_type="ndarray")
    return pairs[:, 0], pairs[:, 1]


def linear_velocities(sample: Sample, velocity: np.ndarray, dt: float, every: int, frames: int) -> np.ndarray:
    """Return what the dynamic matrix makes of initial velocities (N, 3): (frames + 1, N, 3), `every` steps of dt apart.

    Velocities at whole steps of a leapfrog, like those of the engines.
    """
    bonds = _Bonds.of(sample.column, sample.places, sample.radius, sample.first, sample.second)
    pull = bonds.matrix().tocsr() * -1.0
    mass = np.repeat(sample.column.material.mass_of(sample.radius), 3)
    u, v = np.zeros(velocity.size), velocity.ravel().copy()
    a, kept = pull @ u / mass, [velocity]
    for step in range(1, every * frames + 1):
        v += 0.5 * dt * a
        u += dt * v
        a = pull @ u / mass
        v += 0.5 * dt * a
        if step % every == 0:
            kept.append(v.reshape(-1, 3).copy())
    return np.array(kept)


@dataclass(frozen=True, kw_only=True, eq=False)
class _Bonds:
    """Bonds in one state: overlap (C,), m, negative where open; normal (C, 3) from second to first; distance (C,)."""

    places: np.ndarray
    stiffness: float
    first: np.ndarray
    second: np.ndarray
    overlap: np.ndarray
    normal: np.ndarray
    distance: np.ndarray

    @classmethod
    def of(
        cls, column: Column, places: np.ndarray, radius: np.ndarray, first: np.ndarray, second: np.ndarray
    ) -> _Bonds:
        box, apart = np.array(column.box), places[first] - places[second]
        apart -= box * np.round(apart / box)
        distance = np.linalg.norm(apart, axis=1)
        return cls(
            places=places, stiffness=column.material.stiffness, first=first, second=second, distance=distance,
            overlap=radius[first] + radius[second] - distance, normal=apart / distance[:, None],
        )

    @property
    def count(self) -> int:
        """Number of spheres."""
        return len(self.places)

    @property
    def energy(self) -> float:
        """Sum of k (overlap)^2/2 of the closed bonds, N m."""
        return 0.5 * self.stiffness * float((np.maximum(self.overlap, 0) ** 2).sum())

    def force(self) -> np.ndarray:
        """Return the forces (N, 3), N."""
        push = (self.stiffness * np.maximum(self.overlap, 0))[:, None] * self.normal
        total = np.zeros((self.count, 3))
        np.add.at(total, self.first, push)
        np.add.at(total, self.second, -push)
        return total

    def matrix(self):
        """Return K (3 N, 3 N), N/m: minus the derivative of the forces of the closed bonds."""
        from scipy.sparse import coo_array

        closed = self.overlap > 0
        n, i, j = self.normal[closed], self.first[closed], self.second[closed]
        along = n[:, :, None] * n[:, None, :]
        push = self.stiffness * (self.overlap / self.distance)[closed]
        block = self.stiffness * along - push[:, None, None] * (np.eye(3) - along)
        rows, columns, values = [], [], []
        for a, b, sign in ((i, i, 1.0), (j, j, 1.0), (i, j, -1.0), (j, i, -1.0)):
            rows.append((3 * a[:, None, None] + np.arange(3)[:, None] + 0 * np.arange(3)).ravel())
            columns.append((3 * b[:, None, None] + 0 * np.arange(3)[:, None] + np.arange(3)).ravel())
            values.append((sign * block).ravel())
        size = 3 * self.count
        joined = (np.concatenate(values), (np.concatenate(rows), np.concatenate(columns)))
        return coo_array(joined, shape=(size, size)).tocsc()


def _downhill(bonds: _Bonds, column: Column, radius: np.ndarray) -> _Bonds:
    """Return the bonds after a Newton step, shortened until it lowers the energy; contacts may close on the way."""
    step, part = _newton(bonds, bonds.force()), 1.0
    while part >= SHORTEST:
        tried = _Bonds.of(column, bonds.places + part * step, radius, bonds.first, bonds.second)
        if tried.energy < bonds.energy:
            return tried
        part /= 2
    return _Bonds.of(column, bonds.places + step, radius, bonds.first, bonds.second)


def _newton(bonds: _Bonds, force: np.ndarray) -> np.ndarray:
    """Return the displacements (N, 3) that balance the forces of the bonds that are closed now."""
    from scipy.sparse import eye_array
    from scipy.sparse.linalg import spsolve

    held = bonds.matrix() + SOFT * bonds.stiffness * eye_array(3 * bonds.count, format="csc")
    return spsolve(held, force.ravel()).reshape(-1, 3)
