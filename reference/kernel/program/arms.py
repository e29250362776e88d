"""Lever arms of slip and torque, which codes take differently."""

from __future__ import annotations

import numpy as np

from reference.kernel.program.buffers import filled
from reference.kernel.program.contacts import Contacts
from reference.kernel.program.program import Program


def lever_arms(p: Program, c: Contacts, name: str, *, pairs: str, walls: str) -> np.ndarray:
    """Return a at the `ends`, (2, P): the radii, or the buffer `name`, which holds R - overlap/2 during the step.

    pairs, walls: "radius" or "reduced", the convention's arm there.
    """
    if pairs == walls == "radius":
        return c.radius
    arms, half = c.buffer(name, 2), c.a
    p(np.multiply, c.overlap, _share_of_overlap(c, pairs, walls), out=half)
    for radius, arm in zip(c.radius, arms, strict=True):
        p(np.subtract, radius, half, out=arm)
    return arms


def _share_of_overlap(c: Contacts, pairs: str, walls: str) -> float | np.ndarray:
    """Return what the radius is reduced by, over the overlap: 1/2 or 0, (P,) where that is not one number for all."""
    of_pairs, of_walls = (0.5 if arm == "reduced" else 0.0 for arm in (pairs, walls))
    if of_pairs == of_walls or c.particle_pairs.stop == c.count:
        return of_pairs
    share = filled(of_walls, c.count)
    share[c.particle_pairs] = of_pairs
    return share
