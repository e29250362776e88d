"""The legend of engines that tables call otherwise than a user does: the version stands for the place."""

from __future__ import annotations

from collections.abc import Mapping

from harness.report.page import Section

PLACES = "Where engines live"


def place_rows(words: Mapping[str, str]) -> list[dict]:
    """Return name and what is typed, of those where they differ. words: what is typed by name."""
    return [{"engine": name, "on the command line": word} for name, word in words.items() if word != name]


def place_sections(words: Mapping[str, str]) -> list[Section]:
    """Return the legend as a section of a page, none where there is nothing to tell."""
    rows = place_rows(words)
    note = "Tables name the version that was found; a command line names where it lives."
    return [Section(heading=PLACES, note=note, rows=rows)] if rows else []
