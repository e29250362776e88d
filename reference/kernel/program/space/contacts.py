"""Buffers of 3D contacts."""

from __future__ import annotations

import numpy as np

from reference.kernel.program.buffers import empty
from reference.kernel.program.contacts import Contacts
from reference.kernel.program.vectors import Vectors


class SpaceContacts(Contacts):
    """normal, z, force: (3, P). u: (3, P) velocity of the centres, then slip. z is free for work."""

    def __init__(self, *args):
        super().__init__(*args)
        self.normal, self.u, self.z = (self.buffer(name, 3) for name in ("normal", "u", "z"))
        self.v_n = self.buffer("v_n")
        self.tangents = Vectors(self, self.normal, self.z)

    @staticmethod
    def new_forces(count: int) -> np.ndarray:
        """Return vectors, (3, P)."""
        return empty(3, count)

    @staticmethod
    def new_couples(count: int) -> np.ndarray:
        """Return vectors, (3, P)."""
        return empty(3, count)

    @staticmethod
    def vectors(force: np.ndarray) -> np.ndarray:
        """Return vectors as they are."""
        return force
