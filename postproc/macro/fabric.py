"""Fabric tensors: how contacts are oriented, and how many there are."""

from __future__ import annotations

import numpy as np

from postproc.averaging.cells import Cells, divide
from postproc.geometry import particle_volumes
from postproc.macro.contact_ends import ContactEnds, outer


def fabric(ends: ContactEnds, cells: Cells) -> np.ndarray:
    """F = (1/V) sum_p w_V^p V^p sum_c n^pc n^pc, shape (K, dim, dim), dimensionless.

    Its trace is (1/V) sum_p w_V^p V^p C^p: nu C for particles of one size, the contact number
    density weighted by particle volume. F^p = sum_c n n is its value on one particle.
    Source: the talk, "Averaging Fabric".
    """
    n, V_p = ends.n, particle_volumes(cells.snapshot)
    return cells.density(V_p[:, None, None] * ends.sum_c(outer(n, n)))


def contact_fabric(ends: ContactEnds, cells: Cells) -> np.ndarray:
    """<n n> = sum_p w sum_c n n / sum_p w C^p, shape (K, dim, dim); trace 1.

    Counted from the particles like C: a contact between two particles of the cell enters twice, one
    with a wall once. In a periodic box it is the tensor (1/N_c) sum_c n n of Oda and Satake.
    NaN in a cell without contacts.
    """
    n = ends.n
    contact_number = cells.total(ends.sum_c(np.ones(len(n))))
    return divide(cells.total(ends.sum_c(outer(n, n))), contact_number)
