"""Two bodies that push or pull along the line of their centres, stepped by velocity Verlet.

L. Verlet, Phys. Rev. 159, 98 (1967), as the codes have it: v += dt F/2m, x += dt v, F(x, v of the half step),
v += dt F/2m. Without friction spins do not change, and nothing else is to be known of a collision. For
many pairs at once, each by itself; SI units, forces positive when they push.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np

from reference.analytic.prescribed import ElasticPair, jkr_elastic_force, jkr_overlap_of_largest_pull

CentralForce = Callable[[np.ndarray, np.ndarray], np.ndarray]
"""From overlap (C,), m, and rate of separation (C,), m/s, to the force, (C,) in N; called once a step, in order."""


def flight(
    x: np.ndarray, v: np.ndarray, *, mass: np.ndarray, reach: float, force: CentralForce, dt: float, steps: int,
    every: int,
) -> tuple[np.ndarray, np.ndarray]:
    """Return places and velocities at steps 0, every, 2 every, ...: (F, C, 2, 3).

    x, v: (C, 2, 3) of bodies i and j; mass: (2,) in kg; reach: R_i + R_j. Raises ValueError for bodies that touch at
    the start: they have a history.

    >>> x, v = np.array([[[1.001, 0, 0], [0.0, 0, 0]]]), np.array([[[-1.0, 0, 0], [0.0, 0, 0]]])
    >>> _, end = flight(x, v, mass=np.ones(2), reach=1.0, force=lambda d, _: 1e4 * np.maximum(d, 0.0), dt=1e-5,
    ...                 steps=4000, every=4000)
    >>> end[-1, 0, :, 0].round(3).tolist()
    [0.0, -1.0]
    """
    if not (np.linalg.norm(x[:, 0] - x[:, 1], axis=1) > reach).all():
        raise ValueError("bodies touch at the start")
    x, v, pull, kept = x.copy(), v.copy(), np.zeros_like(x), [(x, v)]
    kick = 0.5 * dt / np.asarray(mass)[:, None]
    for step in range(1, steps + 1):
        half = v + kick * pull
        x = x + dt * half
        apart, rate = x[:, 0] - x[:, 1], half[:, 0] - half[:, 1]
        size = np.linalg.norm(apart, axis=1)
        normal = apart / size[:, None]
        push = force(reach - size, (rate * normal).sum(axis=1))[:, None] * normal
        pull = np.stack([push, -push], axis=1)
        v = half + kick * pull
        if step % every == 0:
            kept.append((x, v))
    places, velocities = (np.array(of) for of in zip(*kept, strict=True))
    return places, velocities


@dataclass(kw_only=True)
class JkrGrip:
    """JKR with a dashpot: contacts begin with their overlap and hold on beyond it, as far as the largest pull.

    surface_energy: w of each surface, J/m^2; damping: kg/s. A force with a memory: one object a flight.
    """

    pair: ElasticPair
    surface_energy: float
    damping: float
    _held: np.ndarray | None = field(default=None, repr=False)

    def __call__(self, overlap: np.ndarray, separation: np.ndarray) -> np.ndarray:
        """Return the force, (C,) in N."""
        release = jkr_overlap_of_largest_pull(self.pair, self.surface_energy)
        before = np.zeros(len(overlap), bool) if self._held is None else self._held
        self._held = held = (overlap > 0.0) | (before & (overlap >= release))
        force = np.zeros(len(overlap))
        force[held] = jkr_elastic_force(overlap[held], self.pair, self.surface_energy) - self.damping * separation[held]
        return force
