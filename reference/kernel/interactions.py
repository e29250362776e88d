"""From candidates to forces: the touching contacts of particles with particles, and with walls.

Both kinds are pairs of nodes (i, j): nodes 0..N-1 are particles, N + k is wall k. Only two things
differ: a wall's branch vector is the distance to the plane, and walls have their own lever arms.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from reference.kernel.laws.contact import Touching
from reference.kernel.laws.sliding import SpringSliding
from reference.kernel.model import Model
from reference.kernel.neighbours import CandidateList, branch_vectors, pairs_within, wall_pairs_within
from reference.kernel.state import State
from reference.kernel.vectors import dot, spin_cross, torque_cross


@dataclass(frozen=True, kw_only=True)
class Forces:
    """Contact forces of one evaluation: `force` (dim, M) on i, minus that on j; `f_n` (M,)."""

    contact: Touching
    force: np.ndarray
    f_n: np.ndarray
    spring: np.ndarray | None


class Interaction:
    """One kind of pairs with their candidate list and the laws that act in them.

    `walls` is None for particles with particles, else the numbers of the walls of this kind.
    """

    def __init__(self, model: Model, *, walls: tuple[int, ...] | None, sliding: SpringSliding | None):
        self.model = model
        self.walls = walls
        self.sliding = sliding
        nodes = model.particle_count + len(model.walls)
        self.pairs = CandidateList(model.dimension, nodes, with_spring=sliding is not None)
        arms = model.convention
        self.slip_arm = arms.slip_arm if walls is None else arms.wall_slip_arm
        self.torque_arm = arms.torque_arm if walls is None else arms.wall_torque_arm
        self.last: Forces | None = None

    def renew(self, state: State, skin: float) -> None:
        """Find the candidates anew: all pairs with a gap below the skin."""
        if self.walls is None:
            found = pairs_within(self.model, state.x[:, : self.model.particle_count], skin)
        else:
            found = wall_pairs_within(self.model, state.x, state.wall_normal, self.walls, skin)
        self.pairs.replace(*found)

    def evaluate(self, state: State, v: np.ndarray, spin: np.ndarray, dt: float, *, advance: bool) -> Forces:
        """Return the contact forces; with `advance` the springs move on by dt."""
        touching, n, overlap = self._overlaps(state)
        i, j = self.pairs.i[touching], self.pairs.j[touching]
        contact = self._kinematics(state, v, spin, i, j, n, overlap)
        f_n = self.model.normal.force(contact)
        force, spring = f_n * n, None
        if self.sliding is not None:
            f_t, spring = self.sliding.force(
                self.pairs.spring.take(touching, axis=1), n, contact.v_t, f_n, dt, advance=advance
            )
            force = force + f_t
            if advance:
                self._store(touching, spring)
        return Forces(contact=contact, force=force, f_n=f_n, spring=spring)

    def _overlaps(self, state: State) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Return the numbers of the touching candidates, their normals and overlaps."""
        i, j = self.pairs.i, self.pairs.j
        if self.walls is None:
            branch = branch_vectors(self.model, state.x, i, j)
            distance = np.sqrt(dot(branch, branch))
        else:
            branch = state.wall_normal.take(j - self.model.particle_count, axis=1)
            distance = dot(state.x.take(i, axis=1) - state.x.take(j, axis=1), branch)
        overlap = state.radius.take(i) + state.radius.take(j) - distance
        touching = np.flatnonzero(overlap > 0.0)
        n = branch.take(touching, axis=1)
        if self.walls is None:
            n /= distance[touching]
        return touching, n, overlap[touching]

    def _kinematics(self, state, v, spin, i, j, n, overlap) -> Touching:
        v_ij = v.take(i, axis=1) - v.take(j, axis=1)
        v_n = dot(v_ij, n)
        if self.sliding is None:
            return Touching(i=i, j=j, n=n, overlap=overlap, v_n=v_n)
        radius_i, radius_j = state.radius.take(i), state.radius.take(j)
        slip_i, slip_j = _arms(radius_i, radius_j, overlap, self.slip_arm)
        turning = slip_i * spin.take(i, axis=1) + slip_j * spin.take(j, axis=1)
        v_t = v_ij - v_n * n - spin_cross(turning, n)
        arm_i, arm_j = _arms(radius_i, radius_j, overlap, self.torque_arm)
        return Touching(i=i, j=j, n=n, overlap=overlap, v_n=v_n, v_t=v_t, torque_arm_i=arm_i, torque_arm_j=arm_j)

    def _store(self, touching: np.ndarray, spring: np.ndarray) -> None:
        """Keep the springs of touching contacts; a contact that opened forgets its spring."""
        self.pairs.spring[:] = 0.0
        self.pairs.spring[:, touching] = spring

    def add_to(self, forces: Forces, force: np.ndarray, torque: np.ndarray | None) -> None:
        """Sum contact forces to the nodes, (dim, N+W), and torques, (1|3, N+W), in pair order."""
        c, nodes = forces.contact, force.shape[1]
        for axis, component in enumerate(forces.force):
            force[axis] += np.bincount(c.i, component, nodes) - np.bincount(c.j, component, nodes)
        if self.sliding is not None:
            for axis, component in enumerate(torque_cross(c.n, forces.force)):
                torque[axis] -= np.bincount(c.i, c.torque_arm_i * component, nodes)
                torque[axis] -= np.bincount(c.j, c.torque_arm_j * component, nodes)


def _arms(radius_i, radius_j, overlap, arm: str) -> tuple[np.ndarray, np.ndarray]:
    """Lever arms of both partners. A wall has radius 0 and does not turn: its arm never counts."""
    if arm == "radius":
        return radius_i, radius_j
    return radius_i - 0.5 * overlap, radius_j - 0.5 * overlap
