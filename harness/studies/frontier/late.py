"""How long motions are followed where springs are felt late: theory says how fast they grow.

Beyond their limit such motions may grow by parts of a thousand in a step. A look has to last until they are seen, and
not longer: a code that knows of it may refuse to begin a long run.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

from harness.studies.frontier.probe import FRAMES, STEPS
from harness.studies.frontier.theory import TOLERANCE
from reference.analytic.packing_modes import ROUNDING, Packing

VISIBLE = 1e4
"""Factor by which the kinetic energy of the fastest motion grows within a look; the kernel's own watch ends a run once
it could have grown by exp(2) (`reference.kernel.guards`)."""

LATE_STEPS = 60_000
"""Of a look, at most."""

TYPICAL = 8_000
"""Of a look, on the mean, for estimates (measured)."""

NEAR = 0.005
"""Of the limit: how far beyond it growth would be seen by a look at or below it."""


@dataclass(frozen=True, kw_only=True)
class Followed:
    """Motions of a packing whose springs are felt late. limit: of theory, s, 0 where every step lets them grow.

    lowest: the smallest step that is looked at, s.
    """

    packing: Packing
    limit: float
    lowest: float

    def steps(self, dt: float) -> int:
        """Return the steps of a look at a step of dt, s: those in which the energy grows by VISIBLE.

        At and below the limit those of a step NEAR beyond it. At least STEPS, at most LATE_STEPS.
        """
        grown = self.until_seen(max(dt, (1 + NEAR) * self.limit))
        return int(min(max(STEPS, FRAMES * math.ceil(min(grown, LATE_STEPS) / FRAMES)), LATE_STEPS))

    def until_seen(self, dt: float) -> float:
        """Return after how many steps the energy of the fastest motion has grown by VISIBLE, inf if it never has."""
        growth = self.packing.growth(dt)
        return 0.5 * math.log(VISIBLE) / math.log(growth) if growth > 1 + ROUNDING else math.inf

    def unseen(self) -> str:
        """Return why no look can tell what is stable, "" if looks can."""
        at = (1 + TOLERANCE) * self.limit or self.lowest
        grown = self.until_seen(at)
        if grown <= LATE_STEPS:
            return ""
        said = f"by e in {2 * grown / math.log(VISIBLE):.3g} steps" if math.isfinite(grown) else "by nothing"
        where = f"{100 * TOLERANCE:g} per cent beyond the limit of theory" if self.limit else f"at dt = {at:.3g} s"
        return f"{where} motions grow {said}, which {LATE_STEPS} steps do not show"
