"""Vectors of contacts as (dim, P) arrays: products, and springs that are turned into the tangent plane."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from reference.kernel.program.components import TINY
from reference.kernel.program.program import Program

if TYPE_CHECKING:
    from reference.kernel.program.contacts import Contacts

CYCLIC = ((0, 1, 2), (1, 2, 0), (2, 0, 1))


def dot(p: Program, u: np.ndarray, v: np.ndarray, work: np.ndarray, out: np.ndarray) -> None:
    """out = u.v, column by column; work: (dim, P)."""
    p(np.multiply, u, v, out=work)
    p(np.add, work[0], work[1], out=out)
    for product in work[2:]:
        p(np.add, out, product, out=out)


def cross(p: Program, u: np.ndarray, v: np.ndarray, work: np.ndarray, out: np.ndarray) -> None:
    """out = u x v in space, column by column; work: (P,)."""
    for x, y, z in CYCLIC:
        p(np.multiply, u[y], v[z], out=out[x])
        p(np.multiply, u[z], v[y], out=work)
        p(np.subtract, out[x], work, out=out[x])


class Vectors:
    """Vectors in the tangent plane, whose springs are turned into it step by step."""

    def __init__(self, c: Contacts, normal: np.ndarray, z: np.ndarray):
        """normal: (dim, P), where it will stand; z: (dim, P), free for work."""
        self.workspace, self.count, self.normal, self.z = c.workspace, c.count, normal, z
        self.work = self.buffer("work")
        self.along, self.squared = c.buffer("along"), c.buffer("squared")

    def buffer(self, name: str) -> np.ndarray:
        """Return the (dim, P) buffer of that name."""
        return self.workspace.rows(name, len(self.normal), self.count)

    def size(self, p: Program, v: np.ndarray, out: np.ndarray) -> None:
        """out = |v|."""
        dot(p, v, v, self.z, out=out)
        p(np.sqrt, out, out=out)

    def cut(
        self, p: Program, v: np.ndarray, limit: np.ndarray, out: np.ndarray, *, stuck: np.ndarray | None = None,
        slides_at_zero: bool = False,
    ) -> None:
        """out = v min(1, limit/|v|)."""
        size = self.along
        self.size(p, v, size)
        if stuck is not None and not slides_at_zero:
            p(np.less_equal, size, limit, out=stuck)
        p(np.maximum, size, TINY, out=size)
        if slides_at_zero:
            p(np.less_equal, size, limit, out=stuck)
        p(np.divide, limit, size, out=limit)
        p(np.minimum, limit, 1.0, out=limit)
        p(np.multiply, v, limit, out=out)

    def turn(self, p: Program, spring: np.ndarray, *, keep_length: bool, above: tuple | None) -> None:
        """T -= (T.n) n, then T *= |T before|/|T|."""
        along, squared = self.along, self.squared
        if keep_length:
            dot(p, spring, spring, self.z, out=squared)
        dot(p, spring, self.normal, self.z, out=along)
        if above is not None:
            self._only_above(p, *above)
        p(np.multiply, self.normal, along, out=self.z)
        p(np.subtract, spring, self.z, out=spring)
        if keep_length:
            p(np.multiply, along, along, out=along)
            p(np.subtract, squared, along, out=along)
            p(np.maximum, along, TINY, out=along)
            p(np.divide, squared, along, out=along)
            p(np.sqrt, along, out=along)
            p(np.multiply, spring, along, out=spring)

    def _only_above(self, p: Program, limit: np.ndarray, fraction: float) -> None:
        """Parts along the normal that are no larger than a fraction of the limit count as none."""
        size, matters = self.work[0], self.work[1]
        p(np.multiply, limit, fraction, out=matters)
        p(np.abs, self.along, out=size)
        p(np.greater, size, matters, out=matters)
        p(np.multiply, self.along, matters, out=self.along)
