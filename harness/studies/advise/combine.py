"""Errors and times of several knobs together, from ladders that were climbed one knob at a time.

A setting turns several knobs. Of each the error against its own limit is known, e_k +- b_k, and its time over that of
the scene as declared, r_k. Together::

    error    E(P) = sum of |e_k| that are seen + sqrt(sum b_k^2 + sum of e_k^2 that are not seen + s^2/P)
    time     T = P t prod r_k

e_k is seen if it is more than 2 b_k. Seen errors are added as if all had one sign: they may cancel, but nothing says
that they do. Errors that do not stand out of the noise are noise, and are added in quadrature like the standard errors
and the scatter s of one packing over the P packings that the user makes. Both rules are of first order: that knobs do
not act on each other was not measured, a run of the whole setting decides (`verify`). So was the product of times.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

from harness.scene.judged import MOST_PACKINGS


@dataclass(frozen=True, kw_only=True)
class Part:
    """What one knob, or the effects left out, brings: error (signed), its standard error, time over as declared."""

    name: str
    error: float
    bar: float
    ratio: float

    @property
    def seen(self) -> bool:
        """Whether the error stands out of its own."""
        return abs(self.error) > 2.0 * self.bar


@dataclass(frozen=True, kw_only=True)
class Total:
    """systematic: sum of seen errors. noise: the rest but for the user's own scatter. spread: of one packing."""

    systematic: float
    noise: float
    spread: float

    def error(self, packings: int) -> float:
        """Return E(P)."""
        return self.systematic + math.hypot(self.noise, self.spread / math.sqrt(packings))

    @property
    def of_knobs(self) -> float:
        """E without the user's own scatter, which no more packings bring down."""
        return self.systematic + self.noise

    def packings_for(self, tolerance: float) -> int | None:
        """Return the least P with E(P) <= tolerance, None if there is none up to MOST_PACKINGS."""
        left = tolerance - self.systematic
        if left < 0.0 or left < self.noise or (left == self.noise and self.spread > 0.0):
            return None
        if self.spread == 0.0:
            return 1
        count = max(1, math.ceil(self.spread**2 / (left**2 - self.noise**2) * (1.0 - 1e-12)))
        return count if count <= MOST_PACKINGS else None


def total(parts: Sequence[Part], spread: float) -> Total:
    """Combine the parts, see the module."""
    return Total(
        systematic=sum(abs(p.error) for p in parts if p.seen),
        noise=math.sqrt(sum(p.bar**2 + (0.0 if p.seen else p.error**2) for p in parts)), spread=spread,
    )


def time_ratio(parts: Sequence[Part]) -> float:
    """Return the product of times over as declared."""
    return math.prod(p.ratio for p in parts)
