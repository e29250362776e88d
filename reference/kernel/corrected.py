"""A second-order scheme: velocity Verlet whose contacts begin and end within the step, not at its end.

Plain velocity Verlet with half-step velocities in the forces is of first order as soon as there is a dashpot or
friction. Here, for a step from n to n + 1:

1. Velocity-dependent forces see the predicted velocities v(n+1/2) + dt/2 a(n), spins likewise.
2. Tangential springs are stretched by the trapezoid dt/2 (u(n) + u(n+1)) of the slip velocity u.
3. A contact that begins (gap delta_0 < 0 to overlap delta_1 > 0) was there for the part
   theta = delta_in/|delta_1 - delta_0| of the step, delta_in the overlap; its spring is stretched over theta dt only.
   A contact that ends was there for theta likewise, delta_in the overlap before.
4. The two half kicks take the force of the step to be half its value at the end; in the part theta it grew like
   f_el ~ s^p and f_d ~ s^q (elastic part, dashpot; s the time in contact), tangential like the dashpot of its law.
   The velocities are given once the difference of the impulses, J = dt [c(p) f_el n + c(q) f_d n + c f_t], with the
   torques of its tangential part. c(q) = theta - 1/2 for a force that jumps (q = 0) and (theta - 1)/2 for a
   linear one; for broken powers, whose sums miss more than one step's worth, see `missed`. f_t goes with f_n where it
   slides, else with a dashpot: c(0).
   With clipped attraction a force ends continuously: only beginnings are corrected.

Second order holds where forces are smooth between those events: no attraction by a dashpot (it ends in a jump of the
Coulomb limit through zero: first order remains), no adhesion. A contact that slides from its first touch, its
tangential dashpot above the limit of a force that begins at zero, has no smooth beginning either: first order.
`NormalLaw.onset` of a law tells p and q, or that the scheme corrects nothing for it; `Law.first_order` says where and
why order two is not reached. Such laws run in the scheme all the same; rolling, torsion, plastic and DMT contacts by
this evaluation only. Momentum and angular momentum are kept to round-off. The corrections are not symplectic: an
undamped gas of discs at dt = t_c/50 changed its energy by 3e-8 a step (6e-4 in 2e4 steps, measured), and where
undamped friction springs last it grows: in a lattice with k_t = 0.8 k_n by 0.77 in 8000 such steps, by 0.02 at half the
step. Such runs are stopped, or say so (`reference.kernel.energy_watch`); where energy must not drift, take the
leapfrog.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import partial

import numpy as np

from reference.kernel.interactions import Forces, Interaction
from reference.kernel.laws.contact import Touching
from reference.kernel.model import Model
from reference.kernel.neighbours import branch_vectors
from reference.kernel.simulation import Simulation
from reference.kernel.vectors import dot, norm, torque_cross


@dataclass(frozen=True, kw_only=True)
class _Before:
    """What an interaction was when the step began: keys (M,) of its contacts in rising order, and their forces."""

    x: np.ndarray
    keys: np.ndarray
    forces: Forces

    @classmethod
    def of(cls, x: np.ndarray, interaction: Interaction) -> _Before:
        forces = interaction.last
        return cls(x=x, keys=_keys(forces.contact, x.shape[1]), forces=forces)

    def find(self, keys: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return where `keys` stood, (M,), and which of them did."""
        if not len(self.keys):
            return np.zeros(len(keys), np.intp), np.zeros(len(keys), bool)
        place = np.minimum(np.searchsorted(self.keys, keys), len(self.keys) - 1)
        return place, self.keys[place] == keys


class CorrectedSimulation(Simulation):
    """`Simulation` with the scheme of the module; the same face."""

    def advance(self, steps: int = 1) -> None:
        """Make steps of dt."""
        for _ in range(steps):
            s = self.state
            places = s.x.copy()
            before = [_Before.of(places, k) for k in self.interactions]
            force, torque = s.force.copy(), None if s.torque is None else s.torque.copy()
            self._kick()
            self._drift()
            self.walls.move()
            self._turn_rings()
            self.renew_candidates()
            self._kick()
            self.walls.predict()
            self._evaluate_with(before)
            self.refuse_what_laws_cannot_tell(places)
            self._exchange_kick(force, torque)
            self.walls.replace_kick()
            for interaction, old in zip(self.interactions, before, strict=True):
                self._correct(interaction, old)
            self.walls.write(s)

    def _evaluate_with(self, before: list[_Before]) -> None:
        for interaction, old in zip(self.interactions, before, strict=True):
            interaction.prepare = partial(self._prepared, interaction, old)
        self.evaluate(advance=True)

    def _prepared(self, interaction: Interaction, old: _Before, contact: Touching) -> Touching:
        """Return the contact with its mean slip velocity: (u(n) + u(n+1))/2, theta u(n+1) where it begins."""
        if contact.v_t is None or interaction.sliding is None:
            return contact
        place, known = old.find(_keys(contact, old.x.shape[1]))
        mean = 0.5 * contact.v_t
        if old.forces.contact.v_t is not None and known.any():
            slip = old.forces.contact.v_t[:, place[known]]
            n = contact.n[:, known]
            mean[:, known] += 0.5 * turned(slip, n)
        new = ~known
        gap, _ = self._overlap_at(interaction, contact.i[new], contact.j[new], old.x)
        mean[:, new] = share_in_contact(contact.overlap[new], gap) * contact.v_t[:, new]
        return replace(contact, mean_v_t=mean)

    def _overlap_at(self, interaction: Interaction, i, j, x) -> tuple[np.ndarray, np.ndarray]:
        """Return overlaps, negative for gaps, (K,), and normals, (dim, K), at the places x."""
        s = self.state
        if interaction.walls is None:
            branch = branch_vectors(self.model, x, i, j)
            distance = norm(branch)
            return s.radius[i] + s.radius[j] - distance, branch / distance
        normal = s.wall_normal[:, j - self.model.particle_count]
        return s.radius[i] - dot(x[:, i] - x[:, j], normal), normal

    def _exchange_kick(self, force: np.ndarray, torque: np.ndarray | None) -> None:
        """Replace the predicted half kick of the old forces by that of the new ones."""
        s, p, half = self.state, self._particles, 0.5 * self.model.dt
        s.v[:, p] += half * (s.force - force)[:, p] * self._inverse_mass
        if torque is not None:
            s.spin[:, p] += half * (s.torque - torque)[:, p] * self._inverse_inertia

    # --- the impulses of contacts that begin or end ----------------------------------------------

    def _correct(self, interaction: Interaction, old: _Before) -> None:
        """Give the partners of contacts that began or ended in the step what the two half kicks missed."""
        if interaction.normal.onset is None:
            return
        now = interaction.last
        keys = _keys(now.contact, old.x.shape[1])
        _, known = old.find(keys)
        self._impulse(interaction, now, np.flatnonzero(~known), old.x)
        if interaction.normal.attraction == "clipped":
            return
        ended = np.flatnonzero(~np.isin(old.keys, keys))
        self._impulse(interaction, old.forces, ended, self.state.x)

    def _impulse(self, interaction: Interaction, forces: Forces, which: np.ndarray, x_other: np.ndarray) -> None:
        """Apply impulses at the places of now, so that angular momentum is kept, also of contacts that have ended."""
        if not len(which):
            return
        c, dt = forces.contact, self.model.dt
        i, j, before = c.i[which], c.j[which], c.n[:, which]
        negative_gap, _ = self._overlap_at(interaction, i, j, x_other)
        overlap, n = self._overlap_at(interaction, i, j, self.state.x)
        total = forces.f_n[which]
        f_t = forces.force[:, which] - total * before
        f_t = f_t - dot(f_t, n) * n
        theta = share_in_contact(c.overlap[which], negative_gap)
        friction = 0.0 if interaction.sliding is None else interaction.sliding.coefficient(c)
        if isinstance(friction, np.ndarray):
            friction = friction[which]
        along, across = missed_force(
            self.model, theta, f_n=total, elastic=forces.elastic[which], f_t=f_t, friction=friction)
        self._give(i, j, dt * (along * n + across))
        if c.v_t is not None:
            self._turn(i, j, overlap, dt * torque_cross(n, across))

    def _give(self, i: np.ndarray, j: np.ndarray, impulse: np.ndarray) -> None:
        """Add impulses (dim, K) to the nodes i and take them from the nodes j; of walls, loaded ones feel them."""
        s, n = self.state, self.model.particle_count
        np.add.at(s.v.T, i, (impulse * self._inverse_mass[i]).T)
        body = j < n
        np.subtract.at(s.v.T, j[body], (impulse[:, body] * self._inverse_mass[j[body]]).T)
        for k in np.flatnonzero(~body):
            self.walls.push(j[k] - n, -impulse[:, k])

    def _turn(self, i: np.ndarray, j: np.ndarray, overlap: np.ndarray, moment: np.ndarray) -> None:
        """Take the moments of the tangential impulses, (1|3, K) for an arm of 1, from the spins of both partners."""
        s, n = self.state, self.model.particle_count
        for node in (i, j):
            body = node < n
            arm = s.radius[node[body]] - 0.5 * overlap[body]
            change = arm * moment[:, body] * self._inverse_inertia[node[body]]
            np.subtract.at(s.spin.T, node[body], change.T)


def turned(v: np.ndarray, n: np.ndarray) -> np.ndarray:
    """Return vectors v, (dim, K), turned at right angles to n, their lengths kept."""
    across = v - dot(v, n) * n
    return across * _ratio(norm(v), norm(across))


def share_in_contact(overlap: np.ndarray, negative_gap: np.ndarray) -> np.ndarray:
    """Return theta, (K,), of contacts with an overlap at one end of the step and a gap at the other."""
    return np.clip(overlap / (overlap - negative_gap), 0.0, 1.0)


def missed_force(
    model: Model, theta: np.ndarray, *, f_n: np.ndarray, elastic: np.ndarray, f_t: np.ndarray,
    friction: float | np.ndarray,
) -> tuple[np.ndarray, np.ndarray]:
    """Return what the half kicks missed over dt, along the normal, (K,), and across it, (dim, K), in N.

    friction: mu, one number or (K,).
    """
    p, q = model.normal.onset
    along = missed(p, theta) * elastic + missed(q, theta) * (f_n - elastic)
    slides = norm(f_t) >= (1.0 - 1e-9) * friction * np.maximum(f_n, 0.0)
    return along, np.where(slides, _ratio(along, f_n), missed(0.0, theta)) * f_t


def missed(power: float, theta: np.ndarray) -> np.ndarray:
    """Return (integral - sum)/(dt f(theta dt)), (K,), of f ~ s^power from s = 0, summed at s = (theta + m) dt, m >= 0.

    To the order that counts: theta - 1/2 for power 0, (theta - 1)/2 for 1 (the next term is that of the trapezoidal
    rule on a smooth force), theta/(1 + power) - 1/2 above. A power between 0 and 1 has no such end: there the sum of
    all later steps counts, -theta^-power zeta(-power, theta) with Hurwitz' zeta (J. Waterman, J. M. Yos,
    W. E. Abodeely, J. Math. Phys. 43, 45 (1964)).
    """
    if power == 0.0 or power >= 1.0:
        return theta / (1.0 + power) - 0.5
    small = np.maximum(theta, 1e-12)
    return -(small**-power) * _hurwitz_zeta(-power, small)


def _hurwitz_zeta(s: float, a: np.ndarray) -> np.ndarray:
    """zeta(s, a), (K,), for s < 0 by the Euler-Maclaurin sum from a + 10 on; good to 1e-12."""
    far = a + 10.0
    tail = far ** (1.0 - s) / (s - 1.0) + 0.5 * far**-s + s * far ** (-s - 1.0) / 12.0
    tail -= s * (s + 1.0) * (s + 2.0) * far ** (-s - 3.0) / 720.0
    return sum((a + m) ** -s for m in range(10)) + tail


def _ratio(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    return np.divide(a, b, out=np.zeros_like(a), where=b != 0.0)


def _keys(contact: Touching, nodes: int) -> np.ndarray:
    return contact.i * nodes + contact.j


def simulate(model: Model) -> Simulation:
    """Return the textbook simulation in the scheme of the model's convention."""
    return CorrectedSimulation(model) if model.convention.scheme == "corrected" else Simulation(model)
