"""How far apart two answers are: the largest difference over all rows and bodies, of force and of torque.

Force is taken relative to the largest force of that motion, torque relative to its largest torque. Torques that are
nearly none are taken relative to a tenth of R* times the largest force, about what rolling resistance exerts.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from harness.studies.laws.arrangement import Arrangement

SMALL_TORQUE = 0.1

Answer = Sequence[np.ndarray]
"""Force and torque, (S, bodies, 3) each, in the contact's axes."""

Sizes = tuple[float, float]
"""Of force (N) and torque (N m)."""


@dataclass(frozen=True, kw_only=True)
class Deviation:
    """Largest relative difference, and where it was found."""

    size: float
    part: str
    frame: str


def worst(found: Iterable[Deviation]) -> Deviation:
    """Return the largest; one that is not a number is larger than all."""
    return max(found, key=lambda d: np.inf if np.isnan(d.size) else d.size)


def sizes_of(answers: Sequence[Answer], a: Arrangement) -> Sizes:
    """Return the largest force and the largest torque, or what stands for it."""
    force, torque = (float(np.max([np.abs(answer[k]).max() for answer in answers])) for k in (0, 1))
    return force, float(np.maximum(torque, SMALL_TORQUE * a.grains.reduced_radius(a.partner) * force))


def known(answer: Answer, expected: Answer) -> Answer:
    """Return what is expected, and the answer itself where that is not determined (NaN)."""
    return [np.where(np.isnan(e), found, e) for e, found in zip(expected, answer, strict=True)]


def apart(answer: Answer, other: Answer, sizes: Sizes) -> float:
    """Return the largest relative difference of force or torque, NaN if one is; no size and no difference make zero."""
    found = [float(np.abs(x - y).max()) for x, y in zip(answer, other, strict=True)]
    return float(np.max([_relative(d, s) for d, s in zip(found, sizes, strict=True)]))


def _relative(difference: float, size: float) -> float:
    if size != 0.0:
        return difference / size
    return 0.0 if difference == 0.0 else np.inf
