"""3D nodes: x, v, f, s, m as (3, n) arrays, each a view of a flat vector."""

from __future__ import annotations

import numpy as np

from reference.kernel.model import Model
from reference.kernel.program.buffers import empty, filled, lined_up
from reference.kernel.program.nodes import PART, Nodes
from reference.kernel.state import State
from reference.kernel.vectors import norm


class SpaceNodes(Nodes):
    """x, c, f: (3, n) positions, velocities, forces; s, m: (3, n), None without rotation."""

    def __init__(self, model: Model, state: State, *, spin_unit: np.ndarray | None):
        super().__init__(model, state, spin_unit=spin_unit)
        n = self.count
        self.place_vector = filled(0.0, 3 * n)
        self.x = self.place_vector.reshape(3, n)
        self.velocity_vector = filled(0.0, 3 * n if spin_unit is None else 6 * n)
        self.force_vector = lined_up(self.velocity_vector)
        self.work = empty(min(len(self.velocity_vector), PART))
        self.c, self.f = (a[: 3 * n].reshape(3, n) for a in (self.velocity_vector, self.force_vector))
        turning = (None, None) if spin_unit is None else (
            a[3 * n :].reshape(3, n) for a in (self.velocity_vector, self.force_vector))
        self.s, self.m = turning
        self.drift_factor = lined_up(np.tile(self._of_particles(np.full(model.particle_count, model.dt)), 3))
        self.kick_factor = lined_up(self._kick_factor())
        self.rest_force = self._rest_force()
        self.set(state)

    def set(self, state: State) -> None:
        """Take positions, velocities, spins, forces and torques of a state."""
        self.x[:], self.c[:], self.f[:] = state.x, state.v, state.force
        if self.s is not None:
            self.s[:] = state.spin * self.spin_unit
            self.m[:] = 0.0 if state.torque is None else state.torque

    def write(self, state: State) -> None:
        """Write positions, full-step velocities, spins and forces into a state."""
        n, full = self.model.particle_count, self.full_step().reshape(-1, 3, self.count)
        state.x[:], state.v[:], state.force[:] = self.x, full[0], self.f
        if self.s is not None:
            state.spin[:, :n] = full[1][:, :n] / self.spin_unit[:n]
        if state.torque is not None:
            state.torque[:] = self.m

    def places(self, place_vector: np.ndarray | None = None) -> np.ndarray:
        """Return x, (3, n), of now or of a copy of `place_vector`."""
        return self.x.copy() if place_vector is None else place_vector.reshape(3, -1)

    def largest_distance(self, place_vector: np.ndarray) -> float:
        """Return how far the node is that is furthest from its place in an earlier place vector."""
        away = (self.place_vector - place_vector).reshape(3, -1)
        return float(norm(away).max(initial=0.0))

    def half_step_velocities(self) -> tuple[np.ndarray, np.ndarray]:
        """Return v and omega, (3, n), as the last forces saw them."""
        if self.s is None:
            return self.c.copy(), np.zeros((3, self.count))
        return self.c.copy(), self.s * (self.turn_factor / self.model.dt)

    def shift_wall(self, k: int, point: np.ndarray, velocity: np.ndarray) -> None:
        """Put wall k at a point, (3,), with a velocity."""
        node = self.model.particle_count + k
        self.x[:, node], self.c[:, node] = point, velocity

    def force_on_wall(self, k: int) -> np.ndarray:
        """Return the force of the particles on wall k, (3,)."""
        return self.f[:, self.model.particle_count + k]

    def push(self, index: np.ndarray, change: np.ndarray) -> None:
        """Add changes of velocity, (3, K), to nodes, one after the other."""
        for axis in range(3):
            np.add.at(self.c[axis], index, change[axis])

    def spin_up(self, index: np.ndarray, change: np.ndarray) -> None:
        """Add changes of omega, (3, K), to nodes, one after the other."""
        for axis in range(3):
            np.add.at(self.s[axis], index, change[axis] * self.spin_unit[index])

    def _of_particles(self, values: np.ndarray) -> np.ndarray:
        return np.concatenate([values, np.zeros(self.count - len(values))])

    def _kick_factor(self) -> np.ndarray:
        m = self.model
        factors = [self._of_particles(m.dt / m.mass)] * 3
        if self.s is not None:
            factors += [self._of_particles(m.dt / m.inertia * self.spin_unit[: m.particle_count])] * 3
        return np.concatenate(factors)

    def _rest_force(self) -> np.ndarray | None:
        if self.model.gravity is None:
            return None
        rest, n = np.zeros_like(self.force_vector), self.model.particle_count
        rest[: 3 * self.count].reshape(3, -1)[:, :n] = np.asarray(self.model.gravity)[:, None] * self.model.mass
        return rest
