"""Buffers of 3D contacts."""

from __future__ import annotations

import numpy as np

from reference.kernel.program.contacts import Contacts


class SpaceContacts(Contacts):
    """normal: (3, P). v_n: (P,). v_t: (3, P), velocity, then slip. g: (3, P) force on i. z: (3, P) work."""

    def __init__(self, *args):
        super().__init__(*args)
        self.normal, self.v_t, self.g, self.z = (np.empty((3, self.count)) for _ in range(4))
        self.v_n = np.empty(self.count)

    def force_on_i(self, rows: np.ndarray) -> np.ndarray:
        """Force on i in the last step, (3, M)."""
        return self.g[:, rows]

    def spring(self, rows: np.ndarray, tension: np.ndarray) -> np.ndarray:
        """Tensions are vectors already, (3, M)."""
        del rows
        return tension

    def remember_normals(self) -> None:
        """A tension that is a vector needs no normal of before."""
