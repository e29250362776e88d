"""What springs have as components: one signed number, or a vector in the tangent plane.

`slider` is written in these operations, so that sticking and sliding are the same in 2D, in 3D and about the normal.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Protocol

import numpy as np

from reference.kernel.program.program import Program

if TYPE_CHECKING:
    from reference.kernel.program.contacts import Contacts

TINY = 1e-200
"""Keeps quotients of zeros finite; no force of interest is as small."""


class Components(Protocol):
    """Amounts v of P contacts, (P,) or (3, P), and a slider's operations on them. work: a buffer of their shape."""

    work: np.ndarray

    def buffer(self, name: str) -> np.ndarray:
        """Return the buffer of that name, in the amounts' shape."""

    def size(self, p: Program, v: np.ndarray, out: np.ndarray) -> None:
        """out = |v|, (P,)."""

    def cut(
        self, p: Program, v: np.ndarray, limit: np.ndarray, out: np.ndarray, *, stuck: np.ndarray | None = None,
        slides_at_zero: bool = False,
    ) -> None:
        """out = v, of size `limit` where it is longer. `limit` is used up.

        stuck = 1 where it is not longer, else 0; v and out are then two buffers. slides_at_zero: nor where limit = 0.
        """

    def turn(self, p: Program, v: np.ndarray, *, keep_length: bool, above: tuple[np.ndarray, float] | None) -> None:
        """Turn v at right angles to the normal of now.

        keep_length: lengthen again what has become shorter. above: a limit, (P,), and a fraction of it; what has no
        more than that along the normal stays as it is.
        """


class Numbers:
    """One signed number a contact, on which turning leaves no mark: what acts about the normal, or about z in 2D."""

    def __init__(self, c: Contacts):
        self.workspace, self.count, self.work = c.workspace, c.count, c.b

    def buffer(self, name: str) -> np.ndarray:
        """Return the (P,) buffer of that name."""
        return self.workspace.rows(name, self.count)

    def size(self, p: Program, v: np.ndarray, out: np.ndarray) -> None:
        """out = |v|."""
        p(np.abs, v, out=out)

    def cut(
        self, p: Program, v: np.ndarray, limit: np.ndarray, out: np.ndarray, *, stuck: np.ndarray | None = None,
        slides_at_zero: bool = False,
    ) -> None:
        """out = v between -limit and limit."""
        if slides_at_zero:
            p(np.abs, v, out=stuck)
            p(np.maximum, stuck, TINY, out=stuck)
            p(np.less_equal, stuck, limit, out=stuck)
        p(np.minimum, v, limit, out=out)
        p(np.negative, limit, out=limit)
        p(np.maximum, out, limit, out=out)
        if stuck is not None and not slides_at_zero:
            p(np.equal, v, out, out=stuck)

    def turn(self, p: Program, v: np.ndarray, *, keep_length: bool, above: tuple[np.ndarray, float] | None) -> None:
        """Nothing to do."""
        del p, v, keep_length, above
