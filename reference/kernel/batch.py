"""Many small systems as one: below a hundred particles a step costs its calls, not its numbers.

Replicas that share laws, convention and time step are set side by side, far enough apart never to meet, and run as one
system. Their sums stay their own, so each moves as it would alone, up to the rounding of places far from the origin.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from reference.kernel.laws.by_pair import ByPair
from reference.kernel.model import Model
from reference.kernel.state import State

_SHARED = ("normal", "sliding", "rolling", "torsion", "convention", "dt", "gravity", "drag", "rotations")


@dataclass(frozen=True, kw_only=True)
class Batch:
    """model: all replicas. first: (K + 1,) where each begins. shift: (K,) how far each was moved along x, m."""

    model: Model
    first: np.ndarray
    shift: np.ndarray

    def x(self, state: State, k: int) -> np.ndarray:
        """Return the places of replica k in its own coordinates, (dim, N_k)."""
        places = state.x[:, self._rows(k)].copy()
        places[0] -= self.shift[k]
        return places

    def v(self, state: State, k: int) -> np.ndarray:
        """Return the velocities of replica k, (dim, N_k)."""
        return state.v[:, self._rows(k)]

    def spin(self, state: State, k: int) -> np.ndarray:
        """Return the spins of replica k, (1|3, N_k)."""
        return state.spin[:, self._rows(k)]

    def _rows(self, k: int) -> slice:
        return slice(self.first[k], self.first[k + 1])


def batch(models: Sequence[Model], *, room: float) -> Batch:
    """Return the replicas as one model, each with `room` (m) on both sides for what its particles will travel.

    Bodies pressed together at the start fly farther than their velocities tell, so the caller has to know.
    Raises ValueError for walls, rings or periodic axes, which may reach into other replicas, and for different laws;
    laws by pair of materials know the nodes of one model.
    """
    first = models[0]
    for m in models:
        if m.walls or m.rings or m.periodic is not None:
            raise ValueError("replicas: expected no walls, no rings and no periodic axes, which others may meet")
        if isinstance(m.normal, ByPair) or isinstance(m.sliding, ByPair):
            raise ValueError("replicas: expected laws with one set of numbers, got tables over pairs of materials")
        if any(getattr(m, name) != getattr(first, name) for name in _SHARED):
            raise ValueError(f"replicas: expected the same {', '.join(_SHARED)} in all")
    reach = 2.0 * (room + max(float(m.radius.max()) for m in models))
    ends = np.cumsum([0.0] + [float(np.ptp(m.x[0])) + reach for m in models])
    shift = np.array([end - float(m.x[0].min()) for end, m in zip(ends, models, strict=False)])
    arrays = {name: np.concatenate([getattr(m, name) for m in models], axis=-1)
              for name in ("x", "v", "spin", "radius", "mass", "inertia")}
    counts = [m.particle_count for m in models]
    arrays["x"][0] += np.repeat(shift, counts)
    return Batch(model=replace(first, **arrays), first=np.cumsum([0, *counts]), shift=shift)
