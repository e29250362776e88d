"""Fabric tensors: how contacts are oriented, and how many there are."""

from __future__ import annotations

import numpy as np

from postproc.averaging.cells import Cells
from postproc.geometry import particle_volumes
from postproc.macro.contact_ends import ContactEnds, outer


def fabric(ends: ContactEnds, cells: Cells) -> np.ndarray:
    """F = (1/V) sum_p w_V^p V^p sum_c n^pc n^pc, shape (K, dim, dim), dimensionless.

    Its trace is (1/V) sum_p w_V^p V^p C^p: nu C for particles of one size, the contact number
    density weighted by particle volume. F^p = sum_c n n is its value on one particle.
    Source: the talk, "Averaging Fabric".
    """
    n, V_p = ends.n, particle_volumes(cells.snapshot)
    return cells.contact_density(ends, V_p[ends.particle, None, None] * outer(n, n))


def contact_fabric(ends: ContactEnds, cells: Cells) -> np.ndarray:
    """<n n> = sum_p w sum_c n n / sum_p w C^p, shape (K, dim, dim); trace 1.

    Counted from the particles like C: a contact between two particles of the cell enters twice, one
    with a wall once. In a periodic box it is the tensor (1/N_c) sum_c n n of Oda and Satake.
    NaN in a cell without contacts.
    """
    return cells.contact_mean(ends, outer(ends.n, ends.n))


def contact_number_density(ends: ContactEnds, cells: Cells) -> np.ndarray:
    """(1/V) sum_p w_V^p sum_c s^pc, shape (K,), contacts per volume, 1/m^3 (2D per unit thickness: 1/m^2).

    Each contact counts once: s = 1/2 at the ends of a contact of particles, 1 at a wall. What the talk calls
    contact number density is tr F, per particle volume: `fabric`.
    """
    return cells.contact_density(ends, ends.share)


SHIELDING = {2: np.sqrt(3.0) / np.pi, 3: 1.0 / (4.0 * np.sqrt(3.0) * (1.0 - np.sqrt(3.0) / 2.0))}
"""d ln C(a)/d ln a at the mean size: how much more contacts a larger particle has, see `polydispersity`."""


def polydispersity(cells: Cells) -> np.ndarray:
    """g_2 (2D) or g_3 (3D) = 1 + B (<a^(dim+1)>/(<a> <a^dim>) - 1), shape (K,); 1 for particles of one size.

    tr F = g nu C: large particles have more contacts and more volume. Neighbours of the mean size <a> shield
    on a particle of size a an angle (3D: solid angle) Omega(a), and C(a) ~ 1/Omega(a); with V^p as weight
    g = <V C>/(<V> <C>), and with C(a) to first order in a/<a> - 1 the formula above, B = sqrt(3)/pi in 2D, 1.077 in 3D.
    Derived here; against C(a) in full it is 3e-4 (3D: 1e-3) off for radii evenly in 1 to 3. After Laetzel, Luding,
    Herrmann, Granular Matter 2, 123 (2000), and Shaebani, Madadi, Luding, Wolf, Phys. Rev. E 85, 011301 (2012).
    A mean field: `fabric_trace`/(nu C) is the measured value. NaN in an empty cell.
    """
    dim = cells.snapshot.dimension
    a = cells.snapshot.particles["radius"]
    moments = cells.mean(np.stack([a, a**dim, a ** (dim + 1)], axis=1))
    return 1.0 + SHIELDING[dim] * (moments[:, 2] / (moments[:, 0] * moments[:, 1]) - 1.0)


def corrected_fabric(fabric: np.ndarray, polydispersity: np.ndarray) -> np.ndarray:
    """F/g, shape (K, dim, dim): its trace is nu C as if all particles were of one size. See `polydispersity`."""
    return fabric / polydispersity[:, None, None]
