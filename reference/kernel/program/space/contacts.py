"""Buffers of 3D contacts."""

from __future__ import annotations

import numpy as np

from reference.kernel.program.buffers import empty
from reference.kernel.program.contacts import Contacts
from reference.kernel.program.space.vectors import Vectors


class SpaceContacts(Contacts):
    """normal, z: (3, P). u: (3, P) velocity of the centres, and at the end the force on i. z is free for work."""

    def __init__(self, *args):
        super().__init__(*args)
        self.normal, self.u, self.z = (empty(3, self.count) for _ in range(3))
        self.v_n = empty(self.count)
        self.tangents = Vectors(self.normal, self.z)

    def force_on_i(self, rows: np.ndarray) -> np.ndarray:
        """Return the force on i in the last step, (3, M)."""
        return self.u[:, rows]

    def spring(self, rows: np.ndarray, tension: np.ndarray) -> np.ndarray:
        """Return tensions as they are: vectors, (3, M)."""
        del rows
        return tension

    def tension(self, rows: np.ndarray, spring: np.ndarray) -> np.ndarray:
        """Return springs as they are: vectors, (3, M)."""
        del rows
        return spring
