"""What nodes have in common in two and three dimensions: flat vectors that a step kicks and drifts.

    place_vector                   positions
    velocity_vector                [velocities | s],   s = R omega or omega
    force_vector                   [forces | m],       m = torque
    work                           as long as one of their parts, free for work within a few operations
    kick_factor, drift_factor      dt/m, dt/I times the spin unit; dt: with the signs of the layout; both are 0 but for
                                   particles

Particles are nodes 0..N-1, walls N..N+W-1, the discs of rings follow. How the vectors are laid out is the dimension's
own matter (`plane.nodes`, `space.nodes`).
"""

from __future__ import annotations

import numpy as np

from reference.kernel.model import Model
from reference.kernel.program.buffers import filled
from reference.kernel.state import State

PART = 1 << 14
"""Numbers of a node vector that are moved at a time; whole cache lines."""


class Nodes:
    """Arrays of all nodes. `spin_unit`: (n,) what s is omega times of, R or 1; None without rotation."""

    place_vector: np.ndarray
    velocity_vector: np.ndarray
    force_vector: np.ndarray
    work: np.ndarray
    kick_factor: np.ndarray
    drift_factor: np.ndarray
    rest_force: np.ndarray | None
    """What every evaluation starts from: the weights; None without gravity."""

    def __init__(self, model: Model, state: State, *, spin_unit: np.ndarray | None):
        self.model = model
        self.count = state.x.shape[1]
        self.spin_unit = spin_unit
        self.turned = filled(0.0, self.count) if model.rotations else None
        self.turn_factor = None if spin_unit is None else model.dt / np.where(spin_unit > 0, spin_unit, 1.0)

    @staticmethod
    def parts(vector: np.ndarray) -> list[slice]:
        """Return slices of at most PART numbers, of which one after the other is moved: the cache keeps them."""
        return [slice(k, min(k + PART, len(vector))) for k in range(0, len(vector), PART)]

    def places(self, place_vector: np.ndarray | None = None) -> np.ndarray:
        """Return x, (dim, n), of now or of a copy of `place_vector`."""
        raise NotImplementedError

    def largest_distance(self, place_vector: np.ndarray) -> float:
        """Return how far the node is that is furthest from its place in an earlier place vector."""
        raise NotImplementedError

    def half_step_velocities(self) -> tuple[np.ndarray, np.ndarray]:
        """Return v (dim, n) and omega (1|3, n) as the last forces saw them."""
        raise NotImplementedError

    def set(self, state: State) -> None:
        """Take positions, velocities, spins, forces and torques of a state."""
        raise NotImplementedError

    def write(self, state: State) -> None:
        """Write positions, full-step velocities v(n-1/2) + dt/2 f/m, spins and forces into a state."""
        raise NotImplementedError

    def shift_wall(self, k: int, point: np.ndarray, velocity: np.ndarray) -> None:
        """Put wall k at a point, (dim,), with a velocity."""
        raise NotImplementedError

    def force_on_wall(self, k: int) -> np.ndarray:
        """Return the force of the particles on wall k, (dim,)."""
        raise NotImplementedError

    def push(self, index: np.ndarray, change: np.ndarray) -> None:
        """Add changes of velocity, (dim, K), to nodes, one after the other."""
        raise NotImplementedError

    def spin_up(self, index: np.ndarray, change: np.ndarray) -> None:
        """Add changes of omega, (1|3, K), to nodes, one after the other."""
        raise NotImplementedError

    def full_step(self) -> np.ndarray:
        """Return the velocity vector at the full step."""
        if self.model.convention.scheme == "corrected":
            return self.velocity_vector.copy()
        return self.velocity_vector + 0.5 * (self.force_vector * self.kick_factor)

    def step_back(self) -> None:
        """From v(0) to v(-1/2), from where the first kick starts."""
        self.velocity_vector -= 0.5 * (self.force_vector * self.kick_factor)

    def snapshot(self) -> list[np.ndarray]:
        """Return copies of what a step changes."""
        return [a.copy() for a in self._changing()]

    def restore(self, kept: list[np.ndarray]) -> None:
        """Go back to a snapshot."""
        for array, values in zip(self._changing(), kept, strict=True):
            array[:] = values

    def _changing(self) -> list[np.ndarray]:
        arrays = (self.place_vector, self.velocity_vector, self.force_vector, self.turned)
        return [a for a in arrays if a is not None]
