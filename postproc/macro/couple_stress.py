"""Couple stress: what the torques of contact forces, and contact couples, make on the scale of a cell."""

from __future__ import annotations

import numpy as np

from postproc.averaging.cells import Cells, divide
from postproc.macro.axial import cross, dyads
from postproc.macro.contact_ends import ContactEnds


def couple_stress(ends: ContactEnds, cells: Cells) -> np.ndarray:
    """M = -(1/V) sum_p sum_c w_V^p (l^pc x f^pc) (x) l^pc, N/m (2D per unit thickness: N).

    (K, dim) in 2D, component b the face's normal, couple about the axis out of the plane; (K, 3, 3) in 3D,
    component (axis of the couple, normal). l x f: torque of the contact force about the particle's
    centre; the minus as in the stress. The talk ("Macro (torque stiffness)") names M without a formula; this
    is that of Luding, Laetzel, Volk, Diebels, Herrmann, Comput. Methods Appl. Mech. Eng. 191, 21 (2001).
    Of a contact between equal particles both ends have one torque and opposite l, so they cancel inside a cell:
    expect a small, strongly fluctuating number.
    """
    return -cells.contact_density(ends, dyads(cross(ends.l, ends.f), ends.l))


def contact_couple_stress(ends: ContactEnds, cells: Cells, couple: np.ndarray) -> np.ndarray:
    """M^c = -(1/V) sum_p sum_c w_V^p m^pc (x) l^pc, shape, unit and sign of `couple_stress`.

    couple: m^pc, (E,) or (E, 3), N m, of the contact itself on the particle (rolling, torsion).
    Not in the talk, whose contacts carry no couples of their own; the whole is couple_stress plus this.
    """
    return -cells.contact_density(ends, dyads(couple, ends.l))


def torque_stiffness(couple_stress: np.ndarray, curvature: np.ndarray) -> np.ndarray:
    """mu l^2 = M.kappa/kappa.kappa, (K,), N (2D per unit thickness: N m): the talk's M/kappa.

    The talk divides tensors without saying how; this is the number that fits M = mu l^2 kappa best
    (least squares over components). Negative where they point apart. NaN where kappa is 0.
    """
    M, kappa = (a.reshape(len(a), -1) for a in (couple_stress, curvature))
    return divide((M * kappa).sum(axis=1), (kappa**2).sum(axis=1))
