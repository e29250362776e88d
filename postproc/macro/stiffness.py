"""Stiffness tensor of the contact network, its anisotropy and its isotropic part.

Every bond counts once, with its full length between centres; the elastic moduli of the triangular and the
square lattice settle it (literature: triangular, C_1111 = sqrt(3)/4 (3 k_n + k_t)).
"""

from __future__ import annotations

from itertools import combinations_with_replacement, product

import numpy as np

from postproc.averaging.cells import Cells, divide
from postproc.macro.contact_ends import ContactEnds
from postproc.macro.springs import centre_distance
from postproc.macro.tensors import Principal
from postproc.snapshot import MissingColumn


def normal_stiffness(ends: ContactEnds, cells: Cells, kn: np.ndarray) -> np.ndarray:
    """C^n_abcd = (1/V) sum_c k_n L^2 n_a n_b n_c n_d, (K, dim, dim, dim, dim), unit of a stress (2D: maybe N/m).

    kn: (C,), N/m. L: distance of the centres (at a wall: of centre and contact); an end counts its part
    |l^pc| L of L^2, so that a contact between two cells is shared like its stress.
    The talk ("Stiffness tensor") writes (1/V) sum k a^2 n n n n with each contact seen from both of its
    particles of radius a: half of this with a^2; the factor 2 makes it the modulus of springs k_n
    between centres. Small strains of the present contacts, without prestress and opening: an upper bound.
    Source: the talk; Luding, Int. J. Sol. Struct. 41, 5821 (2004).
    """
    return _fourth_moment(ends, cells, kn)


def tangential_stiffness(ends: ContactEnds, cells: Cells, kt: np.ndarray) -> np.ndarray:
    """C^t_abcd = (1/V) sum_c k_t L^2 sym(n_a t_b n_c t_d), shape, unit and ends as `normal_stiffness`.

    kt: (C,), N/m. sym: over a <-> b and c <-> d and, in 3D, summed over both tangents: the tensor of a sample whose
    particles turn with its mean rotation, without sliding. By sum_t t t = 1 - n n it is the fourth moment's
    contraction B_ac = M_acbb times unity, symmetrised, minus M.
    """
    M = _fourth_moment(ends, cells, kt)
    return _symmetric_with_unity(np.einsum("kabcc->kab", M)) - M


def _fourth_moment(ends: ContactEnds, cells: Cells, k: np.ndarray) -> np.ndarray:
    """(1/V) sum_c k L^2 n n n n; only components with sorted indices are summed."""
    n, dim = ends.n, cells.snapshot.dimension
    weight = ends.length * centre_distance(ends) * k[ends.contact]
    pair = {(a, b): n[:, a] * n[:, b] for a, b in combinations_with_replacement(range(dim), 2)}
    kinds = list(combinations_with_replacement(range(dim), 4))
    columns = np.stack([weight * pair[kind[:2]] * pair[kind[2:]] for kind in kinds], axis=1)
    place = [kinds.index(tuple(sorted(indices))) for indices in product(range(dim), repeat=4)]
    return cells.contact_density(ends, columns)[:, place].reshape(-1, dim, dim, dim, dim)


def _symmetric_with_unity(B: np.ndarray) -> np.ndarray:
    """(B_ac d_bd + B_ad d_bc + B_bc d_ad + B_bd d_ac)/4."""
    one = np.eye(B.shape[-1])
    terms = ("kac,bd->kabcd", "kad,bc->kabcd", "kbc,ad->kabcd", "kbd,ac->kabcd")
    return sum(np.einsum(term, B, one) for term in terms) / 4.0


def voigt(C: np.ndarray) -> np.ndarray:
    """Components C_abcd by pairs of indices in the order 11, 22[, 33, 23, 13], 12: (K, 3, 3) or (K, 6, 6).

    Plain components, no factors 2.
    """
    pairs = VOIGT[C.shape[-1]]
    return np.stack([np.stack([C[:, a, b, c, d] for c, d in pairs], axis=1) for a, b in pairs], axis=1)


VOIGT = {2: ((0, 0), (1, 1), (0, 1)), 3: ((0, 0), (1, 1), (2, 2), (1, 2), (0, 2), (0, 1))}


def stiffness_anisotropy(C: np.ndarray) -> np.ndarray:
    """C_D = (C_1111 - C_2222)/(C_1111 + C_2222), (K,), with 1 and 2 the first two axes of the frame.

    Negative where the sample is stiffer along the second axis, such as y in vertical compression (the talk counts
    that as positive). Source: the talk, "An-isotropy". NaN without contacts.
    """
    first, second = C[:, 0, 0, 0, 0], C[:, 1, 1, 1, 1]
    return divide(first - second, first + second)


def principal_stiffness_anisotropy(C: np.ndarray, axes: Principal) -> np.ndarray:
    """C_D >= 0 or < 0 with axis 1 the major direction of `axes` (K) and 2 normal to it, 2D, (K,).

    axes: parts of C_abcc (`directional_stiffness`), so that it does not depend on the frame. 0 where there is no
    major direction but a stiffness (the network is isotropic up to second order).
    """
    if C.shape[-1] != 2:
        raise MissingColumn("the anisotropy along principal axes needs a 2D state")
    n = axes.major
    t = np.stack([-n[:, 1], n[:, 0]], axis=1)
    along, across = (np.einsum("kabcd,ka,kb,kc,kd->k", C, e, e, e, e) for e in (n, t))
    isotropic = np.isnan(n).any(axis=1) & (C[:, 0, 0, 0, 0] + C[:, 1, 1, 1, 1] > 0)
    return np.where(isotropic, 0.0, divide(along - across, along + across))


def directional_stiffness(C: np.ndarray) -> np.ndarray:
    """C_abcc/dim, (K, dim, dim): stress per strain of an isotropic compression; its deviator couples the two."""
    return np.einsum("kabcc->kab", C) / C.shape[-1]


def contact_bulk_modulus(C: np.ndarray) -> np.ndarray:
    """K = C_aabb/dim^2, (K,): pressure over volume strain of an affine isotropic compression."""
    return np.einsum("kaabb->k", C) / C.shape[-1] ** 2


def contact_shear_modulus(C: np.ndarray) -> np.ndarray:
    """G = (C_abab - C_aabb/dim)/((dim - 1)(dim + 2)), (K,): the mean over all directions of shear.

    For an isotropic tensor C_abcd = lambda d_ab d_cd + mu (d_ac d_bd + d_ad d_bc) it is mu.
    """
    dim = C.shape[-1]
    return (np.einsum("kabab->k", C) - np.einsum("kaabb->k", C) / dim) / ((dim - 1) * (dim + 2))
