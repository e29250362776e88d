"""Result tables: on the terminal, as CSV and as JSON, from the same rows."""

from __future__ import annotations

import csv
import io
from collections.abc import Iterable, Mapping

COLOURS = {
    "agrees": "green", "differs": "bold red", "inconclusive": "yellow", "not_checked": "magenta",
    "known_difference": "cyan", "completed": "green",
}


def print_table(rows: list[Mapping[str, object]], title: str) -> None:
    """Print rows (same keys in each) as a table; words of verdicts and outcomes are coloured."""
    from rich.console import Console
    from rich.table import Table

    console = Console()
    if not console.is_terminal:
        print(plain_table(rows, title))
        return
    table = Table(title=title, title_justify="left", show_lines=False)
    for name in rows[0] if rows else ():
        table.add_column(name, overflow="fold")
    for row in rows:
        table.add_row(*(_coloured(text(v)) for v in row.values()))
    console.print(table)


def plain_table(rows: list[Mapping[str, object]], title: str) -> str:
    """Return rows as aligned plain text, one line a row whatever the terminal's width."""
    if not rows:
        return f"{title}\n  nothing"
    cells = [list(rows[0]), *([text(v) for v in row.values()] for row in rows)]
    widths = [max(len(row[k]) for row in cells) for k in range(len(cells[0]))]
    lines = ("  " + "  ".join(c.ljust(w) for c, w in zip(row, widths, strict=True)).rstrip() for row in cells)
    return "\n".join([title, *lines])


def csv_text(rows: Iterable[Mapping[str, object]]) -> str:
    """Return rows as CSV; numbers with 17 digits, None as an empty field."""
    rows = list(rows)
    out = io.StringIO()
    writer = csv.writer(out, lineterminator="\n")
    if rows:
        writer.writerow(rows[0])
        writer.writerows([_exact(v) for v in row.values()] for row in rows)
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
    return f"{value:.17g}" if isinstance(value, float) else str(value)


def _coloured(word: str) -> str:
    from rich.markup import escape

    colour = COLOURS.get(word)
    return f"[{colour}]{word}[/]" if colour else escape(word)
