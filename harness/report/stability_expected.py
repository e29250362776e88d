"""How long the hard cases are expected to take: rough, said before anything is made."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from harness.engines.protocol import takes
from harness.engines.registry import choose_alone
from harness.report.expected import (
    REPORT_SECONDS,
    Expected,
    judging_seconds,
    likely_system,
    longest_first,
    packing_seconds,
    run_seconds,
)
from harness.runs.outcome import usable_cores
from harness.scene.explain import time_row
from harness.scene.resolve import needs_packing
from harness.studies.stability.cases import all_cases, choose_cases, with_twins
from harness.studies.stability.study import USUAL


def announcement(
    names: Sequence[str], *, engines: Sequence[str] | None, long: bool, workers: int | None,
    folder: Path | None = None,
) -> str:
    """Return a line on how long the chosen cases take. Raises InputError."""
    expected = expected_stability(names, engines=engines, long=long, workers=workers, folder=folder)
    row = time_row("stability", expected.seconds, expected.says)
    return f"expected: about {row.text} for {row.note}"


def expected_stability(
    names: Sequence[str], *, engines: Sequence[str] | None, long: bool, workers: int | None,
    folder: Path | None = None,
) -> Expected:
    """Return what the runs of the chosen cases, and of those they are held against, take with their packings.

    A case is as many steps of as many bodies; one that fails loudly ends sooner. Raises InputError.
    """
    known = all_cases(folder)
    wanted = with_twins(choose_cases(known, names, long=long), known)
    able = [e for e in choose_alone(list(engines or USUAL)) if e.probe().available]
    costs: list[float] = []
    packing, packings, judging = 0.0, 0, REPORT_SECONDS
    for case in (c for c in wanted if c.scene is not None):
        system = likely_system(case.scene, case.file)
        each = [run_seconds(e, system) for e in able if takes(e, system)]
        costs += each
        judging += judging_seconds(system, len(each))
        if needs_packing(case.scene):
            packing, packings = packing + packing_seconds(case.scene, system), packings + 1
    at_once = max(1, min(workers or usable_cores(), len(costs)))
    return Expected(
        seconds=packing + longest_first(costs, at_once) + judging, runs=len(costs), packings=packings, at_once=at_once
    )
