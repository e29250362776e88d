"""Walls that move: prescribed, or with mass under a load. A few scalars a step, in plain Python.

The order is that of velocity Verlet: a loaded wall is kicked by half a step, moved, and kicked again when the forces
at its new place are known; its damping sees the half-step rate, as all dampers do.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from reference.kernel.model import Constant, Fixed, Loaded, Model
from reference.kernel.program.nodes import Nodes
from reference.kernel.state import State


@dataclass
class _Wall:
    """Displacement d along the normal, its rate, and the acceleration of a loaded wall."""

    number: int
    d: float
    rate: float
    acceleration: float = 0.0


class MovingWalls:
    """Moves the wall nodes of `nodes`. `step` counts; time is dt times it, so no error accumulates."""

    def __init__(self, model: Model, nodes: Nodes, state: State):
        self.model, self.nodes = model, nodes
        self.step = state.step
        self.point = state.x[:, model.particle_count :].copy()
        self.here = self.point.copy()
        self.normal = state.wall_normal
        self.moving = [
            _Wall(k, float(state.wall_d[k]), float(state.wall_rate[k]))
            for k, wall in enumerate(model.walls) if not isinstance(wall.motion, Fixed)
        ]
        self.loaded = [w for w in self.moving if isinstance(model.walls[w.number].motion, Loaded)]

    def start(self) -> None:
        """Take the accelerations of the forces at set-up."""
        for wall in self.loaded:
            wall.acceleration = self.acceleration(wall)

    def move(self) -> None:
        """Bring all walls to the end of the step; node velocities are mean rates of the step."""
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

    def snapshot(self) -> list[tuple[float, float, float]]:
        """What `restore` needs; the nodes' arrays are not part of it."""
        return [(self.step, 0.0, 0.0), *((w.d, w.rate, w.acceleration) for w in self.moving)]

    def restore(self, kept: list[tuple[float, float, float]]) -> None:
        """Go back to a snapshot."""
        self.step = int(kept[0][0])
        for wall, values in zip(self.moving, kept[1:], strict=True):
            wall.d, wall.rate, wall.acceleration = values

    def _carry(self, wall: _Wall, motion: Constant) -> None:
        time, k, velocity = self.step * self.model.dt, wall.number, np.array(motion.velocity)
        self.here[:, k] = self.point[:, k] + time * velocity
        self.nodes.shift_wall(k, self.here[:, k], velocity)
        wall.d = time * wall.rate

    def _shift(self, wall: _Wall, d: float) -> None:
        k = wall.number
        normal = self.normal[:, k]
        self.here[:, k] = self.point[:, k] + d * normal
        self.nodes.shift_wall(k, self.here[:, k], (d - wall.d) / self.model.dt * normal)
        wall.d = d

    def acceleration(self, wall: _Wall) -> float:
        """Return (load + stress * extent + F.n - damping d') / mass; extent: distance of the walls in `span`."""
        motion = self.model.walls[wall.number].motion
        pushed = _dot(self.nodes.force_on_wall(wall.number), self.normal[:, wall.number])
        extent = 0.0
        if motion.span is not None:
            a, b = motion.span
            extent = _dot(self.here[:, b] - self.here[:, a], self.normal[:, a])
        return (motion.load + motion.stress * extent + pushed - motion.damping * wall.rate) / motion.mass


def _dot(a: np.ndarray, b: np.ndarray) -> float:
    """a.b of two short vectors, one component after the other."""
    return sum(p * q for p, q in zip(a.tolist(), b.tolist(), strict=True))
