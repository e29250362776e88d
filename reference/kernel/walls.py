"""Walls that move: prescribed, or with mass under a load. A few scalars a step, for both evaluations of the kernel.

The order is that of velocity Verlet: a loaded wall is kicked by half a step, moved, and kicked again when the forces
at its new place are known; its damping sees the half-step rate, as all dampers do. The second-order scheme predicts its
rate at the end of the step before the forces are computed, and puts it right afterwards.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

import numpy as np

from reference.kernel.model import Constant, Fixed, Loaded, Model
from reference.kernel.state import State


class Host(Protocol):
    """What walls are told to, and what they ask: a simulation's nodes."""

    def shift_wall(self, k: int, point: np.ndarray, velocity: np.ndarray) -> None:
        """Put wall k at a point, (dim,), with a velocity."""

    def force_on_wall(self, k: int) -> np.ndarray:
        """Return the force of the particles on wall k, (dim,)."""


@dataclass
class _Wall:
    """Displacement d along the normal, its rate, and the acceleration of a loaded wall."""

    number: int
    d: float
    rate: float
    acceleration: float = 0.0


class MovingWalls:
    """Moves the walls of `host`. `step` counts; time is dt times it, so no error accumulates."""

    def __init__(self, model: Model, host: Host, state: State):
        self.model, self.host = model, host
        self.step = state.step
        self.point = state.x[:, model.wall_nodes].copy()
        self.here = self.point.copy()
        self.normal = state.wall_normal
        self.moving = [
            _Wall(k, state.wall_d[k].item(), state.wall_rate[k].item())
            for k, wall in enumerate(model.walls) if not isinstance(wall.motion, Fixed)
        ]
        self.loaded = [w for w in self.moving if isinstance(model.walls[w.number].motion, Loaded)]

    def start(self) -> None:
        """Take the accelerations of the forces at set-up."""
        for wall in self.loaded:
            wall.acceleration = self.acceleration(wall)

    def write(self, state: State) -> None:
        """Write displacements and rates into a state."""
        for wall in self.moving:
            state.wall_d[wall.number], state.wall_rate[wall.number] = wall.d, wall.rate

    def move(self) -> None:
        """Bring all walls to the end of the step; their velocities are mean rates of the step."""
        self.step += 1
        dt = self.model.dt
        for wall in self.moving:
            motion = self.model.walls[wall.number].motion
            if isinstance(motion, Loaded):
                wall.rate += 0.5 * dt * wall.acceleration
                self._shift(wall, wall.d + dt * wall.rate)
            elif isinstance(motion, Constant):
                self._carry(wall, motion)
            else:
                self._shift(wall, motion.displacement(self.step * dt))
                wall.rate = motion.rate(self.step * dt)

    def kick(self) -> None:
        """Second half kick of the loaded walls, with the forces at the new places."""
        for wall in self.loaded:
            wall.acceleration = self.acceleration(wall)
            wall.rate += 0.5 * self.model.dt * wall.acceleration

    # --- the second-order scheme ---------------------------------------------------------------

    def predict(self) -> None:
        """Take the loaded walls' rates to the end of the step by the old forces; those rates are the velocities."""
        for wall in self.moving:
            motion, k = self.model.walls[wall.number].motion, wall.number
            if isinstance(motion, Loaded):
                wall.rate += 0.5 * self.model.dt * wall.acceleration
            if not isinstance(motion, Constant):
                self.host.shift_wall(k, self.here[:, k], wall.rate * self.normal[:, k])

    def replace_kick(self) -> None:
        """Replace the predicted half kick by that of the new forces."""
        for wall in self.loaded:
            old = wall.acceleration
            wall.acceleration = self.acceleration(wall)
            wall.rate += 0.5 * self.model.dt * (wall.acceleration - old)

    def push(self, k: int, impulse: np.ndarray) -> None:
        """Give wall k an impulse, (dim,), which a loaded wall feels along its normal."""
        for wall in self.loaded:
            if wall.number == k:
                wall.rate += _dot(impulse, self.normal[:, k]) / self.model.walls[k].motion.mass

    # --- going back ----------------------------------------------------------------------------

    def snapshot(self) -> list[tuple[float, float, float]]:
        """What `restore` needs; the host's arrays are not part of it."""
        return [(self.step, 0.0, 0.0), *((w.d, w.rate, w.acceleration) for w in self.moving)]

    def restore(self, kept: list[tuple[float, float, float]]) -> None:
        """Go back to a snapshot."""
        self.step = int(kept[0][0])
        for wall, values in zip(self.moving, kept[1:], strict=True):
            wall.d, wall.rate, wall.acceleration = values

    # --- one wall ------------------------------------------------------------------------------

    def _carry(self, wall: _Wall, motion: Constant) -> None:
        time, k, velocity = self.step * self.model.dt, wall.number, np.array(motion.velocity)
        self.here[:, k] = self.point[:, k] + time * velocity
        self.host.shift_wall(k, self.here[:, k], velocity)
        wall.d = time * wall.rate

    def _shift(self, wall: _Wall, d: float) -> None:
        k = wall.number
        normal = self.normal[:, k]
        self.here[:, k] = self.point[:, k] + d * normal
        self.host.shift_wall(k, self.here[:, k], (d - wall.d) / self.model.dt * normal)
        wall.d = d

    def acceleration(self, wall: _Wall) -> float:
        """Return (load + stress * extent + F.n - damping d') / mass; extent: distance of the walls in `span`."""
        motion = self.model.walls[wall.number].motion
        pushed = _dot(self.host.force_on_wall(wall.number), self.normal[:, wall.number])
        extent = 0.0
        if motion.span is not None:
            a, b = motion.span
            extent = _dot(self.here[:, b] - self.here[:, a], self.normal[:, a])
        return (motion.load + motion.stress * extent + pushed - motion.damping * wall.rate) / motion.mass


def _dot(a: np.ndarray, b: np.ndarray) -> float:
    """a.b of two short vectors, one component after the other."""
    return sum(p * q for p, q in zip(a.tolist(), b.tolist(), strict=True))
