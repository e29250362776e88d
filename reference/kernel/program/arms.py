"""Lever arms of slip and torque, which codes take differently."""

from __future__ import annotations

import numpy as np

from reference.kernel.program.contacts import Contacts
from reference.kernel.program.program import Program


class LeverArms:
    """a_i, a_j of slip or torque: arrays of radii, or buffers that hold R - overlap/2 during the step."""

    def __init__(self, p: Program, c: Contacts, *, pairs: str, walls: str):
        """`pairs`, `walls`: "radius" or "reduced", the convention's arm there."""
        self.i, self.j = c.radius_i, c.radius_j
        kinds = {"reduced": pairs, "walls": walls}
        where = _reduced_part(c, kinds["reduced"], kinds["walls"])
        if where is None:
            return
        self.i, self.j, half = c.radius_i.copy(), c.radius_j.copy(), np.empty(c.count)[where]
        p(np.multiply, c.overlap[where], 0.5, out=half)
        p(np.subtract, c.radius_i[where], half, out=self.i[where])
        p(np.subtract, c.radius_j[where], half, out=self.j[where])


def _reduced_part(c: Contacts, pairs: str, walls: str) -> slice | None:
    """Which pairs have the arm R - overlap/2: all, the particle pairs, the wall pairs, or none."""
    if pairs == walls:
        return slice(0, c.count) if pairs == "reduced" else None
    return c.particle_pairs if pairs == "reduced" else slice(c.particle_pairs.stop, c.count)
