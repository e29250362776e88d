"""How a case ended on a code, in one word, and whether that is what was declared.

    stable            it ran to its end and every invariant held
    degraded          it ran to its end; an invariant is beyond its tolerance, yet not beyond its ruin
    failed_loudly     the code itself stopped, or died, with a reason; or says at its end that the run went wrong
    timed_out         the harness ended it at the time limit: neither the code nor its answer said anything
    failed_silently   the code ended as if all were well, and an invariant is beyond its ruin
    refused           the scene was turned down before anything ran, in one line
    unsupported       the code does not have an effect of the scene, and the harness says so
    unavailable       the code is not installed

"Silently" is said of the code: the harness, which found it out, says it aloud.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import Literal

from harness.runs.outcome import Outcome
from harness.scene.expect import Invariant
from harness.studies.stability.cases import Case
from harness.studies.stability.invariants import KINDS
from harness.studies.stability.seen import NotKnown, Seen

Ended = Literal[
    "stable", "degraded", "failed_loudly", "failed_silently", "timed_out", "refused", "unsupported", "unavailable"
]

BAD: tuple[Ended, ...] = ("degraded", "failed_loudly", "failed_silently")

AGAIN = "out/again"
"""Where a case is made again: not over the report of all."""

OWN = ("kernel:talk", "kernel:corrected")
"""The kernel in conventions of its own."""


@dataclass(frozen=True, kw_only=True)
class Held:
    """One invariant of one run. size: None where it could not be measured, then `says` tells why."""

    invariant: str
    size: float | None
    tolerance: float
    ruin: float
    says: str

    @property
    def broken(self) -> bool:
        """Whether it is beyond its tolerance; a size that is not a number is."""
        return self.size is not None and not self.size <= self.tolerance

    @property
    def ruined(self) -> bool:
        """Whether it is so far beyond that nothing is left of the answer."""
        return self.broken and not self.size <= self.ruin

    @property
    def excess(self) -> float:
        """Size over tolerance; infinite for a tolerance of 0 or no number."""
        if self.size is None:
            return 0.0
        bad = not self.size <= self.tolerance
        return self.size / self.tolerance if self.tolerance and self.size == self.size else float("inf") * bad or 0.0


@dataclass(frozen=True, kw_only=True)
class Result:
    """What became of one case on one code. reason: one line, empty when stable. expected: what was declared.

    known: why another ending than `stable` is expected. reproduce: the command that makes just this again.
    """

    case: str
    engine: str
    ended: Ended
    reason: str
    expected: Ended
    known: str
    held: tuple[Held, ...] = ()
    steps: int = 0
    seconds: float | None = None
    reproduce: str = ""

    @property
    def as_declared(self) -> bool:
        """Whether it ended as the case says; a code that is not here cannot tell."""
        return self.ended in (self.expected, "unavailable")

    @property
    def kernel_failed_silently(self) -> bool:
        """What may never be. In the conventions of a code the kernel fails as that code does, which is declared."""
        return self.engine in OWN and self.ended == "failed_silently"


def judge_run(case: Case, engine: str, outcome: Outcome, seen: Seen | None, twins: Mapping[str, Seen | None]) -> Result:
    """Return the result of a run. seen: None unless it completed. twins: by case, None where that run failed."""
    held = tuple(measure(i, seen, twins) for i in case.invariants) if seen is not None else ()
    ended, reason = _ended(outcome, held)
    expected, known = declared(case, engine)
    return Result(
        case=case.name, engine=engine, ended=ended, reason=reason, expected=expected, known=known, held=held,
        steps=outcome.steps, seconds=outcome.cpu_seconds,
        reproduce="" if ended == "unsupported" else _again(case, engine),
    )


def _again(case: Case, engine: str) -> str:
    return f"grainproof stability {case.name} --engines {engine} --out {AGAIN}"


def judge_refusal(case: Case, engine: str) -> Result:
    """Return the result of a scene that has to be refused, on any code: the same line stops them all."""
    wanted = case.expect.refused or ""
    said = bool(case.refusal) and wanted in case.refusal
    reason = case.refusal or f"the scene was taken, though it must be refused: {wanted}"
    if case.refusal and not said:
        reason = f"refused for another reason than declared ({wanted}): {case.refusal}"
    return Result(
        case=case.name, engine=engine, ended="refused" if said else "failed_silently", reason=reason,
        expected="refused", known=case.expect.why,
    )


def declared(case: Case, engine: str) -> tuple[Ended, str]:
    """Return how a case is declared to end on a code, and why if not stable; a kernel's convention goes first."""
    for name in (engine, engine.split("@")[0], engine.split(":")[0].split("@")[0]):
        for outcome in case.expect.outcomes:
            if outcome.engine == name:
                return outcome.outcome, outcome.reason
    return "stable", ""


def measure(invariant: Invariant, seen: Seen, twins: Mapping[str, Seen | None]) -> Held:
    """Return what an invariant's size is in a run."""
    kind = KINDS[invariant.name]
    cut = seen.up_to(invariant.until)
    size, says = None, kind.says
    try:
        others = (_twin(invariant, twins),) if kind.twins else ()
        size = kind.measure(cut, invariant, *others)
    except NotKnown as missing:
        says = f"{kind.says}: not measured, {missing}"
    return Held(
        invariant=invariant.name, size=size, tolerance=invariant.tolerance, says=says,
        ruin=kind.ruin if invariant.ruin is None else invariant.ruin,
    )


def worst(held: Iterable[Held]) -> Held | None:
    """Return the invariant that is furthest beyond its tolerance, a ruined one first; None if all hold."""
    broken = [h for h in held if h.broken]
    return max(broken, key=lambda h: (h.ruined, h.excess), default=None)


def _twin(invariant: Invariant, twins: Mapping[str, Seen | None]) -> Seen:
    other = twins.get(invariant.twin.case)
    if other is None:
        raise NotKnown(f"the run of {invariant.twin.case} did not complete")
    scale = invariant.twin.time_scale
    return other if invariant.until is None else other.up_to(invariant.until / scale)


def _ended(outcome: Outcome, held: tuple[Held, ...]) -> tuple[Ended, str]:
    """Return the word, and why in one line."""
    if outcome.status in ("unsupported", "unavailable", "timed_out"):
        return outcome.status, outcome.reason
    if outcome.status != "completed":
        return ("failed_silently" if _said_nothing(outcome) else "failed_loudly"), outcome.reason
    unknown = next((h for h in held if h.size is None), None)
    bad = worst(held)
    if bad is None and unknown is not None:
        return "degraded", f"{unknown.invariant}: {unknown.says}"
    if bad is None:
        return "stable", ""
    reason = "; ".join((f"{bad.invariant}: {bad.says} {bad.size:.3g} > {bad.tolerance:.3g}", *outcome.warnings))
    if not bad.ruined:
        return "degraded", reason
    return ("failed_loudly" if outcome.warnings else "failed_silently"), reason


def _said_nothing(outcome: Outcome) -> bool:
    """Whether the code ended as if all were well, and the harness found the fault in what it had read."""
    return "read" in outcome.timings
