"""What spins do at contacts in 3D: slip, relative rolling and twisting, and the sum of torques.

    v_t = v - v_n n - T x n,    T = a_i omega_i + a_j omega_j,    rolling = a* (omega_i - omega_j)
    torque on i: -a_i n x f_t - couple,                   torque on j: -a_j n x f_t + couple

Where the slip of a step is measured with the normal of its middle (`reference.kernel.conventions`), T grows by
dt/2 (T.n) (v - v_n n)/|d| before.
"""

from __future__ import annotations

import numpy as np

from reference.kernel.program.program import Program
from reference.kernel.program.space.contacts import SpaceContacts
from reference.kernel.program.space.nodes import SpaceNodes
from reference.kernel.program.vectors import cross, dot


def slip_and_rolling(
    p: Program, nodes: SpaceNodes, c: SpaceContacts, *, slips: bool, arms: np.ndarray | None, factors: np.ndarray | None
) -> None:
    """v_t if anything slips, with arms (2, P), None if the nodes carry R omega; rolling if there are factors, (2, P).

    rolling = factor_i s_i - factor_j s_j with what the nodes carry, s. Axis by axis, to stay in the cache.
    """
    turning, spins = c.tangents.work, c.ends_buffer("ends")
    if factors is not None:
        c.rolling = c.buffer("rolling", 3)
    for axis in range(3):
        p.effect("rotation")
        p.take(nodes.s[axis], c.ends, spins)
        if slips:
            _add_ends(p, c, spins, arms, out=turning[axis])
        if factors is not None:
            p.effect("relative rotation")
            p(np.multiply, spins[0], factors[0], out=c.a)
            p(np.multiply, spins[1], factors[1], out=c.b)
            p(np.subtract, c.b, c.a, out=c.b)
            p(np.multiply, c.b, c.touching, out=c.rolling[axis])
    p.effect("rotation")
    if slips:
        _slip(p, c, turning)


def _add_ends(p: Program, c: SpaceContacts, spins: np.ndarray, arms: np.ndarray | None, out: np.ndarray) -> None:
    """out = sum of arm times spin; with arms None of the spins."""
    if arms is None:
        p(np.add, *spins, out=out)
        return
    p(np.multiply, spins[0], arms[0], out=c.a)
    p(np.multiply, spins[1], arms[1], out=out)
    p(np.add, out, c.a, out=out)


def _slip(p: Program, c: SpaceContacts, turning: np.ndarray) -> None:
    """v_t = u - v_n n - turning x n, in the place of u."""
    c.v_t = c.u
    p(np.multiply, c.normal, c.v_n, out=c.z)
    p(np.subtract, c.u, c.z, out=c.v_t)
    if c.lag is not None:
        _turn_normals_back(p, c, turning)
    cross(p, turning, c.normal, c.a, out=c.z)
    p(np.subtract, c.v_t, c.z, out=c.v_t)
    p(np.multiply, c.v_t, c.touching, out=c.v_t)
    if c.smooth_pairs.start < c.smooth_pairs.stop:
        p.fill(c.v_t[:, c.smooth_pairs], 0.0)


def _turn_normals_back(p: Program, c: SpaceContacts, turning: np.ndarray) -> None:
    """turning += lag (turning.n) v_t/|d|, v_t being that of the centres still."""
    share, factor = c.a, c.b
    dot(p, turning, c.normal, c.z, out=share)
    p(np.subtract, c.radius_sum, c.overlap, out=factor)
    p(np.divide, c.lag, factor, out=factor)
    p(np.multiply, share, factor, out=share)
    p(np.multiply, c.v_t, share, out=c.z)
    p(np.add, turning, c.z, out=turning)


def rolling_velocity(p: Program, c: SpaceContacts) -> np.ndarray:
    """Return a* (omega_i - omega_j) x n."""
    velocity = c.buffer("rolling velocity", 3)
    cross(p, c.rolling, c.normal, c.a, out=velocity)
    return velocity


def twisting_velocity(p: Program, c: SpaceContacts, out: np.ndarray) -> None:
    """out = a* n.(omega_i - omega_j), (P,)."""
    dot(p, c.rolling, c.normal, c.z, out=out)


def across(p: Program, c: SpaceContacts, v: np.ndarray) -> np.ndarray:
    """Return v - (n.v) n."""
    part = c.buffer("part across", 3)
    dot(p, v, c.normal, c.z, out=c.a)
    p(np.multiply, c.normal, c.a, out=c.z)
    p(np.subtract, v, c.z, out=part)
    return part


def couple_of(p: Program, c: SpaceContacts, force: np.ndarray) -> None:
    """couple = a* n x f."""
    cross(p, c.normal, force, c.a, out=c.couple)
    p(np.multiply, c.couple, c.reduced_radius, out=c.couple)


def twist_by(p: Program, c: SpaceContacts, force: np.ndarray, *, add: bool) -> None:
    """couple = a* f n, or couple += that; force (P,) is used up."""
    p(np.multiply, force, c.reduced_radius, out=force)
    p(np.multiply, c.normal, force, out=c.z if add else c.couple)
    if add:
        p(np.add, c.couple, c.z, out=c.couple)


def sum_torques(p: Program, nodes: SpaceNodes, c: SpaceContacts, arms: np.ndarray | None, *, couple: bool) -> None:
    """Add the moments of shear (arms (2, P), or None without sliding) and the couples to the nodes."""
    if arms is None:
        p.effect("couples")
        _to_nodes(p, nodes, np.add, c.j, c.couple)
        _to_nodes(p, nodes, np.subtract, c.i, c.couple)
        return
    moment, of_end, signs = c.tangents.work, c.z, (np.add, np.subtract)
    cross(p, c.force, c.normal, c.a, out=moment)
    for index, arm, add in zip((c.j, c.i), arms, signs, strict=True):
        p(np.multiply, moment, arm, out=of_end)
        if couple:
            p.effect("couples")
            p(add, of_end, c.couple, out=of_end)
            p.effect("rotation")
        _to_nodes(p, nodes, np.add, index, of_end)


def _to_nodes(p: Program, nodes: SpaceNodes, add: np.ufunc, index: np.ndarray, values: np.ndarray) -> None:
    for axis in range(3):
        p.scatter(add, nodes.m[axis], index, values[axis])
