"""Elastic strain from contacts, and the stiffnesses that stress and strain imply."""

from __future__ import annotations

import numpy as np

from postproc.averaging.cells import Cells, divide
from postproc.macro.axial import cross, dyads
from postproc.macro.contact_ends import ContactEnds, outer
from postproc.macro.tensors import Principal
from postproc.sums import lengths

ROUND_OFF = 1e-12
"""Sideways part of a contact's deformation below which it counts as normal."""

SPANS = 1e-12
"""Least over largest principal value of sum l l below which branch vectors do not span the space (round-off)."""


def branch_moments(ends: ContactEnds, cells: Cells) -> np.ndarray:
    """(1/V) sum_pc w_V^p l^pc (x) l^pc, (K, dim, dim): what least squares over branch vectors divide by."""
    return cells.contact_density(ends, outer(ends.l, ends.l))


def elastic_strain(
    ends: ContactEnds, cells: Cells, deformation: np.ndarray, moments: np.ndarray
) -> np.ndarray:
    """eps = (sum_pc Delta^pc (x) l^pc) . (sum_pc l^pc (x) l^pc)^-1, (K, dim, dim), compression positive.

    Sums run over particles and contacts of a cell with weights w_V^p. It minimises S = sum (Delta - eps . l)^2, the
    talk's condition ("Averaging Deformations"). deformation: Delta^pc (E, dim) of `springs.contact_deformation`;
    moments: `branch_moments`. Component (a, b): minus d u_a/d x_b of the elastic displacement u, from
    the state in which no contact is deformed. Not symmetric: its antisymmetric part says how far
    particles have turned beyond the sample while their springs held.
    The talk prints (sum l Delta) . F^-1 with the fabric F, the same for discs of one size; read literally for
    others it does not return an affine strain. NaN where branch vectors do not span the space.
    """
    return _times_inverse(cells.contact_density(ends, outer(deformation, ends.l)), moments)


def elastic_curvature(
    ends: ContactEnds, cells: Cells, deformation: np.ndarray, moments: np.ndarray
) -> np.ndarray:
    """kappa = (sum_pc theta^pc (x) l^pc) . (sum_pc l^pc (x) l^pc)^-1 with theta^pc = l^pc x Delta^pc/|l^pc|^2.

    (K, dim) in 2D, component b; (K, 3, 3) in 3D, component (axis, b); 1/m; sign as the strain's (minus a gradient).
    theta: angle by which a contact is deformed as seen from its particle. The same least squares as for
    the strain, with l x Delta in place of Delta; after Luding, Laetzel, Volk, Diebels, Herrmann, Comput.
    Methods Appl. Mech. Eng. 191, 21 (2001), whose 1/l^2 is taken from the unit that the talk's
    "mu l^2 = M/kappa" asks for. Both ends of a contact of equal particles have one theta and opposite l:
    inside a cell they cancel, and kappa lives on differences of size, on walls and on the cell's border.
    Deformations along l up to round-off count as such, so that contacts without sideways springs give 0.
    """
    length, size = ends.length, lengths(deformation)
    turned = cross(ends.l, deformation)
    sideways = np.abs(turned) if turned.ndim == 1 else np.linalg.norm(turned, axis=1)
    angle = np.where(sideways > ROUND_OFF * length * size, 1.0, 0.0) / length**2
    theta = turned * (angle if turned.ndim == 1 else angle[:, None])
    return _times_inverse(cells.contact_density(ends, dyads(theta, ends.l)), moments)


def bulk_stiffness(stress: Principal, strain: Principal) -> np.ndarray:
    """E = tr sigma/tr eps, (K,), unit of the stress: the talk's "Macro (bulk modulus)". NaN where tr eps is 0."""
    return divide(stress.isotropic, strain.isotropic)


def shear_stiffness(stress: Principal, strain: Principal) -> np.ndarray:
    """G = dev sigma/dev eps, (K,), unit of the stress; deviators as in `tensors.Principal`, both >= 0.

    The talk's "Macro (shear modulus)": sizes only, whether or not the directions agree. An isotropic elastic
    body has 2 G_elastic here. NaN where dev eps is 0.
    """
    return divide(stress.deviator, strain.deviator)


def _times_inverse(mixed: np.ndarray, moments: np.ndarray) -> np.ndarray:
    """mixed (K, ..., dim) . moments^-1 (K, dim, dim), NaN where the moments are singular."""
    result = np.full(mixed.shape, np.nan)
    sizes = np.linalg.eigvalsh(moments)
    good = (sizes[:, -1] > 0) & (sizes[:, 0] > SPANS * sizes[:, -1])
    inverse = np.linalg.inv(moments[good])
    result[good] = np.einsum("k...b,kbc->k...c", mixed[good], inverse)
    return result
