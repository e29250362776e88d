"""The files of a report: a page, its picture as PNG and SVG, tables as CSV, everything as JSON."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from harness.errors import InputError
from harness.report.page import Figure, Section, render_page
from harness.report.tables import csv_text


@dataclass(frozen=True, kw_only=True)
class Names:
    """How a report's files are called: STEM.html, .json, .png, .svg, a CSV a table, and further ones.

    tables: all that can occur; before: what their files' names begin with.
    """

    stem: str
    tables: tuple[str, ...]
    before: str = ""
    further: tuple[str, ...] = ()

    @property
    def page(self) -> str:
        """The page."""
        return f"{self.stem}.html"

    @property
    def data(self) -> str:
        """Everything, as JSON."""
        return f"{self.stem}.json"

    @property
    def pictures(self) -> tuple[str, str]:
        """The page's picture as PNG and SVG."""
        return f"{self.stem}.png", f"{self.stem}.svg"

    def table(self, name: str) -> str:
        """The file of a table."""
        return f"{self.before}{name}.csv"

    def check(self, out: Path) -> None:
        """Raise InputError when a folder stands where a file of the report goes: before anything is run."""
        refuse_folders(out, (self.page, self.data, *self.pictures, *self.further, *map(self.table, self.tables)))


@dataclass(frozen=True, kw_only=True, eq=False)
class Written:
    """What goes into the files.

    figure: of matplotlib, None where there is nothing to draw; caption: its own; sections: of the page, given the
    picture (none or one).
    """

    title: str
    lead: str
    caption: str
    figure: object | None
    tables: Mapping[str, Sequence[Mapping]]
    data: Mapping
    sections: Callable[[tuple[Figure, ...]], list[Section]]


def write_files(out: Path, names: Names, written: Written) -> Path:
    """Write page, JSON, pictures and a CSV a table into `out`, each whole or not at all; return the page."""
    from harness.runs.atomic import write_json_atomic, write_text_atomic

    out.mkdir(parents=True, exist_ok=True)
    for name, rows in written.tables.items():
        write_text_atomic(out / names.table(name), csv_text(rows))
    write_json_atomic(out / names.data, written.data)
    shown = _write_pictures(out, names.pictures, written)
    page = render_page(title=written.title, lead=written.lead, sections=written.sections(shown))
    write_text_atomic(out / names.page, page)
    return out / names.page


def refuse_folders(out: Path, names: Iterable[str]) -> None:
    """Raise InputError when one of `names` in `out` is a folder."""
    for place in (out / name for name in names):
        if place.is_dir():
            raise InputError(
                file=place, expected="a file or nothing, as the report goes there", got="a folder",
                fix="move it away or name another --out",
            )


def _write_pictures(out: Path, names: tuple[str, str], written: Written) -> tuple[Figure, ...]:
    """Write PNG and SVG, or take away those of a former report, so that no page stands beside another's picture."""
    from harness.report.figures import data_uri, png_bytes, svg_bytes
    from harness.runs.atomic import write_bytes_atomic

    if written.figure is None:
        for name in names:
            (out / name).unlink(missing_ok=True)
        return ()
    png = png_bytes(written.figure, dpi=110)
    write_bytes_atomic(out / names[0], png)
    write_bytes_atomic(out / names[1], svg_bytes(written.figure))
    return (Figure(uri=data_uri(png), caption=written.caption),)
