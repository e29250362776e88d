"""One declared rate of false alarms for every test of a report, whatever it is of.

A test hands in one p-value: the smallest of its cells times their number, where it has several (O. J. Dunn, J. Am.
Stat. Assoc. 56, 52 (1961); cells correlate, in a way that nobody knows). All p-values of a report are corrected
together (Holm, `harness.studies.statistics.multiple`), and every test is made at the level that follows: with a
probability of the declared rate at most any of them says that something differs where nothing does, however they depend
on each other. Of a test that does see a difference all cells are named that are beyond its level.

Checks against declared tolerances, sample by sample, have no chance in them and take no part.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Protocol

import numpy as np

from harness.studies.statistics.multiple import correct_together
from harness.studies.verdict import Check


class SharedTest(Protocol):
    """A test that shares the rate of false alarms with all others of a report."""

    @property
    def p(self) -> float | None:
        """The p-value of "nothing differs", 1 where none could be believed, None where there is nothing to test."""

    def check(self, level: float) -> Check:
        """Return the verdict: it differs where p <= level."""


def smallest_p(p_values: Iterable[np.ndarray], number: int) -> float:
    """Return the smallest p-value of some of `number` cells, corrected for all: 1 at most, and without any.

    A cell whose p-value is not a number is none that agrees: 0.
    """
    each = np.nan_to_num(np.concatenate([np.empty(0), *p_values]), nan=0.0)
    return float(min(1.0, number * each.min(initial=1.0)))


def handed_in(tests: Sequence[SharedTest]) -> list[float]:
    """Return the p-values of those tests that have something to test."""
    return [p for p in (t.p for t in tests) if p is not None]


def judged_together(tests: Sequence[SharedTest], false_alarms: float) -> list[Check]:
    """Judge tests that share their rate with no others."""
    (corrected,) = correct_together(false_alarms, handed_in(tests))
    return [t.check(corrected.level) for t in tests]
