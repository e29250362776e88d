"""The page: sections of notes, tables and figures in one HTML file that needs no other."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from importlib import resources

from harness.report.tables import COLOURS, text

WORDS = {*COLOURS, "crashed", "unstable", "timed_out", "unavailable", "unsupported"}
"""Words that the page's style sheet gives a colour."""


@dataclass(frozen=True, kw_only=True)
class Figure:
    """A picture as a data URI and what it shows."""

    uri: str
    caption: str


@dataclass(frozen=True, kw_only=True)
class Section:
    """A heading with any of: a note, a table (rows with the same keys), figures, plain text."""

    heading: str
    note: str = ""
    rows: list[Mapping[str, object]] | None = None
    figures: tuple[Figure, ...] = ()
    text: str = ""


def render_page(*, title: str, lead: str, sections: list[Section]) -> str:
    """Return the HTML page; everything that came from outside is escaped."""
    from jinja2 import Environment

    environment = Environment(autoescape=True, trim_blocks=True, lstrip_blocks=True)
    environment.filters["shown"] = text
    environment.filters["look"] = _look
    source = resources.files(__package__).joinpath("page.html").read_text(encoding="utf-8")
    return environment.from_string(source).render(title=title, lead=lead, sections=sections)


def _look(value: object) -> str:
    if isinstance(value, int | float):
        return "number"
    return value if value in WORDS else ""
