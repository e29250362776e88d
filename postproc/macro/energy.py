"""Kinetic energy of particles, elastic energy of contacts."""

from __future__ import annotations

import numpy as np

from postproc.averaging.cells import Cells
from postproc.geometry import vector
from postproc.macro.contact_ends import ContactEnds, recorded_contacts
from postproc.macro.springs import has_tangential_springs


def translational_energy(cells: Cells) -> np.ndarray:
    """sum_p w m v^2/2, J, shape (K,)."""
    particles = cells.snapshot.particles
    v = vector(particles, "v", cells.snapshot)
    return cells.total(particles["mass"] * (v**2).sum(axis=1) / 2.0)


def rotational_energy(cells: Cells) -> np.ndarray:
    """sum_p w I omega^2/2, J, shape (K,); in 2D omega has the z component only."""
    particles = cells.snapshot.particles
    omega = particles.vector(*(("wz",) if cells.snapshot.dimension == 2 else ("wx", "wy", "wz")))
    return cells.total(particles["inertia"] * (omega**2).sum(axis=1) / 2.0)


def normal_elastic_energy(ends: ContactEnds, cells: Cells, kn: float | None = None) -> np.ndarray:
    """sum_c kn overlap^2/2 of linear normal springs, J, shape (K,).

    Each particle holds half the energy of its contacts with particles and all of those with walls,
    so that cells that cover the sample add up to its energy. kn: N/m for all contacts; without it,
    the column kn. Wrong for springs that are not linear (Hertz: 2/5 of force times overlap).
    """
    contacts = recorded_contacts(cells.snapshot)
    stiffness = contacts["kn"] if kn is None else kn
    return _held_by_particles(stiffness * contacts["overlap"] ** 2 / 2.0, ends, cells)


def tangential_elastic_energy(ends: ContactEnds, cells: Cells, kt: float | None = None) -> np.ndarray:
    """sum_c kt u^2/2 of linear tangential springs, J, shape (K,), shared like the normal energy.

    u is the spring elongation, columns ux, uy[, uz]. A state without these columns has no such
    energy if every contact force is central (springs push sideways), and an unknown one otherwise;
    with kt = 0 it is known to have none.
    """
    contacts = recorded_contacts(cells.snapshot)
    if kt == 0 or not has_tangential_springs(ends, cells.snapshot):
        return cells.total(np.zeros(ends.count))
    u = vector(contacts, "u", cells.snapshot)
    stiffness = contacts["kt"] if kt is None else kt
    return _held_by_particles(stiffness * (u**2).sum(axis=1) / 2.0, ends, cells)


def _held_by_particles(energy: np.ndarray, ends: ContactEnds, cells: Cells) -> np.ndarray:
    """Sum energies of contacts (C,) over the particles of each cell."""
    return cells.total(ends.sum_c(ends.share * energy[ends.contact]))
