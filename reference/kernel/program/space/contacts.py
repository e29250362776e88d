"""Buffers of 3D contacts."""

from __future__ import annotations

import numpy as np

from reference.kernel.model import Model
from reference.kernel.program.buffers import empty, filled
from reference.kernel.program.contacts import Contacts
from reference.kernel.program.vectors import Vectors


class SpaceContacts(Contacts):
    """normal, z, force: (3, P). u: (3, P) velocity of the centres, then slip. z is free for work.

    lag: by how much normals are turned back for the slip, s, one number or (P,), 0 at walls; None where the convention
    takes them as they are.
    """

    def __init__(self, model: Model, *args):
        super().__init__(model, *args)
        self.lag = self._lag(model)
        self.normal, self.u, self.z = (self.buffer(name, 3) for name in ("normal", "u", "z"))
        self.v_n = self.buffer("v_n")
        self.tangents = Vectors(self, self.normal, self.z)

    def _lag(self, model: Model) -> float | np.ndarray | None:
        if model.sliding is None or model.convention.slip_normal == "end" or not model.lag:
            return None
        if self.particle_pairs.stop == self.count:
            return model.lag
        lag = filled(0.0, self.count)
        lag[self.particle_pairs] = model.lag
        return lag

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
