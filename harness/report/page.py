"""The page: sections of notes, tables, matrices and figures in one HTML file that needs no other.

It is made for wide screens and narrow ones, light and dark: what is wider than the screen scrolls in its own box,
figures keep a background of their own, and no verdict is told by its colour alone.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass
from importlib import resources
from typing import TYPE_CHECKING

from harness.report.tables import COLOURS, text

if TYPE_CHECKING:
    from harness.report.matrix import Matrix

WORDS = {
    *COLOURS, "crashed", "unstable", "timed_out", "unavailable", "unsupported", "worse", "better", "appeared",
    "vanished", "failed_loudly", "failed_silently", "warning",
}
"""Words that the page's style sheet gives a colour."""

MARKS = {
    "agrees": "✓", "completed": "✓", "differs": "✗", "crashed": "✗", "unstable": "✗", "timed_out": "✗",
    "inconclusive": "?", "not_checked": "–", "unavailable": "–", "unsupported": "–", "known_difference": "≠",
    "worse": "▼", "better": "▲", "stable": "✓", "refused": "✓", "degraded": "≈", "failed_loudly": "!",
    "failed_silently": "✗", "warning": "!",
}
"""A sign beside the word, for who cannot tell the colours."""

PROSE = 40
"""Characters from which a cell is prose: it is given room to wrap in."""


@dataclass(frozen=True, kw_only=True)
class Figure:
    """A picture as a data URI and what it shows. panel: one of several small ones, which stand side by side."""

    uri: str
    caption: str
    panel: bool = False


@dataclass(frozen=True, kw_only=True)
class Entry:
    """One thing that went wrong: what became of it (a verdict or an outcome), of what, why, how to repeat it."""

    word: str
    title: str
    why: str
    command: str = ""


@dataclass(frozen=True, kw_only=True)
class Section:
    """A heading with any of: matrices, a note, entries, a table (rows with the same keys), figures, plain text."""

    heading: str
    note: str = ""
    matrices: tuple[Matrix, ...] = ()
    entries: tuple[Entry, ...] = ()
    rows: list[Mapping[str, object]] | None = None
    figures: tuple[Figure, ...] = ()
    text: str = ""


def render_page(*, title: str, lead: str, sections: list[Section]) -> str:
    """Return the HTML page; everything that came from outside is escaped."""
    from jinja2 import Environment

    environment = Environment(autoescape=True, trim_blocks=True, lstrip_blocks=True)
    environment.filters |= {"shown": text, "look": _look, "words": words, "mark": mark}
    source = resources.files(__package__).joinpath("page.html").read_text(encoding="utf-8")
    return environment.from_string(source).render(
        title=title, lead=lead, sections=sections, anchors=_anchors([s.heading for s in sections])
    )


def words(verdict: str) -> str:
    """Write a verdict for people.

    >>> words("not_checked")
    'not checked'
    """
    return verdict.replace("_", " ")


def mark(verdict: str) -> str:
    """Return the sign of a verdict or an outcome, "" if it has none."""
    return MARKS.get(verdict, "")


def _anchors(headings: list[str]) -> list[str]:
    """Return a name for every heading's place on the page, each once."""
    plain = [re.sub(r"[^a-z0-9]+", "-", h.lower()).strip("-") or "part" for h in headings]
    return [name if plain.index(name) == k else f"{name}-{k}" for k, name in enumerate(plain)]


def _look(value: object) -> str:
    if isinstance(value, int | float):
        return "number"
    if value in WORDS:
        return str(value)
    return "prose" if isinstance(value, str) and len(value) > PROSE else ""
