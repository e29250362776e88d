"""The files of an accuracy report: a page, its picture as PNG and SVG, tables as CSV, everything as JSON."""

from __future__ import annotations

import base64
import io
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from harness.errors import InputError
from harness.report.page import Figure, Section, render_page
from harness.report.tables import csv_text

PAGE, DATA, PICTURES = "accuracy.html", "accuracy.json", ("accuracy.png", "accuracy.svg")


@dataclass(frozen=True, kw_only=True, eq=False)
class Written:
    """What goes into the files. figure: of matplotlib, and its caption; sections: of the page, given the picture."""

    title: str
    lead: str
    caption: str
    figure: object
    tables: Mapping[str, Sequence[Mapping]]
    data: Mapping
    sections: Callable[[Figure], list[Section]]


def write_files(out: Path, written: Written) -> Path:
    """Write accuracy.html, .json, .png, .svg and a CSV a table, each whole or not at all; return the page."""
    from harness.report.figures import png_bytes
    from harness.runs.atomic import write_bytes_atomic, write_json_atomic, write_text_atomic

    out.mkdir(parents=True, exist_ok=True)
    picture = png_bytes(written.figure, dpi=110)
    for name, rows in written.tables.items():
        write_text_atomic(out / f"{name}.csv", csv_text(rows))
    write_bytes_atomic(out / PICTURES[0], picture)
    write_bytes_atomic(out / PICTURES[1], _svg(written.figure))
    write_json_atomic(out / DATA, written.data)
    shown = Figure(uri=f"data:image/png;base64,{base64.b64encode(picture).decode()}", caption=written.caption)
    page = render_page(title=written.title, lead=written.lead, sections=written.sections(shown))
    write_text_atomic(out / PAGE, page)
    return out / PAGE


def check_places(out: Path, tables: Sequence[str]) -> None:
    """Raise InputError when a folder stands where a file of the report goes: before anything is run."""
    for place in (out / name for name in (PAGE, DATA, *PICTURES, *(f"{name}.csv" for name in tables))):
        if place.is_dir():
            raise InputError(
                file=place, expected="a file or nothing, as the report goes there", got="a folder",
                fix="move it away or name another --out",
            )


def _svg(figure) -> bytes:
    from matplotlib import rc_context

    buffer = io.BytesIO()
    with rc_context({"svg.hashsalt": "grainproof"}):
        figure.savefig(buffer, format="svg", metadata={"Date": None})
    return buffer.getvalue()
