"""Checks that differ because of what a version is known to compute otherwise: said as such."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

from harness.studies.compare.ring_checks import FROM_CONTACTS
from harness.studies.verdict import Check

if TYPE_CHECKING:
    from harness.engines.protocol import Engine
    from harness.scene.system import System

Changes = Mapping[str, frozenset[str]]
"""What is known to be otherwise, by engine."""


def known_changes(engines: Iterable[Engine], systems: Sequence[System]) -> Changes:
    """Return what was measured to be otherwise in the versions of these engines, in any of the systems."""
    from harness.engines.registry import changes_of

    return {e.name: frozenset(c for s in systems for c in changes_of(e, s)) for e in engines}


def known_records(engines: Iterable[Engine], systems: Sequence[System]) -> Mapping[str, str]:
    """Return how recorded contact forces are not those that acted, for the engines of which that is known."""
    said = {e.name: next(filter(None, (e.records(s) for s in systems)), "") for e in engines}
    return {name: words for name, words in said.items() if words}


def by_records(check: Check, records: Mapping[str, str]) -> Check:
    """Return the check; a balance of recorded contact forces that differs is no surprise where these did not act."""
    if check.verdict != "differs" or not check.quantity.startswith(FROM_CONTACTS) or check.left not in records:
        return check
    return replace(check, verdict="known_difference", why=f"{records[check.left]}; {check.why}")


def explained(check: Check, changes: Changes) -> Check:
    """Return the check; one that differs between engines that do not have all changes in common is no surprise.

    Only what differs is touched: how far is shown, and a change that does not show is none of its business.
    """
    if check.verdict != "differs" or check.level == "run":
        return check
    apart = changes.get(check.left, frozenset()) ^ changes.get(check.right, frozenset())
    if not apart:
        return check
    return replace(check, verdict="known_difference", why=f"{'; '.join(sorted(apart))}; {check.why}")
