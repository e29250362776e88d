"""Velocity, its gradient, spin: the mean motion of a cell and how grains turn in it.

Rates are positive in extension, as in the talk (only stresses, overlaps and strains count compression positive);
what turns is positive counter-clockwise.
"""

from __future__ import annotations

import numpy as np

from postproc.averaging.cells import Cells, divide
from postproc.geometry import particle_volumes
from postproc.macro.axial import axial


def momentum_density(cells: Cells, velocity: np.ndarray) -> np.ndarray:
    """j = (1/V) sum_p w_V^p m^p v^p, (K, dim), kg/(m^2 s); velocity: (N, dim), m/s, in the cells' frame.

    Source: Goldhirsch, Granular Matter 12, 239 (2010), with the weights of the cells.
    """
    return cells.density(cells.snapshot.particles["mass"][:, None] * velocity)


def mean_velocity(cells: Cells, velocity: np.ndarray) -> np.ndarray:
    """v = j/rho = sum_p w m^p v^p / sum_p w m^p, (K, dim), m/s. NaN in an empty cell."""
    return divide(momentum_density(cells, velocity), cells.density(cells.snapshot.particles["mass"]))


def velocity_density(cells: Cells, velocity: np.ndarray) -> np.ndarray:
    """(1/V) sum_p w_V^p V^p v^p, (K, dim), m/s: Q^p = v^p, the talk's "Averaging Velocity".

    Over the volume fraction it is the mean velocity by volume, equal to that by mass for one material.
    """
    return cells.density(particle_volumes(cells.snapshot)[:, None] * velocity)


def velocity_gradient(cells: Cells, velocity: np.ndarray) -> np.ndarray:
    """L_ab = d v_a/d x_b of the mean velocity (by mass), (K, dim, dim), 1/s, covariant in the polar frame.

    In a ring L_phi,r = d v_phi/dr, L_r,phi = -v_phi/r. NaN where the cells cannot give it (one particle).
    """
    return cells.gradient(velocity, cells.snapshot.particles["mass"])


def strain_rate(gradient: np.ndarray) -> np.ndarray:
    """D = (L + L^t)/2, (K, dim, dim), 1/s, positive in extension.

    In a ring D_r,phi = (d v_phi/dr - v_phi/r)/2: the talk, "Velocity gradient".
    """
    return (gradient + gradient.swapaxes(-1, -2)) / 2.0


def rotation_rate(gradient: np.ndarray) -> np.ndarray:
    """W = curl v/2, (K,) in 2D, (K, 3) in 3D, rad/s: W_12 = (d v_2/d x_1 - d v_1/d x_2)/2.

    In a ring W_r,phi = (d v_phi/dr + v_phi/r)/2: the talk, "Rotations - spin density".
    """
    return axial(gradient.swapaxes(-1, -2))


def spin_density(cells: Cells, spin: np.ndarray) -> np.ndarray:
    """nu omega = (1/V) sum_p w_V^p V^p omega^p, (K,) in 2D, (K, 3) in 3D, rad/s.

    spin: omega^p, (N,) or (N, 3). The talk ("Averaging Rotations") prints a further sum over the contacts,
    which would multiply omega by the contact number; it is left out.
    """
    volume = particle_volumes(cells.snapshot)
    return cells.density(volume * spin if spin.ndim == 1 else volume[:, None] * spin)


def mean_spin(cells: Cells, spin: np.ndarray) -> np.ndarray:
    """omega = (nu omega)/nu, mean spin by volume, shape of `spin_density`, rad/s. NaN in an empty cell."""
    return divide(spin_density(cells, spin), cells.density(particle_volumes(cells.snapshot)))


def eigen_rotation(mean_spin: np.ndarray, rotation_rate: np.ndarray) -> np.ndarray:
    """omega* = omega - W, rad/s: how grains turn beyond what the mean motion turns them. Zero in a rigid rotation.

    Source: the talk, "Rotations - spin density".
    """
    return mean_spin - rotation_rate


def spin_gradient(cells: Cells, spin: np.ndarray) -> np.ndarray:
    """d omega/d x_b of the mean spin (by volume), (K, dim) in 2D, (K, 3, 3) in 3D, component (axis, b), rad/(m s).

    The rate of the kinematic curvature of a micropolar continuum; NaN where the cells cannot give it.
    """
    return cells.gradient(spin, particle_volumes(cells.snapshot))
