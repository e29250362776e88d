"""The page of a comparison: verdicts at a glance, what failed, what the scene shows, cost, versions, details."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence

from harness.report.cost import COST_NOTE, cost_rows, host_rows, version_rows
from harness.report.failures import ReportedRun, entries
from harness.report.matrix import matrices
from harness.report.page import Section, words
from harness.studies.verdict import Check

VERDICT_NOTE = (
    "agrees / differs: a declared tolerance was met or not. inconclusive: the data cannot decide, for example one "
    "packing after chaos has set in. not checked: there was nothing to check, which is never a pass. known difference: "
    "explained where all checks stand. Under a verdict: the deviation beside its tolerance, and of how many samples it "
    "is the largest; of statistics beside what equal codes differ by at most by chance, and the margin that a "
    "difference must be shown to be smaller than. On this page +- is one standard error. Levels: L1 collision, L2 "
    "trajectory until chaos, L3 statistics over packings, run: a property that one run must have."
)
RUN_NOTE = (
    "A run that failed, or an engine that is missing, is listed with its reason. CPU over steps: of the whole process, "
    "so with its start; Time and cost has the steps alone."
)


def opening_sections(checks: Sequence[Check], runs: Sequence[ReportedRun]) -> list[Section]:
    """What somebody sees who looks for ten seconds: the matrix, and everything that went wrong."""
    wrong = entries(checks, runs)
    return [
        Section(heading="Verdicts", note=VERDICT_NOTE, matrices=matrices(checks, (r.engine for r in runs))),
        Section(heading="What failed, and how to repeat it", note=_failure_note(checks, runs), entries=wrong),
    ]


def _failure_note(checks: Sequence[Check], runs: Sequence[ReportedRun]) -> str:
    """Say how much went wrong; what could not be decided is neither here nor there, and is said."""
    counts = Counter(c.verdict for c in checks)
    lost = sum(r.outcome.status != "completed" for r in runs)
    what = [
        f"{counts['differs']} of {len(checks)} checks differ" if checks else "Nothing was checked: no pass",
        f"{lost} of {len(runs)} runs did not complete",
    ]
    undecided = [f"{counts[v]} {words(v)}" for v in ("inconclusive", "not_checked") if counts[v]]
    tail = f" Undecided are {' and '.join(undecided)}: why stands under All checks." if undecided else ""
    return f"{', '.join(what)}.{tail}"


def closing_sections(
    runs: Sequence[ReportedRun], *, check_rows: list[dict], run_rows: list[dict], between: Sequence[Section] = (),
    command: str = "",
) -> list[Section]:
    """What it cost, what made it, and everything in detail. command: that makes the page again."""
    return [
        Section(heading="Time and cost", note=COST_NOTE, rows=cost_rows(runs)),
        Section(heading="Versions", rows=version_rows(runs)),
        *between,
        Section(heading="Machines", rows=host_rows(runs)),
        Section(heading="All checks", rows=check_rows),
        Section(heading="Runs", note=RUN_NOTE, rows=run_rows),
        Section(heading="Reproduce", text="\n".join(_reproduce(runs, command))),
    ]


def _reproduce(runs: Sequence[ReportedRun], command: str) -> list[str]:
    made, page = [r for r in runs if r.outcome.reproduce], [f"# this page\n{command}"] if command else []
    return page + [f"# {r.engine}, packing {r.packing + 1}\n{r.outcome.reproduce}" for r in made]
