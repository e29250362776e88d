"""What spins do at contacts in 2D: slip, relative rolling, and the sum of torques.

    v_t -= a_i omega_i + a_j omega_j,    rolling = a* (omega_i - omega_j)
    torque on i: -a_i f_t - couple,      torque on j: -a_j f_t + couple
"""

from __future__ import annotations

import numpy as np

from reference.kernel.program.plane.contacts import PlaneContacts
from reference.kernel.program.plane.nodes import PlaneNodes
from reference.kernel.program.program import Program


def slip_and_rolling(
    p: Program, nodes: PlaneNodes, c: PlaneContacts, *, slips: bool, arms: np.ndarray | None, factors: np.ndarray | None
) -> None:
    """v_t if anything slips, with arms (2, P), None if the nodes carry R omega; rolling if there are factors, (2, P).

    rolling = factor_i s_i - factor_j s_j with what the nodes carry, s.
    """
    spins = c.ends_buffer("ends")
    p.effect("rotation")
    p.take(nodes.s, c.ends, spins)
    if slips:
        _slip(p, c, spins, arms)
    if factors is not None:
        c.rolling = c.buffer("rolling")
        p.effect("relative rotation")
        p(np.multiply, spins[0], factors[0], out=c.a)
        p(np.multiply, spins[1], factors[1], out=c.b)
        p(np.subtract, c.b, c.a, out=c.b)
        p(np.multiply, c.b, c.touching, out=c.rolling)


def _slip(p: Program, c: PlaneContacts, spins: np.ndarray, arms: np.ndarray | None) -> None:
    c.v_t, turning = c.buffer("v_t"), spins
    if arms is not None:
        turning = c.a, c.b
        p(np.multiply, spins[0], arms[0], out=c.a)
        p(np.multiply, spins[1], arms[1], out=c.b)
    p(np.add, *turning, out=c.a)
    p(np.multiply, c.a, c.touching, out=c.a)
    p(np.subtract, c.u.imag, c.a, out=c.v_t)
    if c.smooth_pairs.start < c.smooth_pairs.stop:
        p.fill(c.v_t[c.smooth_pairs], 0.0)


def rolling_velocity(p: Program, c: PlaneContacts) -> np.ndarray:
    """Return a* (omega_i - omega_j) x n along t: the number that `rolling` is about z."""
    del p
    return c.rolling


def across(p: Program, c: PlaneContacts, v: np.ndarray) -> np.ndarray:
    """Return v: spins are at right angles to every normal."""
    del p, c
    return v


def couple_of(p: Program, c: PlaneContacts, force: np.ndarray) -> None:
    """couple = a* n x f: n x t is the unit vector along z."""
    p(np.multiply, force, c.reduced_radius, out=c.couple)


def sum_torques(p: Program, nodes: PlaneNodes, c: PlaneContacts, arms: np.ndarray | None, *, couple: bool) -> None:
    """Add the moments of shear (arms (2, P), or None without sliding) and the couples to the nodes."""
    if arms is None:
        p.effect("couples")
        p.scatter(np.add, nodes.m, c.j, c.couple)
        p.scatter(np.subtract, nodes.m, c.i, c.couple)
        return
    moments = c.ends_buffer("ends")
    for arm, moment, add in zip(arms, moments, (np.add, np.subtract), strict=True):
        p(np.multiply, c.shear, arm, out=moment)
        if couple:
            p.effect("couples")
            p(add, moment, c.couple, out=moment)
            p.effect("rotation")
    p.scatter(np.add, nodes.m, c.ends.reshape(-1), moments.reshape(-1))
