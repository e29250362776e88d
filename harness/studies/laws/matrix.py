"""The matrix: one cell for a combination of laws and an engine, with the largest deviation or why there is none."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Literal

from harness.engines.registry import KERNEL_PREFIX
from harness.runs.outcome import Status
from harness.studies.laws.judge import CLOSED_FORM, PLAIN_FRAME
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
    checks = [c for c in checks if c.right != PLAIN_FRAME]
    differs = any(c.verdict == "differs" for c in checks)
    failed = [r for r in runs if r.status in ("crashed", "unstable", "timed_out")]
    if failed:
        return _empty(facts, "failed", f"{failed[0].part}: {failed[0].status}: {failed[0].reason}")
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
    """A code is compared with the kernel where the kernel has the law; kernels and others with closed forms."""
    made = [c for c in checks if c.deviation is not None]
    with_kernel = [c for c in made if c.right == KERNEL_PREFIX + engine]
    if with_kernel:
        return KERNEL_PREFIX + engine, with_kernel
    return CLOSED_FORM, made


def _why_missing(run: Answered) -> Shown:
    if run.status == "unavailable":
        return "unavailable"
    return "known wrong" if ": known wrong: " in f": {run.reason}" else "unsupported"


def _empty(facts: dict, shown: Shown, note: str) -> Cell:
    return Cell(**facts, shown=shown, deviation=None, against="", differs=shown == "failed", note=note)
