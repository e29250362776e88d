"""Buffers of 2D contacts, as complex numbers."""

from __future__ import annotations

from functools import cached_property

import numpy as np

from reference.kernel.program.buffers import empty
from reference.kernel.program.contacts import Contacts
from reference.kernel.program.plane.tangents import Tangents
from reference.kernel.program.plane.vectors import PlaneVectors


class PlaneContacts(Contacts):
    """normal: (P,) conj(n). force: (P,) conj(force on i). inverse: (P,) 1/|d| + 0i.

    u: (P,) v_n + i v_t of the centres, and at the end the force on i in the frame of the contact.
    """

    def __init__(self, *args):
        super().__init__(*args)
        self.normal, self.u, self.inverse = (self.buffer(k, dtype=complex) for k in ("normal", "u", "inverse"))
        self.inverse.imag = 0.0
        self.v_n = self.u.real
        self.tangents = Tangents(self)

    @cached_property
    def lagging_vectors(self) -> PlaneVectors:
        """Springs as vectors."""
        return PlaneVectors(self)

    @staticmethod
    def new_forces(count: int) -> np.ndarray:
        """Return complex numbers, (P,)."""
        return empty(count, dtype=complex)

    @staticmethod
    def new_couples(count: int) -> np.ndarray:
        """Return numbers, (P,)."""
        return empty(count)

    @staticmethod
    def vectors(force: np.ndarray) -> np.ndarray:
        """Return (2, M) of conjugate complex numbers (M,)."""
        return np.stack([force.real, -force.imag])
