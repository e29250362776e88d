"""Result tables: on the terminal and as CSV, from the same rows."""

from __future__ import annotations

import csv
import io
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass

Row = Mapping[str, object]


COLOURS = {
    "agrees": "green", "differs": "bold red", "inconclusive": "yellow", "not_checked": "magenta",
    "known_difference": "cyan", "completed": "green",
}


@dataclass(frozen=True, kw_only=True)
class Answer:
    """What a command has to say: tables by title for people, data for programs (see `runs.atomic.json_text`)."""

    tables: Mapping[str, Sequence[Row]]
    data: object


def print_table(rows: Sequence[Row], title: str) -> None:
    """Print rows (same keys in each) as a table; words of verdicts and outcomes are coloured."""
    from rich.console import Console
    from rich.markup import escape
    from rich.table import Table

    console = Console()
    if not console.is_terminal:
        print(plain_table(rows, title))
        return
    table = Table(title=escape(title), title_justify="left", show_lines=False)
    for name in rows[0] if rows else ():
        table.add_column(name, overflow="fold")
    for row in rows:
        table.add_row(*(_coloured(text(v)) for v in row.values()))
    console.print(table)


def plain_table(rows: Sequence[Row], title: str) -> str:
    """Return rows (same keys in each) as aligned plain text, one line a row whatever the terminal's width."""
    if not rows:
        return f"{title}\n  nothing"
    cells = [list(rows[0]), *([text(v) for v in row.values()] for row in rows)]
    widths = [max(len(row[k]) for row in cells) for k in range(len(cells[0]))]
    lines = ("  " + "  ".join(c.ljust(w) for c, w in zip(row, widths, strict=True)).rstrip() for row in cells)
    return "\n".join([title, *lines])


def csv_text(rows: Iterable[Row]) -> str:
    """Return rows (same keys in each) as CSV; numbers with all digits, None as an empty field.

    Raises ValueError for rows of different keys.
    """
    rows = list(rows)
    if any(row.keys() != rows[0].keys() for row in rows):
        raise ValueError("rows of one table must have the same columns")
    out = io.StringIO()
    writer = csv.writer(out, lineterminator="\n")
    writer.writerows([rows[0], *([_exact(row[name]) for name in rows[0]] for row in rows)] if rows else [])
    return out.getvalue()


def text(value: object) -> str:
    """Return a value for people: numbers with three digits, nothing as a dash."""
    if value is None:
        return "-"
    if isinstance(value, float):
        return f"{value:.3g}"
    return str(value)


def _exact(value: object) -> str:
    if value is None:
        return ""
    return repr(float(value)) if isinstance(value, float) else str(value)


def _coloured(word: str) -> str:
    from rich.markup import escape

    colour = COLOURS.get(word)
    return f"[{colour}]{word}[/]" if colour else escape(word)
