"""Which conventions are known to depend on the frame, why, and by how much.

A rule says for which conventions, motions, frames and laws; what no rule names must be invariant to rounding. A rule
either leads to a prediction, row by row, of the answer in that frame (`stepped`), which must then be met to rounding,
or to a bound, where rounding decides.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from harness.scene.contact import ConstantRolling, MindlinSliding, SpringRolling, SpringSliding
from harness.studies.laws.closed_forms import contact_of, expected, limit_base, normal_force

if TYPE_CHECKING:
    from harness.studies.laws.arrangement import Arrangement
    from harness.studies.laws.cases import Laws
    from harness.studies.laws.motions import Motion
    from reference.kernel.conventions import Convention

FRAME_TOLERANCE = 1e-12
"""Arithmetic in doubles resolves an overlap to 1e-13 of it, and slip to 1e-16 of the speed at which bodies turn. A
frame that matters changes the answer in the first four digits."""

ROTATING = ("turning", "tumbling")

Room = tuple[np.ndarray | float, np.ndarray | float]
"""By how much force (N) and torque (N m) may differ, numbers or (S, bodies, 3)."""


@dataclass(frozen=True, kw_only=True)
class Dependence:
    """A known dependence on the frame. conventions, frames, motions: None stands for all.

    bound: the largest difference that the reason explains, of a motion in the plain frame; None where the answer in the
    other frame can be predicted.
    """

    reason: str
    concerns: Callable[[Laws], bool]
    conventions: tuple[str, ...] | None = None
    frames: tuple[str, ...] | None = None
    motions: tuple[str, ...] | None = None
    bound: Callable[[Laws, Arrangement, Motion, Convention], Room] | None = None

    def explains(self, laws: Laws, convention: str, motion: str, frame: str) -> bool:
        """Say whether this is about such a case."""
        asked = ((self.conventions, convention), (self.frames, frame), (self.motions, motion))
        return all(among is None or word in among for among, word in asked) and self.concerns(laws)


def known_dependences(laws: Laws, convention: str, motion: str, frame: str) -> tuple[Dependence, ...]:
    """Return the rules about a case, none if it must be invariant."""
    return tuple(d for d in DEPENDENCES if d.explains(laws, convention, motion, frame))


def _slides(laws: Laws) -> bool:
    return laws.sliding is not None


def _slides_by_spring(laws: Laws) -> bool:
    return isinstance(laws.sliding, SpringSliding | MindlinSliding)


def _rolls_by_spring(laws: Laws) -> bool:
    return isinstance(laws.rolling, SpringRolling)


def _springs(laws: Laws) -> bool:
    return _slides_by_spring(laws) or _rolls_by_spring(laws)


def _limits_both_ways(laws: Laws, a: Arrangement, motion: Motion, convention: Convention) -> Room:
    """Twice the limits, where closed forms do not determine the answer; nothing elsewhere."""
    c = contact_of(motion, a.partner, a.grains, convention)
    base = limit_base(laws.normal, c, normal_force(laws.normal, c))
    base = np.nan_to_num(base, nan=np.nanmax(base))[:, None, None]
    force, torque = (np.isnan(e) for e in expected(laws, motion, a.partner, a.grains, convention))
    slide = laws.sliding.shear_friction if force.any() else 0.0
    roll, twist = (c.reduced_radius * mu for mu in _coefficients(laws))
    couples = max(a.grains.radii) * slide + np.array([twist, roll, roll])
    return 2.0 * slide * base * force, 2.0 * couples * base * torque


def _coefficients(laws: Laws) -> tuple[float, float]:
    """Of rolling and of torsion, zero for what there is not."""
    roll = laws.rolling.rolling_friction if laws.rolling else 0.0
    return roll, laws.torsion.torsion_friction if laws.torsion else 0.0


def _whole_couple(laws: Laws, a: Arrangement, motion: Motion, convention: Convention) -> Room:
    """The couple of constant size: mu_r a* f."""
    c = contact_of(motion, a.partner, a.grains, convention)
    elastic = normal_force(laws.normal, c, damped=False)
    return 0.0, laws.rolling.rolling_friction * c.reduced_radius * float(np.abs(elastic).max())


DEPENDENCES = (
    Dependence(
        conventions=("lammps",), frames=ROTATING, concerns=_slides,
        reason="slip is measured at R, not at the contact: a pair that only turns slips by overlap x rate, and "
        "friction answers",
    ),
    Dependence(
        conventions=("liggghts",), frames=ROTATING, concerns=_slides_by_spring,
        reason="the spring is projected on the turned plane and loses (angle)^2/2 of its length a row",
    ),
    Dependence(
        frames=ROTATING, motions=("mixed",), concerns=_springs,
        reason="projection turns a spring that lies askew to the turn to second order in the angle of a row only, and "
        "not at all about the normal",
    ),
    Dependence(
        conventions=("liggghts",), frames=("tumbling",), motions=("roll", "mixed"), concerns=_rolls_by_spring,
        reason="the rolling spring is kept along axes fixed in space and does not follow the pair",
    ),
    Dependence(
        conventions=("talk",), motions=("shear", "roll", "twist"), bound=_limits_both_ways,
        concerns=lambda laws: _springs(laws) or laws.torsion is not None,
        reason="a spring that has slid carries exactly the limit: whether it sticks in the next row, and so follows a "
        "slip that turns round, is decided by rounding; at most twice the limit, from the turn on",
    ),
    Dependence(
        conventions=("talk", "lammps", "corrected"), motions=("twist",), bound=_whole_couple,
        concerns=lambda laws: isinstance(laws.rolling, ConstantRolling),
        reason="the couple has full size at any rate of rolling: without rolling its direction is decided by rounding; "
        "at most mu_r R* f_n",
    ),
)
