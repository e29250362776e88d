"""Buffers of 2D contacts, as complex numbers."""

from __future__ import annotations

import numpy as np

from reference.kernel.program.contacts import Contacts


class PlaneContacts(Contacts):
    """u: (P,) v_n + i v_t. g: (P,) f_n + i f_t. normal: (P,) conj(n). z: work, and at the end conj(force on i)."""

    def __init__(self, *args):
        super().__init__(*args)
        self.u, self.g, self.normal, self.z = (np.empty(self.count, complex) for _ in range(4))
        self.v_n, self.v_t = self.u.real, self.u.imag

    def force_on_i(self, rows: np.ndarray) -> np.ndarray:
        """Force on i in the last step, (2, M)."""
        return np.stack([self.z[rows].real, -self.z[rows].imag])

    def spring(self, rows: np.ndarray, tension: np.ndarray) -> np.ndarray:
        """Vectors, (2, M), along t = i n of sizes (1, M)."""
        n = self.normal[rows]
        return tension * np.stack([n.imag, n.real])

    def remember_normals(self) -> None:
        """Keep the normals of now for laws that ask how far a contact has turned since the last step."""
        self.normal_before = self.normal.copy()
