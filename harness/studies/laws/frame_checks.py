"""An engine against itself: the same motion seen from other frames, and what is known to depend on them."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from harness.studies.laws.deviations import Answer, Deviation, Sizes, apart, known, sizes_of
from harness.studies.laws.drive import Driven, part_name
from harness.studies.laws.invariance import FRAME_TOLERANCE, Dependence, known_dependences
from harness.studies.verdict import Check, Verdict
from reference.kernel.conventions import NAMED

if TYPE_CHECKING:
    from harness.studies.laws.arrangement import Arrangement, Track
    from harness.studies.laws.stepped import Stepper

PLAIN_FRAME = "itself, plain frame"


@dataclass(frozen=True, kw_only=True)
class FrameCheck(Check):
    """A check of one motion in other frames than the plain one, in 2D or in 3D.

    reason: why the answer depends on these frames, empty where it must not. Then deviation is what it changes by,
    tolerance what the reason predicts or, not `predicted`, what it explains at most, and `off` how far the answer is
    from the prediction (beyond the bound), relative: that must be rounding.
    """

    dimension: int
    reason: str
    predicted: bool
    off: float


@dataclass(frozen=True, kw_only=True)
class FrameDeviation(Deviation):
    """The deviation of a frame from the plain one. rules: why it may; off, allowed: as `off` and `tolerance` above."""

    rules: tuple[Dependence, ...]
    off: float
    allowed: float


def against_itself(
    motion: str, runs: Mapping[str, Driven], convention: str | None, stepper: Stepper, facts: dict, rerun: str
) -> list[Check]:
    """Return one check for what must be invariant, and one for each known reason why something is not, by dimension."""
    groups: dict[tuple, list[FrameDeviation]] = {}
    for run in runs.values():
        for frame in frame_deviations(run, motion, convention, stepper):
            groups.setdefault((run.job.arrangement.dimension, frame.rules), []).append(frame)
    facts = {**facts, "right": PLAIN_FRAME}
    return [_check(found, {**facts, "dimension": dimension}, rerun) for (dimension, _), found in groups.items()]


def frame_deviations(
    run: Driven, motion: str, convention: str | None, stepper: Stepper
) -> Iterator[FrameDeviation]:
    """Yield the deviation of each other frame, mapped back, from the plain one."""
    a = run.job.arrangement
    tracks = a.tracks_of(motion)
    answers = [t.local(run.reaction) for t in tracks]
    sizes = sizes_of(answers, a)
    for track, answer in zip(tracks[1:], answers[1:], strict=True):
        facts = {"size": apart(answer, answers[0], sizes), "part": part_name(a), "frame": track.frame.name}
        rules = ()
        if convention is not None and facts["size"] > FRAME_TOLERANCE:
            rules = known_dependences(stepper.laws, convention, motion, track.frame.name)
        if rules:
            off, allowed = _explained(rules, _Case(a, track, convention, stepper), answer, answers[0], sizes)
        else:
            off, allowed = facts["size"], FRAME_TOLERANCE
        yield FrameDeviation(**facts, rules=rules, off=off, allowed=allowed)


class _Case(NamedTuple):
    """One motion in one frame, in a convention."""

    arrangement: Arrangement
    track: Track
    convention: str
    stepper: Stepper

    def predicted(self) -> Answer:
        motion, frame = self.track.motion.name, self.track.frame.name
        return self.stepper.answers(self.arrangement, motion, self.convention)[frame]

    def room(self, rules: Sequence[Dependence]) -> list[np.ndarray]:
        """Return what bounds leave open of force and torque, arrays that broadcast to them."""
        of = (self.stepper.laws, self.arrangement, self.track.motion, NAMED[self.convention])
        bounds = [r.bound(*of) for r in rules if r.bound is not None]
        return [np.asarray(sum(b[k] for b in bounds)) for k in (0, 1)]


def _explained(
    rules: Sequence[Dependence], case: _Case, answer: Answer, plain: Answer, sizes: Sizes
) -> tuple[float, float]:
    """Return how far a frame's answer is from what the rules lead to expect, and how far that is from the plain frame.

    Where rounding decides, it decides in the prediction, too: the bound then counts twice.
    """
    predicted = is_predicted(rules)
    expected = known(answer, case.predicted()) if predicted else plain
    room = [(1 + predicted) * r for r in case.room(rules)]
    off = [np.maximum(np.abs(x - e) - r, 0.0) for x, e, r in zip(answer, expected, room, strict=True)]
    largest = max(float(r.max()) / s for r, s in zip(room, sizes, strict=True))
    return apart(off, np.zeros_like(off), sizes), apart(expected, plain, sizes) if predicted else largest


def is_predicted(rules: Sequence[Dependence]) -> bool:
    """Do the rules lead to a prediction, or to a bound alone?"""
    return any(r.bound is None for r in rules)


def _check(found: Sequence[FrameDeviation], facts: dict, rerun: str) -> FrameCheck:
    """One check of frames with the same rules; one that is not as expected speaks, else the largest."""
    one = max(found, key=lambda f: (not f.off <= FRAME_TOLERANCE, np.nan_to_num(f.size, nan=np.inf)))
    reason = "; ".join(r.reason for r in one.rules)
    why = f"{reason}; " * bool(reason) + f"largest in frame {one.frame}, {one.part}"
    if is_predicted(one.rules):
        why += f"; {one.off:.1e} off the prediction"
    elif one.rules:
        why += f"; {one.off:.1e} beyond the bound"
    verdict: Verdict = "known_difference" if one.rules else "agrees"
    if not one.off <= FRAME_TOLERANCE:
        verdict, why = "differs", f"{why}; rerun: {rerun}"
    return FrameCheck(
        **facts, deviation=one.size, tolerance=one.allowed, verdict=verdict, why=why, reason=reason,
        predicted=is_predicted(one.rules), off=one.off,
    )
