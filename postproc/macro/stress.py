"""Stress tensors, full (not symmetrised), compression positive.

Component (alpha, beta): force along beta through a face with normal alpha. Units N/m^2; a 2D state
of thickness 1 m has its stress per unit thickness, N/m.
"""

from __future__ import annotations

import numpy as np

from postproc.averaging.cells import Cells, divide
from postproc.macro.contact_ends import ContactEnds, outer


def stress(ends: ContactEnds, cells: Cells) -> np.ndarray:
    """sigma = -(1/V) sum_p sum_c w_V^p l^pc f^pc, shape (K, dim, dim).

    l: from the particle's centre to the contact, f: force on the particle. The minus makes
    compression positive: a push from the right has l_x > 0, f_x < 0. Not symmetric unless the
    contact forces exert no torque on the particles of the cell. Source: the talk, "Averaging
    Stress"; Laetzel, Luding, Herrmann, Granular Matter 2, 123 (2000), section 4.
    """
    l, f = ends.l, ends.f  # noqa: E741
    return -cells.contact_density(ends, outer(l, f))


def kinetic_stress(velocity: np.ndarray, cells: Cells) -> np.ndarray:
    """sigma^k = (1/V) sum_p w_V^p m^p v'^p v'^p, shape (K, dim, dim), from velocities (N, dim) in the cells' frame.

    v' is the velocity relative to the cell's mean (by mass), so a mean shear inside a cell counts as
    fluctuation: keep cells small against it. NaN in a cell without particles. Add it to `stress`
    when a state moves. Source: the talk, "Stress tensor (dynamic)"; Goldhirsch, Granular Matter 12,
    239 (2010), the same with point weights.
    """
    m, v = cells.snapshot.particles["mass"], velocity
    rho, j = cells.density(m), cells.density(m[:, None] * v)
    return cells.density(m[:, None, None] * outer(v, v)) - divide(outer(j, j), rho)
