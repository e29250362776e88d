"""What a state must be before any formula sees it, and the one line that says where it is not."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from postproc.geometry import positions, vector
from postproc.snapshot import Columns, Snapshot
from postproc.trajectory import GROUPS, ReadError

MAY_BE_UNKNOWN = {"contacts": ("ux", "uy", "uz"), "walls": ("nx", "ny", "nz", "radius", "torque")}
"""Columns in which NaN says that one row lacks the value: a spring that an engine cannot tell, the normal of a ring,
radius and torque of a plane."""

LARGEST = 1e30
"""Numbers beyond this are no physical values of grains in SI units, and high powers of them overflow."""

UNIT = 1e-9
"""How far the length of a normal may be from 1."""


def wrong(path: Path, place: str, expected: str, got: object) -> ReadError:
    """Return the error, one line: file, place, what was expected, what came.

    >>> print(wrong(Path("a.h5"), "particles.radius: row 3", "a number > 0", -1.0))
    a.h5: particles.radius: row 3: expected a number > 0, got -1.0
    """
    return ReadError(" ".join(f"{path}: {place}: expected {expected}, got {got}".split()))


def check_snapshot(path: Path, snapshot: Snapshot, place: str = "") -> Snapshot:
    """Return the snapshot if it is sound; raise ReadError at the first fault.

    Finite numbers everywhere (NaN only in MAY_BE_UNKNOWN), positive radii, masses and box lengths,
    unit normals of walls, ids unique, contacts between particles that exist or with walls that exist (if walls are
    recorded at all), each pair listed once (in a periodic box two images may touch twice).
    `place` goes before every place, e.g. ``frame 3: ``.
    """
    check = _Check(path, place)
    for group in GROUPS:
        table = getattr(snapshot, group)
        if table is not None:
            check.finite(table, group)
    check.box(snapshot)
    check.ids(snapshot.particles, "particles")
    check.positive(snapshot.particles, "particles", "radius", "mass", "inertia")
    if snapshot.walls is not None:
        check.ids(snapshot.walls, "walls")
        check.walls(snapshot)
    if snapshot.contacts is not None:
        check.partners(snapshot)
    return snapshot


def check_places(path: Path, snapshot: Snapshot) -> Snapshot:
    """Return the snapshot if nothing lies beyond its box, if it has one; raise ReadError at the first fault.

    On axes that are not periodic centres lie in the box, contact points within the largest radius of it. For states
    made by hand or by other codes; a run that lost a particle is read and judged by who made it.
    """
    check = _Check(path, "")
    reach = snapshot.particles["radius"].max(initial=0.0)
    periodic = snapshot.periodic or (False,) * snapshot.dimension
    for axis, bounds, free in zip(snapshot.axes, () if snapshot.box is None else snapshot.box, periodic, strict=False):
        if free:
            continue
        low, high = bounds
        x = snapshot.particles[axis]
        check.all_good((low <= x) & (x <= high), x, f"particles.{axis}", f"a centre in the box, {low:g} to {high:g}")
        if snapshot.contacts is not None:
            p = snapshot.contacts["p" + axis]
            near = (low - reach <= p) & (p <= high + reach)
            check.all_good(near, p, f"contacts.p{axis}", f"a point in the box, {low:g} to {high:g}")
    return snapshot


MOST_LISTED = 6


def _listed(numbers: np.ndarray) -> str:
    """Return numbers as an addition to a sentence, a few of many; nothing of none."""
    shown = [f"{n:.17g}" for n in numbers[:MOST_LISTED]] + ["..."] * (len(numbers) > MOST_LISTED)
    return f" ({', '.join(shown)})" if shown else ", of which there are none"


class _Check:
    """Single checks; rows are counted from 1 in messages."""

    def __init__(self, path: Path, place: str):
        self.path, self.prefix = path, place

    def all_good(self, good: np.ndarray, values: np.ndarray, place: str, expected: str) -> None:
        if not good.all():
            row = int(np.argmin(good))
            raise wrong(self.path, f"{self.prefix}{place}: row {row + 1}", expected, f"{values[row]:.17g}")

    def finite(self, table: Columns, group: str) -> None:
        for name in table:
            values = table[name]
            unknown = np.isnan(values) & (name in MAY_BE_UNKNOWN.get(group, ()))
            self.all_good(unknown | np.isfinite(values), values, f"{group}.{name}", "a finite number")
            self.all_good(unknown | (np.abs(values) < LARGEST), values, f"{group}.{name}", f"less than {LARGEST:g}")

    def positive(self, table: Columns, group: str, *names: str) -> None:
        for name in names:
            if name in table:
                self.all_good(table[name] > 0, table[name], f"{group}.{name}", "a number > 0")

    def ids(self, table: Columns, group: str) -> None:
        ids = table["id"]
        lowest = 1 if group == "walls" else 0
        self.all_good((ids >= lowest) & (ids % 1 == 0), ids, f"{group}.id", f"a whole number >= {lowest}")
        first = np.zeros(len(ids), dtype=bool)
        first[np.unique(ids, return_index=True)[1]] = True
        self.all_good(first, ids, f"{group}.id", "every id once")

    def walls(self, snapshot: Snapshot) -> None:
        """A wall is flat, with a unit normal, or a ring, with a radius."""
        walls, names = snapshot.walls, ["n" + axis for axis in snapshot.axes]
        flat, ring = np.zeros((2, walls.rows), dtype=bool)
        if names[0] in walls:
            length = np.linalg.norm(walls.vector(*names), axis=1)
            flat = np.isfinite(length)
            self.all_good(~flat | (np.abs(length - 1.0) < UNIT), length, "walls.n", "a normal of length 1")
        if "radius" in walls:
            radius = walls["radius"]
            ring = np.isfinite(radius)
            self.all_good(~ring | (radius > 0), radius, "walls.radius", "a number > 0")
        if names[0] in walls or "radius" in walls:
            kinds = flat.astype(float) + ring
            self.all_good(kinds == 1, kinds, "walls", "either a normal or a radius in every row")

    def partners(self, snapshot: Snapshot) -> None:
        contacts = snapshot.contacts
        i, j = contacts["i"], contacts["j"]
        known = snapshot.particles["id"]
        self.all_good(np.isin(i, known), i, "contacts.i", "the id of a particle")
        either = "the id of a particle, or of a wall with a minus sign before it"
        self.all_good((j < 0) | np.isin(j, known), j, "contacts.j", either)
        if snapshot.walls is not None:
            wall = snapshot.walls["id"]
            expected = "the id of a wall with a minus sign before it" + _listed(-wall)
            self.all_good((j >= 0) | np.isin(-j, wall), j, "contacts.j", expected)
        self.all_good(i != j, i, "contacts", "two different particles")
        if not any(snapshot.periodic or ()):
            self.once(i, j)
        self.points(snapshot)

    def points(self, snapshot: Snapshot) -> None:
        """A contact point on a centre has no direction from there."""
        contacts = snapshot.contacts
        x, known = positions(snapshot), snapshot.particles["id"]
        order = np.argsort(known)
        for name in ("i", "j"):
            rows = np.flatnonzero(contacts[name] >= 0)
            particle = order[np.searchsorted(known, contacts[name][rows], sorter=order)]
            apart = np.full(contacts.rows, np.inf)
            apart[rows] = np.abs(vector(contacts, "p", snapshot)[rows] - x[particle]).max(axis=1)
            self.all_good(apart > 0, contacts[name], "contacts.p", f"a point beside the centre of particle {name}")

    def once(self, i: np.ndarray, j: np.ndarray) -> None:
        pairs = np.flatnonzero(j >= 0)
        low_high = np.sort(np.column_stack([i, j])[pairs], axis=1)
        first = np.ones(len(i), dtype=bool)
        first[pairs] = False
        first[pairs[np.unique(low_high, axis=0, return_index=True)[1]]] = True
        if not first.all():
            row = int(np.argmin(first))
            got = f"{i[row]:.0f} and {j[row]:.0f} again"
            raise wrong(self.path, f"{self.prefix}contacts: row {row + 1}", "every pair of particles once", got)

    def box(self, snapshot: Snapshot) -> None:
        box = snapshot.box
        if box is None:
            return
        if np.shape(box) != (snapshot.dimension, 2):
            raise wrong(self.path, f"{self.prefix}box", f"shape ({snapshot.dimension}, 2)", np.shape(box))
        lengths = np.diff(box, axis=1)[:, 0]
        self.all_good((lengths > 0) & (lengths < LARGEST), lengths, "box", "upper bounds above lower bounds")
