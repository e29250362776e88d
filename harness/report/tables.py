"""Result tables: on the terminal and as CSV, from the same rows."""

from __future__ import annotations

import csv
import io
import shutil
import textwrap
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import zip_longest

Row = Mapping[str, object]

PAGE, NARROWEST = 120, 12
"""Characters: of a line where no terminal tells its width, and of a wrapped column at least."""

COLOURS = {
    "agrees": "green", "differs": "bold red", "inconclusive": "yellow", "not_checked": "magenta",
    "known_difference": "cyan", "completed": "green", "stable": "green", "refused": "cyan", "degraded": "yellow",
    "failed loudly": "yellow", "failed silently": "bold red",
}


@dataclass(frozen=True, kw_only=True)
class Answer:
    """What a command has to say: tables by title for people, data for programs (see `runs.atomic.json_text`).

    prose: cells hold sentences, which are read and not searched: they are wrapped off the terminal, too.
    """

    tables: Mapping[str, Sequence[Row]]
    data: object
    prose: bool = False


def print_table(rows: Sequence[Row], title: str, *, prose: bool = False) -> None:
    """Print rows (same keys in each) as a table; words of verdicts and outcomes are coloured.

    Off the terminal every row is one line, unless it is `prose`: then as wide as COLUMNS says, else PAGE.
    """
    from rich.console import Console
    from rich.markup import escape
    from rich.table import Table

    console = Console()
    if not console.is_terminal:
        print(plain_table(rows, title, width=shutil.get_terminal_size((PAGE, 1)).columns if prose else None))
        return
    table = Table(title=escape(title), title_justify="left", show_lines=False)
    for name in rows[0] if rows else ():
        table.add_column(name, overflow="fold")
    for row in rows:
        table.add_row(*(_coloured(text(v)) for v in row.values()))
    console.print(table)


def plain_table(rows: Sequence[Row], title: str, *, width: int | None = None) -> str:
    """Return rows (same keys in each) as aligned plain text, one line a row; with a `width` cells are wrapped into it.

    Columns narrower than their share keep their width, the others share what is left; none gets less than
    NARROWEST characters, however narrow the page.
    """
    if not rows:
        return f"{title}\n  nothing"
    cells = [list(rows[0]), *([text(v) for v in row.values()] for row in rows)]
    widths = [max(len(row[k]) for row in cells) for k in range(len(cells[0]))]
    if width is not None:
        widths = _shares(widths, width - 2 * len(widths))
    lines = (line for row in cells for line in _lines(row, widths))
    return "\n".join([title, *lines])


def _shares(wanted: Sequence[int], room: int) -> list[int]:
    """Divide `room` characters among columns: what is wanted, or an equal share of what the narrower ones leave."""
    widths = list(wanted)
    for left, k in zip(range(len(widths), 0, -1), sorted(range(len(widths)), key=wanted.__getitem__), strict=True):
        widths[k] = min(wanted[k], max(NARROWEST, room // left))
        room -= widths[k]
    return widths


def _lines(row: Sequence[str], widths: Sequence[int]) -> Iterator[str]:
    """Yield the lines of one row, words unbroken where they fit."""
    wrapped = (textwrap.wrap(c, w, break_on_hyphens=False) or [""] for c, w in zip(row, widths, strict=True))
    for cells in zip_longest(*wrapped, fillvalue=""):
        yield "  " + "  ".join(c.ljust(w) for c, w in zip(cells, widths, strict=True)).rstrip()


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
