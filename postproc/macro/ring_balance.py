"""What Newton's laws say of a steady ring, as sums over grains and contacts: exact in cells of any width.

Area averages of the stress smear a contact over its grain, so that profiles in cells narrower than a grain follow
the layers at a wall and leave a residual in the continuum's balances (`postproc.macro.equilibrium`) that is theirs and
not the flow's. The sums below have none: they are momentum and angular momentum themselves.
"""

from __future__ import annotations

import numpy as np

from postproc.averaging.cells import Cells
from postproc.geometry import centre, positions, ring_walls, vector
from postproc.macro.contact_ends import ContactEnds, contact_ends, recorded_contacts
from postproc.macro.springs import at_i
from postproc.snapshot import Snapshot


def net_force(ends: ContactEnds) -> np.ndarray:
    """F^p = sum_c f^pc, (N, dim), N, in the frame of the ends: what all contacts of a particle do to it."""
    return ends.sum_c(ends.f)


def momentum_rest(cells: Cells, force: np.ndarray, velocity: np.ndarray) -> np.ndarray:
    """r (1/V) sum_p w_V^p [F^p - m^p a^p], (K, 2), unit of a stress: what is left of the balance of momentum in rings.

    2D, polar frame. force: F^p of contacts and surroundings, velocity: v^p, both (N, 2) as (r, phi). Of the
    acceleration what a steady state keeps, a = (-v_phi^2/r, v_r v_phi/r); d v_r/dt and d v_phi/dt average to 0 over
    time. Components r and phi are the residuals of the talk's "Stress equilibrium",
    rho v_phi^2 - r d(sigma_rr)/dr - (sigma_rr - sigma_phiphi) and -r d(sigma_rphi)/dr - (sigma_rphi + sigma_phir), with
    minus the divergence of the stress replaced by what it stands for, the net force of the contacts per volume.
    """
    r = radius_of(cells.snapshot)
    v_r, v_phi = velocity.T
    steady = np.column_stack([-(v_phi**2), v_r * v_phi]) / r[:, None]
    mass = cells.snapshot.particles["mass"][:, None]
    return cells.coordinates["r"][:, None] * cells.density(force - mass * steady)


def torque_through(snapshot: Snapshot, radii: np.ndarray) -> np.ndarray:
    """Torque of what is inside circles about the rings' centre on what is outside, (K,), N m: 2 pi r^2 sigma_rphi h.

    sum x^c x f over contacts of a grain with its centre inside and one outside (f: on that outside); walls count by
    their radius. x^c: contact point from the centre. This is the stress by the method of planes (B. D. Todd,
    D. J. Evans, P. J. Daivis, Phys. Rev. E 52, 1627 (1995)) on circles: with torques of walls and surroundings it gives
    the rate of the angular momentum, orbits and spins, of the grains inside, so in a steady state it equals
    what enters at the inner wall. 2D; radii: (K,), m.
    """
    ends, contacts = contact_ends(snapshot), recorded_contacts(snapshot)
    middle = centre(snapshot)
    point = vector(contacts, "p", snapshot) - middle
    torque = point[:, 0] * contacts["fy"] - point[:, 1] * contacts["fx"]
    place = radius_of(snapshot)
    at, partner = place[ends.particle[at_i(ends)]], _partner_radius(snapshot, ends, place)
    circles = np.asarray(radii, dtype=np.float64)[:, None]
    outwards = (partner < circles) & (at >= circles)
    inwards = (at < circles) & (partner >= circles)
    return np.where(outwards, torque, 0.0).sum(axis=1) - np.where(inwards, torque, 0.0).sum(axis=1)


def sum_inside(snapshot: Snapshot, radii: np.ndarray, q: np.ndarray) -> np.ndarray:
    """Sum of a particle property (N,) over the centres inside circles about the rings' centre, (K,)."""
    return (radius_of(snapshot) < np.asarray(radii, dtype=np.float64)[:, None]) @ np.asarray(q, dtype=np.float64)


def torque_of(snapshot: Snapshot, force: np.ndarray) -> np.ndarray:
    """x^p x F^p about the rings' centre, (N,), N m, of forces (N, 2) in Cartesian components."""
    arm = positions(snapshot) - centre(snapshot)
    return arm[:, 0] * force[:, 1] - arm[:, 1] * force[:, 0]


def radius_of(snapshot: Snapshot) -> np.ndarray:
    """Distance of each particle from the rings' centre, (N,), m."""
    arm = positions(snapshot) - centre(snapshot)
    return np.hypot(arm[:, 0], arm[:, 1])


def _partner_radius(snapshot: Snapshot, ends: ContactEnds, place: np.ndarray) -> np.ndarray:
    """Where the j of each contact is, (C,), m: radius of its centre, or of the ring wall."""
    partner, j = ends.partner[at_i(ends)], recorded_contacts(snapshot)["j"]
    found = np.where(partner >= 0, place[partner], np.nan)  # of no ring: on neither side of any circle
    for wall in ring_walls(snapshot):
        found[j == -snapshot.walls["id"][wall]] = snapshot.walls["radius"][wall]
    return found
