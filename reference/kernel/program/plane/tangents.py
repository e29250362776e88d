"""Amounts along the tangent t = i n, which turns with the contact: while its length is kept, each is one number."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from reference.kernel.program.components import Numbers
from reference.kernel.program.program import Program

if TYPE_CHECKING:
    from reference.kernel.program.plane.contacts import PlaneContacts


class Tangents(Numbers):
    """Signed numbers along t. The contacts' normals are those of now when the program is composed."""

    def __init__(self, c: PlaneContacts):
        super().__init__(c)
        self.normal = c.normal
        self.turned: np.ndarray | None = None

    def turn(self, p: Program, v: np.ndarray, *, keep_length: bool, above: tuple[np.ndarray, float] | None) -> None:
        """v *= cos(turn since the last step), unless the length is kept."""
        del above
        if keep_length:
            return
        if self.turned is None:
            self._follow(p)
        p(np.multiply, v, self.turned.real, out=v)

    def _follow(self, p: Program) -> None:
        """turned = n before conj(n)."""
        before, self.turned = np.conjugate(self.normal), self.workspace.rows("turned", self.count, dtype=complex)
        p(np.multiply, before, self.normal, out=self.turned)
        p(np.conjugate, self.normal, out=before)
