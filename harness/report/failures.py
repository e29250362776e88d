"""What went wrong in a comparison, each with the command that repeats it."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING, Protocol

from harness.report.page import Entry
from harness.runs.outcome import last_words, where_and_why
from harness.studies.verdict import Check

if TYPE_CHECKING:
    from harness.runs.outcome import Outcome

BROKEN = ("crashed", "unstable", "timed_out")
"""Outcomes that are failures; what is not installed or not supported is said, and is none."""

RERUN = "; rerun: "
"""What stands between a check's reason and its command."""


class ReportedRun(Protocol):
    """A run as reports see it: just made, or read from a report."""

    @property
    def engine(self) -> str:
        """Its name."""

    @property
    def packing(self) -> int:
        """Counted from 0."""

    @property
    def outcome(self) -> Outcome:
        """What became of it."""


def entries(checks: Iterable[Check], runs: Iterable[ReportedRun]) -> tuple[Entry, ...]:
    """Return runs that did not complete, or that the engine itself warns of, then checks that differ."""
    runs = tuple(runs)
    return (
        *(_of_run(r) for r in runs if r.outcome.status != "completed"),
        *(_warned(r, warning) for r in runs for warning in r.outcome.warnings),
        *(_of_check(c) for c in checks if c.verdict == "differs"),
    )


def reason_and_command(check: Check) -> tuple[str, str]:
    """Take a check's reason apart: why, and the command that reruns it, "" if it names none."""
    why, _, command = check.why.rpartition(RERUN)
    return (why, command) if why else (check.why, "")


def run_reason(outcome: Outcome) -> str:
    """Say why a run did not complete, with the step it reached and its last words if it ran."""
    if outcome.status not in BROKEN:
        return outcome.reason
    where, why = where_and_why(outcome)
    return f"{why}, {where}{last_words(outcome)}"


def check_title(check: Check) -> str:
    """Name what was compared."""
    return f"{check.quantity}: {check.left} against {check.right}"


def run_title(run: ReportedRun) -> str:
    """Name a run."""
    return f"{run.engine}, packing {run.packing + 1}"


def _of_run(run: ReportedRun) -> Entry:
    o = run.outcome
    return Entry(word=o.status, title=run_title(run), why=run_reason(o), command=o.reproduce)


def _warned(run: ReportedRun, warning: str) -> Entry:
    """A run that went to its end, and whose engine warns of it."""
    return Entry(word="warning", title=run_title(run), why=warning, command=run.outcome.reproduce)


def _of_check(check: Check) -> Entry:
    why, command = reason_and_command(check)
    return Entry(word="differs", title=f"{check.level}, {check_title(check)}", why=why, command=command)
