"""From what engines answered to checks: against the kernel, against closed forms, against itself in other frames.

Deviations are largest differences over all rows and bodies, of force relative to the largest force of that motion and
of torque relative to its largest torque. Torques that are nearly none are taken relative to a tenth of R* times the
largest force, about what rolling resistance exerts.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from harness.engines.registry import KERNEL_PREFIX
from harness.studies.laws.arrangement import Arrangement
from harness.studies.laws.cases import TOLERANCE, Laws
from harness.studies.laws.closed_forms import expected
from harness.studies.laws.drive import Driven, part_name
from harness.studies.laws.invariance import FRAME_TOLERANCE, known_dependence
from harness.studies.verdict import Check, judged, not_checked
from reference.kernel.conventions import NAMED

CLOSED_FORM, PLAIN_FRAME = "closed form", "itself, plain frame"
SMALL_TORQUE = 0.1

Parts = Mapping[str, Driven]
"""Completed runs of one engine and one combination of laws, by part."""


@dataclass(frozen=True, kw_only=True)
class Deviation:
    """Largest relative difference, and where it was found."""

    size: float
    part: str
    frame: str


def convention_of(engine: str) -> str | None:
    """Return the convention that an engine computes in, None if the kernel knows none of this name."""
    name = engine.removeprefix(KERNEL_PREFIX)
    return name if name in NAMED else None


def judge_engine(laws: Laws, engine: str, runs: Parts, kernel: Parts, rerun: str, no_kernel: str = "") -> list[Check]:
    """Return all checks of one engine, motion by motion.

    kernel: completed runs in the engine's conventions, not used for a kernel; no_kernel: why there is none.
    """
    motions = dict.fromkeys(m for run in runs.values() for m in run.job.arrangement.motions)
    found: list[Check] = []
    for motion in motions:
        facts = {"level": "L0", "quantity": f"{laws.name}: {motion}", "left": engine}
        having = {part: run for part, run in runs.items() if motion in run.job.arrangement.motions}
        if not engine.startswith(KERNEL_PREFIX):
            found += _against_kernel(laws, motion, having, kernel, facts, rerun) or [_without_kernel(facts, no_kernel)]
        found += _against_closed_form(laws, motion, having, facts, rerun)
        found += _against_itself(laws, motion, having, facts, rerun)
    return found


# --- the three comparisons -------------------------------------------------------------------------


def _against_kernel(laws: Laws, motion: str, runs: Parts, kernel: Parts, facts: dict, rerun: str) -> list[Check]:
    facts = {**facts, "right": KERNEL_PREFIX + facts["left"]}
    both = [(run, kernel[part]) for part, run in runs.items() if part in kernel]
    found = [d for run, other in both for d in kernel_deviations(run, other, motion)]
    return [_judged(found, laws, facts, rerun)] if found else []


def _without_kernel(facts: dict, why: str) -> Check:
    right = KERNEL_PREFIX + facts["left"]
    return not_checked(**facts, right=right, why=why or "no run of the kernel", tolerance=TOLERANCE)


def kernel_deviations(run: Driven, other: Driven, motion: str) -> Iterator[Deviation]:
    """Yield the deviation of each track of a motion from the same track of another run."""
    a = run.job.arrangement
    tracks = a.tracks_of(motion)
    ours, theirs = ([t.local(r.reaction) for t in tracks] for r in (run, other))
    sizes = _sizes(theirs, a)
    for track, answer, reference in zip(tracks, ours, theirs, strict=True):
        yield Deviation(size=_apart(answer, reference, sizes), part=part_name(a), frame=track.frame.name)


def _against_closed_form(laws: Laws, motion: str, runs: Parts, facts: dict, rerun: str) -> list[Check]:
    convention = convention_of(facts["left"])
    if convention is None:
        return []
    found = [closed_form_deviation(run, laws, motion, convention) for run in runs.values()]
    found = [d for d in found if d is not None]
    return [_judged(found, laws, {**facts, "right": CLOSED_FORM}, rerun)] if found else []


def closed_form_deviation(run: Driven, laws: Laws, motion: str, convention: str) -> Deviation | None:
    """Return the deviation of the plain frame, where the path carries no rounding; None without a closed form.

    Numbers that the closed form does not determine (NaN) are left out.
    """
    a = run.job.arrangement
    plain = next((t for t in a.tracks_of(motion) if t.motion.course is not None), None)
    if plain is None:
        return None
    force, torque = expected(laws, plain.motion, a.partner, a.grains, NAMED[convention])
    answer = plain.local(run.reaction)
    known = [np.where(np.isnan(e), found, e) for e, found in zip((force, torque), answer, strict=True)]
    size = _apart(answer, known, _sizes([known], a))
    return Deviation(size=size, part=part_name(a), frame=plain.frame.name)


def _against_itself(laws: Laws, motion: str, runs: Parts, facts: dict, rerun: str) -> list[Check]:
    """One check for what must be invariant, and one for each known reason why something is not."""
    facts = {**facts, "right": PLAIN_FRAME}
    by_reason: dict = {}
    for run in runs.values():
        for d in frame_deviations(run, motion):
            rule = known_dependence(laws, convention_of(facts["left"]) or "", motion, d.frame)
            by_reason.setdefault(rule, []).append(d)
    return [_frame_check(rule, found, facts, rerun) for rule, found in by_reason.items()]


def frame_deviations(run: Driven, motion: str) -> Iterator[Deviation]:
    """Yield the deviation of each other frame, mapped back, from the plain one."""
    a = run.job.arrangement
    tracks = a.tracks_of(motion)
    answers = [t.local(run.reaction) for t in tracks]
    sizes = _sizes(answers, a)
    for track, answer in zip(tracks[1:], answers[1:], strict=True):
        yield Deviation(size=_apart(answer, answers[0], sizes), part=part_name(a), frame=track.frame.name)


def _frame_check(rule, found: Sequence[Deviation], facts: dict, rerun: str) -> Check:
    worst = _worst(found)
    where = f"largest in frame {worst.frame}, {worst.part}"
    if rule is None or worst.size <= FRAME_TOLERANCE:
        return judged(**facts, deviation=worst.size, tolerance=FRAME_TOLERANCE, why=where, rerun=rerun)
    if worst.size <= rule.limit:
        return Check(**facts, deviation=worst.size, tolerance=rule.limit, verdict="known_difference",
                     why=f"{rule.reason}; {where}")
    return judged(**facts, deviation=worst.size, tolerance=rule.limit, why=f"{rule.reason}; {where}", rerun=rerun)


# --- sizes -----------------------------------------------------------------------------------------


def _judged(found: Sequence[Deviation], laws: Laws, facts: dict, rerun: str) -> Check:
    worst, allowed = _worst(found), laws.allowance(facts["left"])
    own = f"; {allowed.reason}" if worst.size > TOLERANCE and allowed.reason else ""
    why = f"largest in frame {worst.frame}, {worst.part}{own}"
    return judged(**facts, deviation=worst.size, tolerance=allowed.tolerance, why=why, rerun=rerun)


def _worst(found: Sequence[Deviation]) -> Deviation:
    """Return the largest; one that is not a number is larger than all."""
    return max(found, key=lambda d: np.inf if np.isnan(d.size) else d.size)


Answer = Sequence[np.ndarray]
"""Force and torque, (S, bodies, 3) each, in the contact's axes."""


def _sizes(answers: Sequence[Answer], a: Arrangement) -> tuple[float, float]:
    """Return the largest force and the largest torque, or what stands for it."""
    force, torque = (float(np.max([np.abs(answer[k]).max() for answer in answers])) for k in (0, 1))
    return force, float(np.maximum(torque, SMALL_TORQUE * a.grains.reduced_radius(a.partner) * force))


def _apart(answer: Answer, other: Answer, sizes: tuple[float, float]) -> float:
    """Return the largest relative difference of force or torque, NaN if one is; no size and no difference make zero."""
    found = [float(np.abs(x - y).max()) for x, y in zip(answer, other, strict=True)]
    relative = [d / s if s != 0.0 else (0.0 if d == 0.0 else np.inf) for d, s in zip(found, sizes, strict=True)]
    return float(np.max(relative))
