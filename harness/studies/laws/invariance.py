"""Which conventions are known to depend on the frame, why, and by how much at most.

A rule says for which conventions, motions, frames and laws; what no rule names must be invariant to rounding.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING

from harness.scene.contact import ConstantRolling, MindlinSliding, SpringRolling, SpringSliding

if TYPE_CHECKING:
    from harness.studies.laws.cases import Laws

FRAME_TOLERANCE = 1e-11
"""Coordinates in two frames are rounded differently, by 1e-13 of the overlaps; sqrt(overlap) near first touch makes
1e-12 of it. A frame that matters changes the answer in the first four digits."""

ROTATING = ("turning", "tumbling")


@dataclass(frozen=True, kw_only=True)
class Dependence:
    """A known dependence on the frame. limit: the largest deviation that it explains, relative.

    conventions, frames, motions: None stands for all.
    """

    reason: str
    limit: float
    concerns: Callable[[Laws], bool]
    conventions: tuple[str, ...] | None = None
    frames: tuple[str, ...] | None = None
    motions: tuple[str, ...] | None = None

    def explains(self, laws: Laws, convention: str, motion: str, frame: str) -> bool:
        """Say whether this is about such a case."""
        asked = ((self.conventions, convention), (self.frames, frame), (self.motions, motion))
        return all(among is None or word in among for among, word in asked) and self.concerns(laws)


def known_dependence(laws: Laws, convention: str, motion: str, frame: str) -> Dependence | None:
    """Return the widest rule for a case, None if it must be invariant."""
    found = [d for d in DEPENDENCES if d.explains(laws, convention, motion, frame)]
    return max(found, key=lambda d: d.limit, default=None)


def _slides(laws: Laws) -> bool:
    return laws.sliding is not None


def _rolls_by_spring(laws: Laws) -> bool:
    return isinstance(laws.rolling, SpringRolling)


def _springs(laws: Laws) -> bool:
    return isinstance(laws.sliding, SpringSliding | MindlinSliding) or _rolls_by_spring(laws)


DEPENDENCES = (
    Dependence(
        conventions=("lammps",), frames=ROTATING, concerns=_slides, limit=2.0,
        reason="slip is measured at R, not at the contact: a pair that only turns slips by overlap x rate, and "
        "friction answers",
    ),
    Dependence(
        conventions=("liggghts",), frames=("turning",), concerns=_springs, limit=2e-3,
        reason="the spring is projected on the turned plane and loses (angle)^2/2 of its length a row",
    ),
    Dependence(
        frames=ROTATING, motions=("mixed",), concerns=_springs, limit=5e-2,
        reason="projection turns a spring that lies askew to the rotation only to second order in the angle of a row",
    ),
    Dependence(
        conventions=("liggghts",), frames=ROTATING, motions=("roll", "mixed"), concerns=_rolls_by_spring, limit=1.0,
        reason="the rolling spring is kept along axes fixed in space and does not follow the pair",
    ),
    Dependence(
        conventions=("talk",), motions=("shear", "roll", "twist"), limit=0.5,
        concerns=lambda laws: _springs(laws) or laws.torsion is not None,
        reason="sliding leaves the spring exactly at the limit: whether the next row sticks, and the spring is one "
        "step longer, is decided by rounding",
    ),
    Dependence(
        conventions=("talk", "lammps", "corrected"), motions=("twist",), limit=1.0,
        concerns=lambda laws: isinstance(laws.rolling, ConstantRolling),
        reason="the couple has full size at any rate of rolling: without rolling its direction is decided by rounding",
    ),
)
