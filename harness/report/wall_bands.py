"""Wall curves over replicates as numbers: the bands that the page draws, one row an engine and place."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

from postproc.results import headed

if TYPE_CHECKING:
    from harness.report.bands import Band
    from harness.studies.compare.study import Comparison

TABLE = "wall_bands"
"""Name of the table, and of its CSV file."""

WHERE = (
    "The numbers of the bands are in {}.csv: mean, standard error and number of replicates of every engine and "
    "quantity, place by place."
)


def has_replicates(comparison: Comparison) -> bool:
    """Whether there is more than one start, so that curves are means."""
    return len(comparison.starts) > 1


def where_bands_are(comparison: Comparison, table: str = TABLE) -> str:
    """Say in which file the numbers of the bands are; "" without replicates, where there are no bands."""
    return WHERE.format(table) if has_replicates(comparison) else ""


def band_rows(bands: Mapping[str, Mapping[str, Band]], units: Mapping[str, str], place: str) -> list[dict]:
    """Return one row an engine and place: replicates, then mean and standard error of every quantity.

    bands: by quantity and engine, all of an engine at the same places, whose column is headed `place`. units: by
    quantity. A single curve has no standard error (None).
    """
    engines = dict.fromkeys(e for of in bands.values() for e in of)
    return [row for e in engines for row in _rows(e, {q: of[e] for q, of in bands.items()}, units, place)]


def _rows(engine: str, bands: Mapping[str, Band], units: Mapping[str, str], place: str) -> Sequence[dict]:
    first = next(iter(bands.values()))
    rows = [{"engine": engine, place: float(p), "replicates": first.count} for p in first.place]
    for quantity, band in bands.items():
        mean, error = (headed(f"{quantity}, {of}", units[quantity]) for of in ("mean", "standard error"))
        for k, row in enumerate(rows):
            row[mean] = float(band.mean[k])
            row[error] = None if band.error is None else float(band.error[k])
    return rows
