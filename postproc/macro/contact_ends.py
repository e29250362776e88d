"""Contacts as the particles see them: the sum over c in every formula of the talk.

A contact of two particles has two ends, one at each: at i the force is f, at j it is -f (Newton's
third law), and the branch vectors lead from each centre to the common contact point. A contact with
a wall has one end. Every sum over p and c runs over these ends.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from postproc.geometry import nearest_image, positions, vector
from postproc.snapshot import Columns, MissingColumn, Snapshot
from postproc.sums import grouped_sum, lengths

WALL = -1
"""Partner of an end whose other side is a wall."""


@dataclass(frozen=True, kw_only=True)
class ContactEnds:
    """E ends of C contacts at N particles.

    particle: (E,) row of the particle p. partner: (E,) row of the other one, or WALL.
    contact: (E,) row of the contact c.
    l: (E, dim) branch vector l^pc from the centre of p to the contact point, m.
    f: (E, dim) force on p, N.
    """

    count: int
    particle: np.ndarray
    partner: np.ndarray
    contact: np.ndarray
    l: np.ndarray  # noqa: E741  (the talk's letter)
    f: np.ndarray

    @cached_property
    def length(self) -> np.ndarray:
        """|l^pc|, (E,), m."""
        return lengths(self.l)

    @cached_property
    def n(self) -> np.ndarray:
        """Unit vector n^pc = l/|l| out of p, (E, dim); for discs and spheres the contact normal.

        It has the sign opposite to the normal "from j to i" at i; dyads n n do not see it.
        """
        return self.l / self.length[:, None]

    @cached_property
    def share(self) -> np.ndarray:
        """Fraction of its contact that an end stands for: 1/2 between particles, 1 at a wall, (E,)."""
        return np.where(self.partner == WALL, 1.0, 0.5)

    def sum_c(self, q: np.ndarray) -> np.ndarray:
        """Sum over the contacts of each particle, (E, ...) -> (N, ...): sum_c Q^pc."""
        return grouped_sum(q, self.particle, self.count)


def outer(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """Dyads a b, component (alpha, beta) = a_alpha b_beta, (E, dim) x (E, dim) -> (E, dim, dim)."""
    return np.einsum("na,nb->nab", a, b)


def recorded_contacts(snapshot: Snapshot) -> Columns:
    """Return the contacts; MissingColumn when they were not recorded."""
    if snapshot.contacts is None:
        raise MissingColumn("contacts were not recorded")
    return snapshot.contacts


def contact_ends(snapshot: Snapshot) -> ContactEnds:
    """Return both ends of every contact, first all ends at i, then the ends at j that are particles."""
    contacts = recorded_contacts(snapshot)
    row_i, row_j = (_rows_of(contacts[name], snapshot) for name in ("i", "j"))
    pairs = np.flatnonzero(row_j != WALL)
    point, force = vector(contacts, "p", snapshot), vector(contacts, "f", snapshot)
    particle = np.concatenate([row_i, row_j[pairs]])
    contact = np.concatenate([np.arange(contacts.rows), pairs])
    return ContactEnds(
        count=snapshot.particles.rows,
        particle=particle,
        partner=np.concatenate([row_j, row_i[pairs]]),
        contact=contact,
        l=nearest_image(point[contact] - positions(snapshot)[particle], snapshot),
        f=np.concatenate([force, -force[pairs]]),
    )


def _rows_of(ids: np.ndarray, snapshot: Snapshot) -> np.ndarray:
    """Rows of the particles with these ids, WALL for negative ids (readers have checked that all exist)."""
    known = snapshot.particles["id"]
    if len(known) and np.array_equal(known, known[0] + np.arange(len(known))):  # without a search
        return np.where(ids < 0, WALL, ids - known[0]).astype(np.intp)
    order = np.argsort(known)
    rows = order[np.searchsorted(known, np.maximum(ids, known.min(initial=0)), sorter=order)]
    return np.where(ids < 0, WALL, rows)
