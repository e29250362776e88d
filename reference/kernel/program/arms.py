"""Lever arms of slip and torque, which codes take differently."""

from __future__ import annotations

import numpy as np

from reference.kernel.program.buffers import lined_up
from reference.kernel.program.contacts import Contacts
from reference.kernel.program.program import Program


def lever_arms(p: Program, c: Contacts, *, pairs: str, walls: str) -> np.ndarray:
    """Return a of i and of j, (2, P): the radii, or a buffer that holds R - overlap/2 during the step.

    pairs, walls: "radius" or "reduced", the convention's arm there.
    """
    reduced = _reduced_part(c, pairs, walls)
    if reduced is None:
        return c.radius
    arms, half = lined_up(c.radius), c.a[reduced]
    p(np.multiply, c.overlap[reduced], 0.5, out=half)
    p(np.subtract, c.radius[:, reduced], half, out=arms[:, reduced])
    return arms


def _reduced_part(c: Contacts, pairs: str, walls: str) -> slice | None:
    """Which pairs have the arm R - overlap/2: all, the particle pairs, the wall pairs, or none."""
    if pairs == walls:
        return slice(0, c.count) if pairs == "reduced" else None
    return c.particle_pairs if pairs == "reduced" else slice(c.particle_pairs.stop, c.count)
