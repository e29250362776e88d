"""2D nodes as complex numbers.

    q = x - i y      (conjugate, so that (v_i - v_j) * conj(n) = v_n + i v_t is one multiplication)
    c = v_x + i v_y
    f = conj(force)

The signs that conjugation needs stand in the constant factors of kick and drift.
"""

from __future__ import annotations

import numpy as np

from reference.kernel.model import Model
from reference.kernel.program.buffers import empty, filled, lined_up
from reference.kernel.program.nodes import PART, Nodes
from reference.kernel.state import State


class PlaneNodes(Nodes):
    """q, c, f: (n,) complex; s, m: (n,), None without rotation."""

    def __init__(self, model: Model, state: State, *, spin_unit: np.ndarray | None):
        super().__init__(model, state, spin_unit=spin_unit)
        n = self.count
        self.q = empty(n, dtype=complex)
        self.place_vector = self.q.view(float)
        self.velocity_vector = filled(0.0, 2 * n if spin_unit is None else 3 * n)
        self.force_vector = lined_up(self.velocity_vector)
        self.work = empty(min(len(self.velocity_vector), PART))
        self.c, self.f = self.velocity_vector[: 2 * n].view(complex), self.force_vector[: 2 * n].view(complex)
        self.s = None if spin_unit is None else self.velocity_vector[2 * n :]
        self.m = None if spin_unit is None else self.force_vector[2 * n :]
        self.drift_factor = lined_up(model.dt * self._signs())
        self.kick_factor = lined_up(self._kick_factor())
        self.rest_force = self._rest_force()
        self.set(state)

    def set(self, state: State) -> None:
        """Take positions, velocities, spins, forces and torques of a state."""
        self.q.real, self.q.imag = state.x[0], -state.x[1]
        self.c.real, self.c.imag = state.v
        self.f.real, self.f.imag = state.force[0], -state.force[1]
        if self.s is not None:
            self.s[:] = state.spin[0] * self.spin_unit
            self.m[:] = 0.0 if state.torque is None else state.torque[0]

    def write(self, state: State) -> None:
        """Write positions, full-step velocities, spins and forces into a state."""
        n, full = self.model.particle_count, self.full_step()
        velocity = full[: 2 * self.count].view(complex)
        state.x[:] = self.places()
        state.v[0], state.v[1] = velocity.real, velocity.imag
        state.force[0], state.force[1] = self.f.real, -self.f.imag
        if self.s is not None:
            state.spin[0, :n] = full[2 * self.count :][:n] / self.spin_unit[:n]
        if state.torque is not None:
            state.torque[0] = self.m
        if self.turned is not None:
            state.turned[:] = self.turned[:n]

    def places(self, place_vector: np.ndarray | None = None) -> np.ndarray:
        """Return x, (2, n), of now or of a copy of `place_vector`."""
        q = self.q if place_vector is None else place_vector.view(complex)
        return np.stack([q.real, -q.imag])

    def largest_distance(self, place_vector: np.ndarray) -> float:
        """Return how far the node is that is furthest from its place in an earlier place vector."""
        away = (self.place_vector - place_vector).view(complex)
        return float(np.abs(away).max(initial=0.0))

    def half_step_velocities(self) -> tuple[np.ndarray, np.ndarray]:
        """Return v (2, n) and omega (1, n) as the last forces saw them."""
        spin = np.zeros((1, self.count))
        if self.s is not None:
            spin[0] = self.s * (self.turn_factor / self.model.dt)
        return np.stack([self.c.real, self.c.imag]), spin

    def shift_wall(self, k: int, point: np.ndarray, velocity: np.ndarray) -> None:
        """Put wall k at a point, (2,), with a velocity."""
        node = self.model.particle_count + k
        self.q[node] = complex(point[0], -point[1])
        self.c[node] = complex(velocity[0], velocity[1])

    def force_on_wall(self, k: int) -> np.ndarray:
        """Return the force of the particles on wall k, (2,)."""
        force = self.f[self.model.particle_count + k]
        return np.array((force.real, -force.imag))

    def push(self, index: np.ndarray, change: np.ndarray) -> None:
        """Add changes of velocity, (2, K), to nodes, one after the other."""
        np.add.at(self.c, index, change[0] + 1j * change[1])

    def spin_up(self, index: np.ndarray, change: np.ndarray) -> None:
        """Add changes of omega, (1, K), to nodes, one after the other."""
        np.add.at(self.s, index, change[0] * self.spin_unit[index])

    def _signs(self) -> np.ndarray:
        """(1, -1, 1, -1, ..), shape (2n,), 0 for walls: real and imaginary part of a conjugation."""
        signs = np.tile((1.0, -1.0), self.count)
        signs[2 * self.model.particle_count :] = 0.0
        return signs

    def _kick_factor(self) -> np.ndarray:
        m, n = self.model, self.model.particle_count
        factor = np.zeros_like(self.velocity_vector)
        factor[: 2 * n] = np.repeat(m.dt / m.mass, 2) * self._signs()[: 2 * n]
        if self.s is not None:
            factor[2 * self.count : 2 * self.count + n] = m.dt / m.inertia * self.spin_unit[:n]
        return factor

    def _rest_force(self) -> np.ndarray | None:
        if self.model.gravity is None:
            return None
        rest, n = np.zeros_like(self.force_vector), self.model.particle_count
        weight = rest[: 2 * n].view(complex)
        weight.real = self.model.mass * self.model.gravity[0]
        weight.imag = -self.model.mass * self.model.gravity[1]
        return rest
