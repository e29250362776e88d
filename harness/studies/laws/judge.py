"""From what engines answered to checks: against the kernel, against closed forms, against itself in other frames."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

from harness.engines.registry import KERNEL_PREFIX, kernel_of
from harness.engines.word import code_of
from harness.studies.laws.cases import TOLERANCE, Laws
from harness.studies.laws.closed_forms import expected
from harness.studies.laws.deviations import Deviation, apart, known, sizes_of, worst
from harness.studies.laws.drive import Driven, part_name
from harness.studies.laws.frame_checks import PLAIN_FRAME, against_itself
from harness.studies.laws.stepped import Stepper
from harness.studies.verdict import Check, judged, not_checked
from reference.kernel.conventions import NAMED

__all__ = ["CLOSED_FORM", "PLAIN_FRAME", "STEPPED", "judge_engine"]

CLOSED_FORM, STEPPED = "closed form", "closed form, stepped"

Parts = Mapping[str, Driven]
"""Completed runs of one engine and one combination of laws, by part."""


def convention_of(engine: str) -> str | None:
    """Return the convention that an engine computes in, None if the kernel knows none of this name."""
    name = code_of(engine).removeprefix(KERNEL_PREFIX)
    return name if name in NAMED else None


def judge_engine(
    laws: Laws, engine: str, runs: Parts, kernel: Parts, rerun: str, no_kernel: str = "", stepper: Stepper | None = None
) -> list[Check]:
    """Return all checks of one engine, motion by motion.

    kernel: completed runs in the engine's conventions, not used for a kernel; no_kernel: why there is none.
    stepper: of these laws, to be shared by engines.
    """
    motions = dict.fromkeys(m for run in runs.values() for m in run.job.arrangement.motions)
    stepper, convention = stepper or Stepper(laws=laws), convention_of(engine)
    found: list[Check] = []
    for motion in motions:
        facts = {"level": "L0", "quantity": f"{laws.name}: {motion}", "left": engine}
        having = {part: run for part, run in runs.items() if motion in run.job.arrangement.motions}
        if not engine.startswith(KERNEL_PREFIX):
            found += _against_kernel(motion, having, kernel, facts, rerun) or [_without_kernel(facts, no_kernel)]
        if convention is not None:
            found += _against_closed_form(motion, having, convention, stepper, facts, rerun)
        found += against_itself(motion, having, convention, stepper, facts, rerun)
    return found


# --- the three comparisons -------------------------------------------------------------------------


def _against_kernel(motion: str, runs: Parts, kernel: Parts, facts: dict, rerun: str) -> list[Check]:
    facts = {**facts, "right": kernel_of(facts["left"])}
    both = [(run, kernel[part]) for part, run in runs.items() if part in kernel]
    found = [d for run, other in both for d in kernel_deviations(run, other, motion)]
    return [_judged(found, facts, rerun)] if found else []


def _without_kernel(facts: dict, why: str) -> Check:
    right = kernel_of(facts["left"])
    return not_checked(**facts, right=right, why=why or "no run of the kernel", tolerance=TOLERANCE)


def kernel_deviations(run: Driven, other: Driven, motion: str) -> Iterator[Deviation]:
    """Yield the deviation of each track of a motion from the same track of another run."""
    a = run.job.arrangement
    tracks = a.tracks_of(motion)
    ours, theirs = ([t.local(r.reaction) for t in tracks] for r in (run, other))
    sizes = sizes_of(theirs, a)
    for track, answer, reference in zip(tracks, ours, theirs, strict=True):
        yield Deviation(size=apart(answer, reference, sizes), part=part_name(a), frame=track.frame.name)


def _against_closed_form(
    motion: str, runs: Parts, convention: str, stepper: Stepper, facts: dict, rerun: str
) -> list[Check]:
    """Where the normal is fixed there is a closed form, where it turns a recursion."""
    fixed = all(run.job.arrangement.tracks_of(motion)[0].motion.course is not None for run in runs.values())
    found = [closed_form_deviation(run, motion, convention, stepper) for run in runs.values()]
    return [_judged(found, {**facts, "right": CLOSED_FORM if fixed else STEPPED}, rerun)] if found else []


def closed_form_deviation(run: Driven, motion: str, convention: str, stepper: Stepper) -> Deviation:
    """Return the deviation of the plain frame; the path of a closed form carries no rounding there.

    Numbers that the closed form does not determine (NaN) are left out.
    """
    a = run.job.arrangement
    plain = a.tracks_of(motion)[0]
    if plain.motion.course is None:
        reference = stepper.answers(a, motion, convention)[plain.frame.name]
    else:
        reference = expected(stepper.laws, plain.motion, a.partner, a.grains, NAMED[convention])
    answer = plain.local(run.reaction)
    reference = known(answer, reference)
    size = apart(answer, reference, sizes_of([reference], a))
    return Deviation(size=size, part=part_name(a), frame=plain.frame.name)


def _judged(found: Sequence[Deviation], facts: dict, rerun: str) -> Check:
    one = worst(found)
    why = f"largest in frame {one.frame}, {one.part}"
    return judged(**facts, deviation=one.size, tolerance=TOLERANCE, why=why, rerun=rerun)
