"""Equilibrium of the steady, axisymmetric ring: what is left of its two balances, and its torque.

Stresses are compression positive, first index the face's normal, second the force, so that the talk's
equations ("Stress equilibrium", tension positive) change the sign of every stress but not of inertia::

    0 = rho v_phi^2 - r d(sigma_rr)/dr - (sigma_rr - sigma_phiphi) + r b_r
    0 = -r d(sigma_rphi)/dr - (sigma_rphi + sigma_phir) + r b_phi

with sigma the total stress (static and dynamic) and b the force density of the bottom on the grains.
The second one times r is the balance of torque::

    d(r^2 sigma_rphi)/dr = r^2 b_phi + r (sigma_rphi - sigma_phir)

whose last term is what goes into the spins: zero for a symmetric stress.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True, kw_only=True)
class RingProfile:
    """A ring's profile, means over time in K >= 3 cells in order of radius.

    r: (K,), m. stress: (K, 2, 2) total, polar, N/m (2D per unit thickness) or Pa.
    error: (K, 2, 2) standard errors of it, or None.
    density: (K,) rho = mass per cell volume. v_phi: (K,), m/s.
    drag: (K, 2) mean force density (b_r, b_phi) of the bottom on the grains, opposite to their motion
    for a drag; None when there is none.
    """

    r: np.ndarray
    stress: np.ndarray
    density: np.ndarray
    v_phi: np.ndarray
    error: np.ndarray | None = None
    drag: np.ndarray | None = None


@dataclass(frozen=True, kw_only=True)
class Residual:
    """What is left of a balance in each cell (K,), unit of a stress, and its standard error (NaN: not known)."""

    value: np.ndarray
    error: np.ndarray


def radial_residual(profile: RingProfile) -> Residual:
    """rho v_phi^2 - r d(sigma_rr)/dr - (sigma_rr - sigma_phiphi) + r b_r, zero in equilibrium.

    The derivative is a difference of second order (numpy.gradient, also at the ends), so a residual is
    as good as the profile is smooth over three cells. Errors count stresses of different cells as
    independent; neighbours that share discs are not quite, and their differences are then less uncertain.
    """
    rr, pp = np.array([1.0, 0.0, 0.0, 0.0]), np.array([0.0, 0.0, 0.0, 1.0])
    inertia = profile.density * profile.v_phi**2
    return _residual(profile, inertia, through=0, beside=rr - pp, axis=0)


def angular_residual(profile: RingProfile) -> Residual:
    """-r d(sigma_rphi)/dr - (sigma_rphi + sigma_phir) + r b_phi; as `radial_residual`."""
    return _residual(profile, np.zeros(len(profile.r)), through=1, beside=np.array([0.0, 1.0, 1.0, 0.0]), axis=1)


def _residual(profile: RingProfile, inertia: np.ndarray, *, through: int, beside: np.ndarray, axis: int) -> Residual:
    """Combine inertia - (r d/dr sigma[through] + beside . sigma) + r b[axis], with errors."""
    r = profile.r
    slope = r[:, None] * np.gradient(np.eye(len(r)), r, axis=0, edge_order=2)
    # weight[k, m, c] of component c of cell m in the residual of cell k
    weight = -np.eye(len(r))[:, :, None] * beside
    weight[:, :, through] -= slope
    stress = profile.stress.reshape(len(r), 4)
    drag = 0.0 if profile.drag is None else r * profile.drag[:, axis]
    error = np.full(len(r), np.nan)
    if profile.error is not None:
        error = np.sqrt(np.einsum("kmc,mc->k", weight**2, profile.error.reshape(len(r), 4) ** 2))
    return Residual(value=inertia + np.einsum("kmc,mc->k", weight, stress) + drag, error=error)


@dataclass(frozen=True, kw_only=True)
class TorqueBalance:
    """Torque of the inside on the outside of each ring (K,), N m (2D of thickness 1: per unit thickness).

    measured: 2 pi r^2 sigma_rphi h. expected: what the inner wall gives, plus what bottom and spins add on the
    way to r. inner, outer: torque of the inner wall on the grains, and of the grains on the outer wall.
    outer_expected: what should arrive there.
    """

    r: np.ndarray
    measured: np.ndarray
    error: np.ndarray
    expected: np.ndarray
    inner: float
    outer: float
    outer_expected: float


def torque_balance(
    profile: RingProfile, *, inner_torque: float, outer_torque: float,
    inner_radius: float, outer_radius: float, thickness: float = 1.0,
) -> TorqueBalance:
    """Compare 2 pi r^2 sigma_rphi with the torques on both walls.

    inner_torque, outer_torque: of the grains on the walls (column `torque` of the walls), so that in steady
    shear without drag outer = -inner = 2 pi r^2 sigma_rphi, positive when the inner wall drives counter-
    clockwise: sigma_rphi is the flux of momentum along phi through r, outwards.
    Sources between inner wall and r: 2 pi h int (r^2 b_phi + r (sigma_rphi - sigma_phir)) dr, by the
    trapezoidal rule through the cells; the first and last value hold up to the walls.
    """
    r, s = profile.r, profile.stress
    source = r * (s[:, 0, 1] - s[:, 1, 0])
    if profile.drag is not None:
        source = source + r**2 * profile.drag[:, 1]
    ring = 2.0 * np.pi * thickness
    grid = np.concatenate([[inner_radius], r, [outer_radius]])
    values = np.concatenate([source[:1], source, source[-1:]])
    gained = ring * np.concatenate([[0.0], np.cumsum(np.diff(grid) * (values[1:] + values[:-1]) / 2.0)])
    error = np.full(len(r), np.nan) if profile.error is None else ring * r**2 * profile.error[:, 0, 1]
    return TorqueBalance(
        r=r, measured=ring * r**2 * s[:, 0, 1], error=error, expected=-inner_torque + gained[1:-1],
        inner=-inner_torque, outer=outer_torque, outer_expected=float(-inner_torque + gained[-1]),
    )
