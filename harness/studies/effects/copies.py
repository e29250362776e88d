"""A few bodies many times: copies side by side in one system, so that a step is long enough to be timed."""

from __future__ import annotations

import numpy as np

from harness.scene.system import System

BODIES = 100
"""In all copies, about; scenes of as many are timed as they are."""


def copies(system: System) -> System:
    """Return copies of a small system along an axis that no wall looks at, too far apart to meet.

    Larger systems, those with a periodic axis, and those that walls close along every axis come back as they are.
    """
    p = system.particles
    count = BODIES // len(p)
    free = [a for a in range(system.dimension) if all(w.normal[a] == 0.0 for w in system.walls)]
    if count < 2 or not free or system.periodic is not None or system.rings:
        return system
    axis = free[0]
    speed = float(np.linalg.norm(p.v, axis=1).max(initial=0.0))
    pitch = float(np.ptp(p.x[:, axis])) + 4.0 * float(p.radius.max()) + 4.0 * speed * system.dt * system.steps
    many = p.rows(np.tile(np.arange(len(p)), count))
    many.x[:, axis] += np.repeat(pitch * np.arange(count), len(p))
    return system.with_(particles=many)
