"""Springs of the contacts: stiffness, elongation, and the elastic displacement that each end takes of it."""

from __future__ import annotations

import numpy as np

from postproc.geometry import vector
from postproc.macro.contact_ends import ContactEnds, recorded_contacts
from postproc.snapshot import MissingColumn, Snapshot

CENTRAL = 1e-9
"""Tangential over total force below which all forces of a state count as central (round-off)."""


def at_i(ends: ContactEnds) -> slice:
    """Rows of the ends at i, one a contact in their order: `contact_ends` lists them first."""
    return slice(0, int(ends.contact.max(initial=-1)) + 1)


def sides(ends: ContactEnds) -> np.ndarray:
    """+1 at i, -1 at j, (E,): the sign with which "on i, relative to j" reads at an end."""
    sign = np.full(len(ends.contact), -1.0)
    sign[at_i(ends)] = 1.0
    return sign


def has_tangential_springs(ends: ContactEnds, snapshot: Snapshot) -> bool:
    """Whether contacts have spring elongations: columns ux, uy[, uz].

    A state without these columns has no such springs if every contact force is central (springs push sideways),
    and unknown ones otherwise: MissingColumn, as when an engine cannot tell some of them (NaN).
    """
    contacts = recorded_contacts(snapshot)
    if "ux" not in contacts:
        _require_central_forces(ends)
        return False
    u = vector(contacts, "u", snapshot)
    unknown = np.flatnonzero(np.isnan(u).any(axis=1))
    if unknown.size:
        raise MissingColumn(f"contacts.u is not known in {unknown.size} of {len(u)} rows")
    return True


def stiffness_column(snapshot: Snapshot, name: str, given: float | None) -> np.ndarray:
    """Stiffness "kn" or "kt" of each contact, (C,), N/m: the given one for all, else the column."""
    contacts = recorded_contacts(snapshot)
    return contacts[name] if given is None else np.full(contacts.rows, given)


def centre_distance(ends: ContactEnds) -> np.ndarray:
    """|l^ic| + |l^jc|, (E,), m: the bond that an end belongs to; at a wall |l^ic| alone."""
    size = ends.length
    return np.bincount(ends.contact, weights=size)[ends.contact] if size.size else size


def contact_deformation(ends: ContactEnds, overlap: np.ndarray, elongation: np.ndarray | None) -> np.ndarray:
    """Delta^pc = (|l^pc|/L^c)(overlap n^pc + u^pc), (E, dim), m, in the frame of the ends.

    overlap: (C,), m. elongation: u^pc (E, dim), m, of p relative to its partner (at j the reverse of what it is at
    i); None without tangential springs. overlap n + u is the elastic displacement of p relative to its
    partner at the contact: p has moved along n^pc, into the partner, by the overlap, and sideways by u.
    Each end takes the part |l|/L of it, L = |l^i| + |l^j|, all of it at a wall. Then Delta^pc = eps . l^pc
    holds exactly for an affine displacement -eps . x of particles of any sizes that do not turn; for equal
    ones the part is 1/2, the a - |l| of Laetzel, Luding, Herrmann, Granular Matter 2, 123 (2000).
    """
    moved = overlap[ends.contact][:, None] * ends.n
    if elongation is not None:
        moved = moved + elongation
    return (ends.length / centre_distance(ends))[:, None] * moved


def _require_central_forces(ends: ContactEnds) -> None:
    along = (ends.f * ends.n).sum(axis=1, keepdims=True) * ends.n
    tangential = np.linalg.norm(ends.f - along, axis=1).max(initial=0.0)
    if tangential > CENTRAL * np.linalg.norm(ends.f, axis=1).max(initial=0.0):
        raise MissingColumn("contacts has no column 'ux', yet some forces have a tangential part")
