"""Springs in 2D that are vectors, because they are not turned in every step: see `program.slider.LAGGING`."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from reference.kernel.program.program import Program
from reference.kernel.program.vectors import Vectors, dot

if TYPE_CHECKING:
    from reference.kernel.program.plane.contacts import PlaneContacts


class PlaneVectors(Vectors):
    """Vectors (2, P) in the plane, and the numbers along t = i n that they are while they are turned."""

    def __init__(self, c: PlaneContacts):
        super().__init__(c, c.buffer("normal vector", 2), c.buffer("z", 2))
        self.conjugate = c.normal
        self.tangent = c.normal.imag, c.normal.real

    def find_normals(self, p: Program) -> None:
        """Write n, of which the contact has the conjugate."""
        p.copy(self.conjugate.real, self.normal[0])
        p(np.negative, self.conjugate.imag, out=self.normal[1])

    def along_tangent(self, p: Program, amounts: np.ndarray, name: str) -> np.ndarray:
        """Return amounts (P,) times t in the buffer of that name."""
        vectors = self.buffer(name)
        for component, row in zip(self.tangent, vectors, strict=True):
            p(np.multiply, amounts, component, out=row)
        return vectors

    def find_amounts(self, p: Program, vectors: np.ndarray, out: np.ndarray) -> None:
        """out = v.t."""
        for row, component, product in zip(vectors, self.tangent, self.z, strict=True):
            p(np.multiply, row, component, out=product)
        p(np.add, self.z[0], self.z[1], out=out)

    def find_part_along_normal(self, p: Program, vectors: np.ndarray) -> np.ndarray:
        """Return v.n, (P,), which stays until the next step."""
        part = self.workspace.rows("part along normal", self.count)
        dot(p, vectors, self.normal, self.z, out=part)
        return part
