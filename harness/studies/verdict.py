"""A check and its verdict: values that tables, pages and exit status are made of."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

Verdict = Literal["agrees", "differs", "inconclusive", "not_checked", "known_difference"]
"""`not_checked` is never a pass; `inconclusive` means that the data cannot decide."""


@dataclass(frozen=True, kw_only=True)
class Check:
    """One declared check.

    level: L0 law, L1 collision, L2 trajectory until chaos, L3 statistics, or "run" for a property that
    a single run must have. left, right: what is compared (engines, or an engine and a reference).
    deviation and tolerance are relative unless `unit` says otherwise; None when not computed.
    why: one line, ending with the command that reruns it when it failed.
    """

    level: str
    quantity: str
    left: str
    right: str
    deviation: float | None
    tolerance: float | None
    verdict: Verdict
    why: str
    unit: str = ""


def within(deviation: float, tolerance: float) -> Verdict:
    """Judge a pointwise deviation; a deviation that is not a number differs."""
    return "agrees" if deviation <= tolerance else "differs"


def failed(checks: list[Check] | tuple[Check, ...]) -> bool:
    """Return whether any check differs, or none could be made at all."""
    return any(c.verdict == "differs" for c in checks) or all(c.verdict == "not_checked" for c in checks)
