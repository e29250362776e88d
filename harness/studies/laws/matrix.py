"""The matrix: one cell for a combination of laws and an engine, with the largest deviation or why there is none."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Literal

from harness.engines.registry import kernel_of
from harness.runs.outcome import Status
from harness.studies.laws.direct import DirectCheck
from harness.studies.laws.judge import CLOSED_FORM, PLAIN_FRAME, STEPPED
from harness.studies.verdict import Check

Shown = Literal["measured", "not compared", "unsupported", "known wrong", "unavailable", "failed"]


@dataclass(frozen=True, kw_only=True)
class Answered:
    """What became of one run, whatever it was: `part` names it within its cell."""

    part: str
    status: Status
    reason: str
    notes: tuple[str, ...] = ()


@dataclass(frozen=True, kw_only=True)
class Cell:
    """deviation: the largest of the checks against `against`; None unless `shown` is "measured".

    note: where it was found, or why there is none; missing: parts that the engine does not compute, with the reason.
    """

    laws: str
    engine: str
    shown: Shown
    deviation: float | None
    against: str
    differs: bool
    note: str
    missing: tuple[str, ...] = ()

    @property
    def text(self) -> str:
        """The cell in one word or number; a star says that the engine does not compute all parts of it."""
        if self.shown != "measured":
            return "-" if self.shown == "not compared" else self.shown
        size = f"{self.deviation:.1e}" if self.deviation else "0"
        return f"{size}{'*' if self.missing else ''}{' differs' if self.differs else ''}"


def make_cell(laws: str, engine: str, runs: Sequence[Answered], checks: Iterable[Check]) -> Cell:
    """Return the cell of what was run and checked; the worst run decides what is shown."""
    facts = {"laws": laws, "engine": engine}
    checks = [c for c in checks if c.right != PLAIN_FRAME and not isinstance(c, DirectCheck)]
    differs = any(c.verdict == "differs" for c in checks)
    failed = [r for r in runs if r.status in ("crashed", "unstable", "timed_out")]
    if failed:
        return _empty(facts, "failed", "; ".join(f"{r.part}: {r.status.replace('_', ' ')}: {r.reason}" for r in failed))
    missing = [r for r in runs if r.status in ("unsupported", "unavailable")]
    if len(missing) == len(runs):
        return _empty(facts, _why_missing(missing[0]), missing[0].reason)
    against, found = _compared(engine, checks)
    if not found:
        return _empty(facts, "not compared", "; ".join(dict.fromkeys(c.why for c in checks)))
    worst = max(found, key=lambda c: c.deviation if c.deviation == c.deviation else float("inf"))
    return Cell(
        **facts, shown="measured", deviation=worst.deviation, against=against, differs=differs,
        note=f"{worst.quantity}: {worst.why}", missing=tuple(f"{r.part}: {r.reason}" for r in missing),
    )


def _compared(engine: str, checks: list[Check]) -> tuple[str, list[Check]]:
    """A code is compared with the kernel where the kernel has the law; kernels and others with closed forms.

    Of collisions closed forms know the exits alone, to the order of the time step: whole ones are stepped.
    """
    made = [c for c in checks if c.deviation is not None]
    for right in (kernel_of(engine), CLOSED_FORM, STEPPED):
        found = [c for c in made if c.right == right]
        if found:
            return right, found
    return CLOSED_FORM, made


def direct_cell(laws: str, pair: tuple[str, str], checks: Iterable[Check]) -> Cell:
    """Return the cell of two codes against each other: the largest of what their conventions make of it."""
    found = [c for c in checks if isinstance(c, DirectCheck) and (c.laws, c.left, c.right) == (laws, *pair)]
    facts = {"laws": laws, "engine": f"{pair[0]} - {pair[1]}"}
    if not found:
        return _empty(facts, "not compared", "not both compute it")
    worst = max(found, key=lambda c: c.deviation if c.deviation == c.deviation else float("inf"))
    return Cell(
        **facts, shown="measured", deviation=worst.deviation, against=pair[1], note=f"{worst.what}: {worst.why}",
        differs=any(c.verdict == "differs" for c in found),
    )


def _why_missing(run: Answered) -> Shown:
    if run.status == "unavailable":
        return "unavailable"
    return "known wrong" if ": known wrong: " in f": {run.reason}" else "unsupported"


def _empty(facts: dict, shown: Shown, note: str) -> Cell:
    return Cell(**facts, shown=shown, deviation=None, against="", differs=shown == "failed", note=note)
