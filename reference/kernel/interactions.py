"""From candidates to forces: the touching contacts of particles with particles, with rings, and with walls.

All are pairs of nodes (i, j): nodes 0..N-1 are particles, N + k is wall k, the discs of rings follow. Few things
differ: a wall's branch vector is the distance to the plane, walls have their own lever arms, and the mass of walls
and of glued discs is infinite.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from reference.kernel.laws.contact import Pressing, Touching
from reference.kernel.laws.law import Law
from reference.kernel.model import Model
from reference.kernel.neighbours import (
    CandidateList,
    branch_vectors,
    pairs_within,
    ring_pairs_within,
    wall_pairs_within,
)
from reference.kernel.state import State
from reference.kernel.vectors import dot, spin_cross, torque_cross


@dataclass(frozen=True, kw_only=True)
class Forces:
    """Contact forces of one evaluation: `force` (dim, M) on i, minus that on j; `f_n`, `elastic` (M,).

    touching: (M,) numbers of the contacts among the candidates.
    couple: (1|3, M) on i, minus that on j, besides the torques of `force`; None without rolling and torsion.
    memory: what the contacts remember after it, (rows, M) by family of laws.
    """

    touching: np.ndarray
    contact: Touching
    force: np.ndarray
    f_n: np.ndarray
    elastic: np.ndarray
    couple: np.ndarray | None
    memory: dict[str, np.ndarray]


class Interaction:
    """One kind of pairs with their candidate list and the laws that act in them.

    `walls` is None for particles with particles, or with the glued discs of `rings`; else the numbers of the walls
    of this kind. Contacts that are not `rough` know the normal law alone.
    """

    def __init__(self, model: Model, *, walls: tuple[int, ...] | None, rough: bool, rings: bool = False):
        self.model = model
        self.walls = walls
        self.rings = rings
        self.normal = model.normal
        self.sliding, self.rolling, self.torsion = (
            (model.sliding, model.rolling, model.torsion) if rough else (None, None, None))
        laws = self._laws()
        self.needs = frozenset().union(*(law.needs for law in laws.values()))
        rows = {family: law.memory_rows(model.dimension) for family, law in laws.items()}
        self.pairs = CandidateList(model.node_count, rows, model.precision)
        arms = model.convention
        self.slip_arm = arms.slip_arm if walls is None else arms.wall_slip_arm
        self.torque_arm = arms.torque_arm if walls is None else arms.wall_torque_arm
        self.turns_normals_back = walls is None and arms.slip_normal == "middle" and model.dimension == 3
        self.last: Forces | None = None
        self.prepare: Callable[[Touching], Touching] | None = None
        """What a scheme does to the kinematics of a step before the laws see them."""

    def _laws(self) -> dict[str, Law]:
        made = {"normal": self.normal, "sliding": self.sliding, "rolling": self.rolling, "torsion": self.torsion}
        return {family: law for family, law in made.items() if law is not None}

    def renew(self, state: State, skin: float) -> None:
        """Find the candidates anew: all pairs with a gap below the skin."""
        if self.rings:
            found = ring_pairs_within(self.model, state.x, state.radius, skin)
        elif self.walls is None:
            found = pairs_within(self.model, state.x[:, : self.model.particle_count], skin)
        else:
            found = wall_pairs_within(self.model, state.x, state.wall_normal, self.walls, skin)
        self.pairs.replace(*found)

    def owns(self, j: np.ndarray) -> np.ndarray:
        """Return whether pairs with the second partners j, (M,), are of this kind."""
        walls = self.model.wall_nodes
        if self.rings:
            return j >= walls.stop
        return j < walls.start if self.walls is None else np.isin(j - walls.start, self.walls)

    def evaluate(
        self, state: State, v: np.ndarray, spin: np.ndarray, dt: float, *, advance: bool, lag: float = 0.0
    ) -> Forces:
        """Return the contact forces, and what contacts remember after them; nothing is changed by it.

        With `advance` memories have moved on by dt. Without it time stands still: springs are neither
        turned nor stretched nor cut. lag: the time by which v and spin are those of before, s: dt/2 in the leapfrog.
        """
        touching, n, overlap = self._overlaps(state)
        i, j = self.pairs.i[touching], self.pairs.j[touching]
        contact = self._kinematics(state, v, spin, i, j, n, overlap, lag)
        if advance and self.prepare is not None:
            contact = self.prepare(contact)
        memory = self.pairs.recall(touching)
        f_n, elastic, memory["normal"] = self.normal.force(contact, memory.get("normal"))
        force, couple = f_n * n, None
        pressing = self.pressing(contact, f_n, elastic)
        moving = {"dt": dt, "advance": advance}
        if self.sliding is not None:
            f_t, memory["sliding"] = self.sliding.force(contact, pressing, memory.get("sliding"), **moving)
            force = force + f_t
        if self.rolling is not None:
            couple, memory["rolling"] = self.rolling.couple(contact, pressing, memory.get("rolling"), **moving)
        if self.torsion is not None:
            twist, memory["torsion"] = self.torsion.couple(contact, pressing, memory.get("torsion"), **moving)
            couple = twist if couple is None else couple + twist
        return Forces(
            touching=touching, contact=contact, force=force, f_n=f_n, elastic=elastic, couple=couple, memory=memory)

    def remember(self, forces: Forces) -> None:
        """Keep what the contacts of an evaluation remember; contacts that opened forget."""
        self.pairs.remember(forces.touching, forces.memory)

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

    def _kinematics(self, state, v, spin, i, j, n, overlap, lag) -> Touching:
        """Return the touching contacts with what their laws need, and no more."""
        v_ij = v.take(i, axis=1) - v.take(j, axis=1)
        v_n = dot(v_ij, n)
        wanted = {}
        if "v_t" in self.needs:
            wanted |= self._slip(state, spin, i, j, n, overlap, v_ij - v_n * n, lag)
        if "spin" in self.needs:
            wanted["spin"] = self._relative_spin(state, spin, i, j, overlap)
        if "reduced_radius" in self.needs:
            wanted["reduced_radius"] = self._reduced(state.radius if self.rings else self.model.radius, i, j)
        if "reduced_mass" in self.needs:
            wanted["reduced_mass"] = self._reduced(self.model.mass, i, j)
        return Touching(i=i, j=j, n=n, overlap=overlap, v_n=v_n, **wanted)

    def _slip(self, state, spin, i, j, n, overlap, v_across, lag) -> dict[str, np.ndarray]:
        """Slip velocity, from that of the centres across the normal and the spins, and the torque's arms.

        The normal is turned back by the lag where the convention asks for that.
        """
        radius_i, radius_j = state.radius.take(i), state.radius.take(j)
        slip_i, slip_j = _arms(radius_i, radius_j, overlap, self.slip_arm)
        turning = slip_i * spin.take(i, axis=1) + slip_j * spin.take(j, axis=1)
        if self.turns_normals_back:
            turning += lag / (radius_i + radius_j - overlap) * dot(turning, n) * v_across
        arm_i, arm_j = _arms(radius_i, radius_j, overlap, self.torque_arm)
        return {"v_t": v_across - spin_cross(turning, n), "torque_arm_i": arm_i, "torque_arm_j": arm_j}

    def _relative_spin(self, state, spin, i, j, overlap) -> np.ndarray:
        if self.walls is None:
            return spin.take(i, axis=1) - spin.take(j, axis=1)
        if self.model.convention.wall_spin == "whole":
            return spin.take(i, axis=1)
        radius = state.radius.take(i)
        return (radius - 0.5 * overlap) / (radius - overlap) * spin.take(i, axis=1)

    def _reduced(self, quantity: np.ndarray, i: np.ndarray, j: np.ndarray) -> np.ndarray:
        """Return q_i q_j/(q_i + q_j); a wall is infinite, which leaves q_i, and so is a glued disc's mass."""
        q_i = quantity.take(i)
        if self.walls is not None or self.rings and quantity is self.model.mass:
            return q_i
        q_j = quantity.take(j)
        return q_i * q_j / (q_i + q_j)

    def pressing(self, contact: Touching, f_n: np.ndarray, elastic: np.ndarray) -> Pressing | None:
        """Return the base of all limits; None in smooth contacts, which have no limits."""
        if self.sliding is self.rolling is self.torsion is None:
            return None
        gripping = self.normal.gripping(contact, f_n, elastic)
        base = np.abs(gripping) if self.model.convention.limit == "absolute" else np.maximum(gripping, 0.0)
        return Pressing(total=f_n, elastic=elastic, base=base)

    def add_to(self, forces: Forces, force: np.ndarray, torque: np.ndarray | None) -> None:
        """Sum contact forces to the nodes, (dim, N+W), and torques, (1|3, N+W), in pair order."""
        c, nodes = forces.contact, force.shape[1]
        for axis, component in enumerate(forces.force):
            force[axis] += summed(c.i, component, nodes) - summed(c.j, component, nodes)
        if self.sliding is not None:
            for axis, component in enumerate(torque_cross(c.n, forces.force)):
                torque[axis] -= summed(c.i, c.torque_arm_i * component, nodes)
                torque[axis] -= summed(c.j, c.torque_arm_j * component, nodes)
        if forces.couple is not None:
            for axis, component in enumerate(forces.couple):
                torque[axis] += summed(c.i, component, nodes) - summed(c.j, component, nodes)


def summed(node: np.ndarray, values: np.ndarray, nodes: int) -> np.ndarray:
    """Return the sums of values (M,) at nodes, (nodes,), one after the other; `bincount` knows doubles only."""
    if values.dtype == float:
        return np.bincount(node, values, nodes)
    sums = np.zeros(nodes, values.dtype)
    np.add.at(sums, node, values)
    return sums


def _arms(radius_i, radius_j, overlap, arm: str) -> tuple[np.ndarray, np.ndarray]:
    """Lever arms of both partners. A wall has radius 0 and does not turn: its arm never counts."""
    if arm == "radius":
        return radius_i, radius_j
    return radius_i - 0.5 * overlap, radius_j - 0.5 * overlap
