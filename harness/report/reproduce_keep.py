"""A result small enough to be committed: numbers, command, versions, day and pictures, and nothing of one machine."""

from __future__ import annotations

from datetime import UTC, datetime
from pathlib import Path
from typing import TYPE_CHECKING

from harness import __version__
from harness.places import require_place
from harness.report.reproduce import SMALL, SMALLEST, command, write_tables
from harness.report.reproduce_figures import draw
from harness.report.reproduce_tables import rate_rows, value_rows

if TYPE_CHECKING:
    from harness.studies.reproduce.protocol import Ask, Result, Study

RESULT = "result.json"
DIGITS = 5
"""Of the numbers of charts that are kept: more than anybody reads off."""


def check_keep_place(folder: Path | None) -> None:
    """Raise InputError, before any run, for a place that cannot be written."""
    if folder is not None:
        require_place("--keep", folder)


def keep(study: Study, ask: Ask, result: Result, place: Path) -> Path:
    """Write result.json, rows.csv, rates.csv, and each picture with its numbers, into ``place/<study>``; return it."""
    from harness.report.figures import png_bytes
    from harness.runs.atomic import write_bytes_atomic, write_json_atomic
    from harness.studies.reproduce.protocol import Chart

    folder = place / study.name
    folder.mkdir(parents=True, exist_ok=True)
    write_tables(folder, result, digits=DIGITS)
    for picture in result.pictures:
        dpi = SMALL if isinstance(picture, Chart) else SMALLEST
        write_bytes_atomic(folder / f"{picture.name}.png", png_bytes(draw(picture), dpi=dpi))
    write_json_atomic(folder / RESULT, kept_data(study, ask, result))
    return folder


def kept_data(study: Study, ask: Ask, result: Result) -> dict:
    """Return what is kept: the numbers, how they were made, when and by what."""
    made = [r.outcome for r in result.runs if r.outcome.status == "completed"]
    days = sorted({o.finished.date().isoformat() for o in made})
    return {
        "study": study.name, "title": study.title, "claim": study.claim, "source": study.source, "size": ask.size,
        "computes": study.sizes[ask.size].says, "packings": study.packings(ask), "command": command(study, ask),
        "written": datetime.now(UTC).date().isoformat(), "runs made": days[:1] + days[-1:] if len(days) > 1 else days,
        "versions": {"grainproof": __version__} | {o.engine: o.engine_version for o in made},
        "runs": len(made), "CPU hours of all runs": sum(o.cpu_seconds or 0.0 for o in made) / 3600.0,
        "processors": sorted({o.host.cpu_model for o in made}),
        "rows": value_rows(result.rows), "rates": rate_rows(result.rates), "rate_words": result.rate_words,
        "words": list(result.words), "unsupported": dict(result.unsupported),
        "checks": [{"quantity": c.quantity, "left": c.left, "right": c.right, "deviation": c.deviation,
                    "tolerance": c.tolerance, "verdict": c.verdict} for c in result.checks],
        "tables": {name: list(rows) for name, rows in result.tables.items()},
    }
