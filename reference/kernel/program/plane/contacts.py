"""Buffers of 2D contacts, as complex numbers."""

from __future__ import annotations

import numpy as np

from reference.kernel.program.buffers import empty, filled
from reference.kernel.program.contacts import Contacts
from reference.kernel.program.plane.tangents import Tangents


class PlaneContacts(Contacts):
    """normal: (P,) conj(n). z: (P,) complex, work, and at the end conj(force on i). inverse: (P,) 1/|d| + 0i.

    u: (P,) v_n + i v_t of the centres, and at the end the force on i in the frame of the contact.
    """

    def __init__(self, *args):
        super().__init__(*args)
        self.normal, self.z, self.u = (empty(self.count, dtype=complex) for _ in range(3))
        self.inverse = filled(0.0, self.count, dtype=complex)
        self.v_n = self.u.real
        self.tangents = Tangents(self.normal, self.b)

    def force_on_i(self, rows: np.ndarray) -> np.ndarray:
        """Return the force on i in the last step, (2, M)."""
        return np.stack([self.z[rows].real, -self.z[rows].imag])

    def spring(self, rows: np.ndarray, tension: np.ndarray) -> np.ndarray:
        """Return vectors, (2, M), along t = i n of signed sizes (1, M)."""
        n = self.normal[rows]
        return tension * np.stack([n.imag, n.real])

    def tension(self, rows: np.ndarray, spring: np.ndarray) -> np.ndarray:
        """Return signed sizes along t, (1, M), of vectors (2, M)."""
        n = self.normal[rows]
        return (spring[0] * n.imag + spring[1] * n.real)[None]
