"""The moving part: one set of arrays for particles, walls and glued discs."""

from __future__ import annotations

from dataclasses import dataclass
from functools import partial

import numpy as np

from reference.kernel.model import Constant, Model
from reference.kernel.vectors import dot, spin_components


@dataclass(kw_only=True)
class State:
    """Node arrays: particles 0..N-1, then walls N..N+W-1, then the discs of the rings, n nodes in all.

    x, v, force: (dim, n); x of a wall is a point on its plane. spin, torque: (1|3, n), zero for
    walls. radius: (n,), 0 for walls. wall_normal: (dim, W). wall_d, wall_rate: (W,) displacement
    along the normal since the start and its rate. wall_force: (dim, W) force of particles on walls.
    turned: (N,) angle since the start, rad; None unless it is followed.
    """

    x: np.ndarray
    v: np.ndarray
    spin: np.ndarray
    radius: np.ndarray
    force: np.ndarray
    torque: np.ndarray | None
    wall_normal: np.ndarray
    wall_d: np.ndarray
    wall_rate: np.ndarray
    wall_force: np.ndarray
    turned: np.ndarray | None = None
    step: int = 0


def initial_state(model: Model) -> State:
    """Return the state at time 0; walls with a constant velocity have it from the start, and so do rings."""
    dim, walls, zeros = model.dimension, len(model.walls), partial(np.zeros, dtype=model.precision)
    point = np.array([w.point for w in model.walls], model.precision).reshape(walls, dim).T
    normal = np.array([w.normal for w in model.walls], model.precision).reshape(walls, dim).T
    velocity = [w.motion.velocity if isinstance(w.motion, Constant) else (0.0,) * dim for w in model.walls]
    wall_v = np.array(velocity, model.precision).reshape(walls, dim).T
    spins = spin_components(dim)
    rings = model.rings
    glued_spin = [np.full((1, len(r.radius)), r.omega or 0.0, model.precision) for r in rings]
    x = np.hstack([model.x, point, *(r.x for r in rings)])
    nodes = x.shape[1]
    return State(
        x=x,
        v=np.hstack([model.v, wall_v, *(r.velocities(r.x) for r in rings)]),
        spin=np.hstack([model.spin, zeros((spins, walls)), *glued_spin]),
        radius=np.concatenate([model.radius, zeros(walls), *(r.radius for r in rings)]),
        force=zeros((dim, nodes)),
        torque=zeros((spins, nodes)) if model.turns else None,
        wall_normal=normal,
        wall_d=zeros(walls),
        wall_rate=dot(wall_v, normal),
        wall_force=zeros((dim, walls)),
        turned=zeros(model.particle_count) if model.rotations else None,
    )
