"""The page of a reproduced result: the talk beside ours, pictures, discussion, convergence; also as CSV and JSON."""

from __future__ import annotations

import shlex
from collections import Counter
from dataclasses import asdict, replace
from pathlib import Path
from typing import TYPE_CHECKING

from harness import __version__
from harness.errors import InputError
from harness.report.cost import COST_NOTE, cost_rows, host_rows, version_rows
from harness.report.failures import entries
from harness.report.files import refuse_folders
from harness.report.matrix import matrices
from harness.report.page import Entry, Figure, Section, render_page, words
from harness.report.reproduce_figures import draw
from harness.report.reproduce_tables import (
    chart_csv,
    compact_rates,
    compact_rows,
    rate_rows,
    run_rows,
    study_rows,
    value_rows,
)
from harness.report.tables import Answer, csv_text

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from harness.studies.reproduce.protocol import Ask, Picture, Result, Row, Study

PAGE, DATA, ROWS, RATES = "report.html", "report.json", "rows.csv", "rates.csv"
SCREEN, SMALL, SMALLEST = 130, 90, 60
"""Pixels an inch on the page, of charts that are kept, and of states of discs that are kept."""

VALUE_NOTE = (
    "Ours: mean over packings and its standard error. Known: seen in the talk, recalled from the papers (never decides "
    "a verdict), or exact. A talk's number is that of one packing: it agrees when it lies in the prediction interval "
    "of ours, or within the declared tolerance, error bar included. Deviations are results and are not tuned away."
)
RATE_NOTE = (
    "The study's own convergence: the same quantity at several settings, the coarsest first. Number: what tends to 0 "
    "in the limit. The error of a change is taken packing by packing where the same packings were used."
)
DISCUSSION, CONVERGENCE = "What it says", "Convergence"
CHECK_NOTE = "The codes among each other, and properties that each run must have."


def study_list(studies: Sequence[Study]) -> Answer:
    """Return what there is, for `--list`."""
    rows = study_rows(studies)
    shown = [{k: r[k] for k in ("name", "size", "packings", "computes", "engines")} for r in rows]
    return Answer(tables={"Studies": shown}, data={"studies": rows}, prose=True)


def reproduce_answer(study: Study, ask: Ask, result: Result) -> Answer:
    """Return the tables for people and everything for programs."""
    tables = {
        f"{study.title}: {study.source}": compact_rows(_held(result)),
        "Numbers that the talk does not print": compact_rows(_free(result)),
        CONVERGENCE: compact_rates(result.rates),
    }
    return Answer(tables={k: v for k, v in tables.items() if v}, data=reproduce_data(study, ask, result))


def reproduce_data(study: Study, ask: Ask, result: Result) -> dict:
    """Return all tables with all digits."""
    from msgspec import to_builtins

    return {
        "study": study.name, "title": study.title, "claim": study.claim, "source": study.source, "size": ask.size,
        "computes": study.sizes[ask.size].says, "packings": study.packings(ask), "command": command(study, ask),
        "grainproof": __version__, "exit_status": result.exit_status, "rows": value_rows(result.rows),
        "rates": rate_rows(result.rates), "rate_words": result.rate_words, "words": list(result.words),
        "unsupported": dict(result.unsupported), "checks": [asdict(c) for c in result.checks],
        "tables": {name: list(rows) for name, rows in result.tables.items()}, "runs": run_rows(result.runs),
        "versions": version_rows(result.runs), "hosts": host_rows(result.runs),
        "outcomes": [to_builtins(r.outcome) for r in result.runs],
    }


def page_folder(study: Study, ask: Ask) -> Path:
    """Return where page and tables of a study and size go; runs and packings of all studies stand beside."""
    return ask.out / f"{study.name}_{ask.size}"


def check_report_place(study: Study, ask: Ask) -> None:
    """Raise InputError when the page's folder cannot be one, or a folder stands where a file goes: before any run."""
    folder = page_folder(study, ask)
    refuse_folders(folder, (PAGE, DATA, ROWS, RATES))
    if folder.exists() and not folder.is_dir():
        raise InputError(
            file=folder, expected="a folder or nothing", got="a file", fix="move it away or name another --out",
        )


def write_reproduce(study: Study, ask: Ask, result: Result) -> Path:
    """Write report.html, report.json, CSV tables and a PNG a picture; return the page."""
    from harness.report.figures import png_bytes, png_uri
    from harness.runs.atomic import write_bytes_atomic, write_json_atomic, write_text_atomic

    folder = page_folder(study, ask)
    folder.mkdir(parents=True, exist_ok=True)
    write_tables(folder, result)
    shown = []
    for picture in result.pictures:
        figure = draw(picture)
        write_bytes_atomic(folder / f"{picture.name}.png", png_bytes(figure, dpi=SCREEN))
        shown.append(Figure(uri=png_uri(figure, dpi=SCREEN), caption=picture.caption, panel=_is_chart(picture)))
    write_json_atomic(folder / DATA, reproduce_data(study, ask, result))
    page = render_page(
        title=study.title, sections=_sections(study, ask, result, tuple(shown)),
        lead=f"The talk: {study.claim} ({study.source}.) Here: {study.sizes[ask.size].says}; packings: "
        f"{study.packings(ask)}. {summary(result)}.",
    )
    write_text_atomic(folder / PAGE, page)
    return folder / PAGE


def write_tables(folder: Path, result: Result, *, digits: int = 17) -> None:
    """Write rows, convergence and the numbers of every chart as CSV, those of charts with so many digits."""
    from harness.runs.atomic import write_text_atomic

    write_text_atomic(folder / ROWS, csv_text(value_rows(result.rows)))
    write_text_atomic(folder / RATES, csv_text(rate_rows(result.rates)))
    for picture in result.pictures:
        if _is_chart(picture):
            write_text_atomic(folder / f"{picture.name}.csv", chart_csv(picture, digits=digits))


def summary(result: Result) -> str:
    """Return one line: how the rows and checks came out."""
    exact = [r for r in result.rows if r.talk is not None and r.talk.kind == "analytical"]
    others = [r for r in result.rows if r not in exact]
    rows, closed, checks = (Counter(x.verdict for x in found) for found in (others, exact, result.checks))
    parts = [f"against the talk: {_counts(rows)}"]
    parts += [f"against closed forms: {_counts(closed)}"] if exact else []
    parts += [f"checks: {_counts(checks)}"] if checks else []
    parts += [f"{len(result.broken)} runs failed"] if result.broken else []
    parts += [f"without {', '.join(result.unsupported)}"] if result.unsupported else []
    return "; ".join(parts)


def command(study: Study, ask: Ask, *, here: bool = False) -> str:
    """Return the command that makes this result again; with the places of this machine only if it is `here`."""
    from harness.engines.registry import word_of

    found = ["grainproof", "reproduce", study.name, "--size", ask.size]
    found += ["--engines", ",".join(word_of(e).split("@")[0] for e in ask.engines)]
    found += ["--packings", str(study.packings(ask))] if _takes_packings(study, ask) else []
    if ask.measurements:
        found += ["--measurements", str(ask.measurements) if here else ask.measurements.name]
    return shlex.join([*found, *(["--out", str(ask.out)] if here else [])])


def _takes_packings(study: Study, ask: Ask) -> bool:
    try:
        study.check(replace(ask, packings=study.packings(ask), measurements=None))
    except InputError:
        return False
    return True


def _counts(counts: Counter) -> str:
    return ", ".join(f"{n} {words(verdict)}" for verdict, n in counts.items()) or "nothing"


def _sections(study: Study, ask: Ask, result: Result, figures: tuple[Figure, ...]) -> list[Section]:
    held, free = _held(result), _free(result)
    failed = (*entries(result.checks, result.runs), *_unsupported(result.unsupported))
    found = [
        Section(heading=DISCUSSION, note="\n\n".join(result.words)),
        Section(heading="The talk and ours", note=VALUE_NOTE, rows=compact_rows(held)),
        Section(heading="Pictures", figures=figures),
        Section(heading="Numbers that the talk does not print", rows=compact_rows(free)),
        Section(
            heading=CONVERGENCE, note=f"{result.rate_words} {RATE_NOTE if result.rates else ''}",
            rows=compact_rates(result.rates) or None,
        ),
        *(Section(heading=name, rows=list(rows)) for name, rows in result.tables.items()),
        Section(heading="Checks", note=CHECK_NOTE, matrices=matrices(result.checks, (r.engine for r in result.runs))),
        Section(heading="All rows", rows=value_rows(result.rows)),
        Section(heading="All checks", rows=[asdict(c) for c in result.checks]),
        Section(heading="What failed, and what cannot be computed", entries=failed),
        Section(heading="Time and cost", note=COST_NOTE, rows=cost_rows(result.runs)),
        Section(heading="Versions", rows=version_rows(result.runs)),
        Section(heading="Machines", rows=host_rows(result.runs)),
        Section(heading="Runs", rows=run_rows(result.runs)),
        Section(heading="Reproduce", text=command(study, ask, here=True)),
    ]
    return [s for s in found if _says_something(s)]


def _says_something(section: Section) -> bool:
    """Whether there is more than a note; the discussion and the convergence are notes first of all."""
    if section.heading in (DISCUSSION, CONVERGENCE):
        return bool(section.note.strip())
    return bool(section.rows or section.matrices or section.entries or section.figures or section.text)


def _unsupported(found: Mapping[str, str]) -> tuple[Entry, ...]:
    return tuple(Entry(word="unsupported", title=engine, why=why) for engine, why in found.items())


def _held(result: Result) -> list[Row]:
    """Rows that are held against a value."""
    return [r for r in result.rows if r.talk is not None]


def _free(result: Result) -> list[Row]:
    """Rows for which the talk prints none."""
    return [r for r in result.rows if r.talk is None]


def _is_chart(picture: Picture) -> bool:
    from harness.studies.reproduce.protocol import Chart

    return isinstance(picture, Chart)
