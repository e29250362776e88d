"""Averages as a table to read, as JSON, as CSV files."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import asdict
from pathlib import Path

import numpy as np

from postproc.results import (
    Averages,
    Result,
    Unavailable,
    Value,
    columns_of,
    doubts_of,
    headed,
    reasons_of,
    undefined_in,
)

FILES = ("average.json", "cells.csv", "state.csv")
"""What `write_files` writes."""


def json_text(averages: Averages) -> str:
    """Return one JSON object; NaN is null (with the reason under "undefined"), numbers have all their digits."""
    data = {
        "time": _number(averages.time),
        **({} if averages.period is None else {"period": asdict(averages.period)}),
        "dimension": averages.dimension,
        "per_unit_thickness": averages.per_thickness,
        "particles": averages.particles,
        "cells": averages.cells,
        **averages.how,
        "frame": averages.frame,
        "labels": averages.labels,
        "cells_without_particles": averages.empty,
        "coordinates": {name: _json(r) for name, r in averages.coordinates.items()},
        "in_cells": {name: _json(r) for name, r in averages.in_cells.items()},
        "of_state": {name: _json(r) for name, r in averages.of_state.items()},
    }
    return json.dumps(data, indent=1) + "\n"


def write_files(folder: Path, averages: Averages) -> None:
    """Write average.json (everything), cells.csv (a row a cell, with its place) and state.csv (one row) in `folder`.

    Columns of the CSV files are named with their unit in brackets. Unavailable quantities have no column there;
    the reasons are in average.json.
    """
    import pandas as pd

    folder.mkdir(parents=True, exist_ok=True)
    (folder / FILES[0]).write_text(json_text(averages), encoding="utf-8")
    cells = {"cell": averages.labels, **columns_of(averages.coordinates), **columns_of(averages.in_cells)}
    state = {"time (s)": [averages.time], **columns_of(averages.of_state)}
    for name, table in zip(FILES[1:], (cells, state), strict=True):
        pd.DataFrame(table).to_csv(folder / name, index=False, float_format="%.17g")


PER_THICKNESS = "per unit thickness, as none other than 1 was given: stresses are forces per length, N/m"


def table_text(averages: Averages) -> str:
    """Return a table to read: one value a line for one cell, mean, least and largest for several."""
    count = len(averages.labels)
    how = "".join(f", {name}: {value}" for name, value in averages.how.items())
    cells = f"cells: {averages.cells}{how}" + (f" ({count}; mean, least, largest)" if count > 1 else "")
    head = f"{averages.dimension}D, {averages.particles} particles, {_when(averages)}, {cells}"
    lines = [head, PER_THICKNESS] if averages.per_thickness else [head]
    if averages.empty:
        most = "" if averages.period is None else "at most "
        lines += [f"{most}{averages.empty} of {count} cells without particles: densities and sums are 0 there"]
    lines += ["", *_lines(averages.in_cells), "", "whole box", *_lines(averages.of_state)]
    everything = {**averages.in_cells, **averages.of_state}
    groups = {"nan": undefined_in, "errors not to be trusted": doubts_of, "unavailable": reasons_of}
    for title, reasons in ((title, of(everything)) for title, of in groups.items()):
        if reasons:
            lines += ["", title, *(f"  {name}: {reason}" for name, reason in reasons.items())]
    return "\n".join(lines) + "\n"


def _when(averages: Averages) -> str:
    if averages.period is not None:
        period = averages.period
        return f"mean of {period.frames} frames, t = {period.first:.9g} to {period.last:.9g} s"
    return "unknown time" if np.isnan(averages.time) else f"t = {averages.time:.9g} s"


def _lines(results: Mapping[str, Result]) -> list[str]:
    values = {name: r for name, r in results.items() if isinstance(r, Value)}
    return [line for name, value in values.items() for line in _quantity(name, value)] or ["  nothing"]


def _quantity(name: str, value: Value) -> list[str]:
    """One line a scalar or vector, one line a row of a tensor; for several cells a line a component."""
    if len(value.values) == 1:
        rows = np.atleast_2d(value.values[0])
        heads = [headed(name, value.unit), *[""] * (len(rows) - 1)]
        cells = ["".join(f"{number:<18.9g}" for number in row) for row in rows]
    else:
        columns = value.columns(name)
        heads, cells = list(columns), [_spread(numbers) for numbers in columns.values()]
    return [f"  {head:<34}{cell}".rstrip() for head, cell in zip(heads, cells, strict=True)]


def _spread(values: np.ndarray) -> str:
    known = values[~np.isnan(values)]
    numbers = (known.mean(), known.min(), known.max()) if known.size else (np.nan,)
    return "".join(f"{number:<16.6g}" for number in numbers)


def _json(result: Result) -> dict:
    if isinstance(result, Unavailable):
        return {"unavailable": result.reason}
    data = {"unit": result.unit, "components": result.components, "values": _nested(result.values.tolist())}
    if result.errors is not None:
        data |= {"errors": _nested(result.errors.tolist())} | ({"doubt": result.doubt} if result.doubt else {})
    return data | ({"undefined": result.undefined} if result.undefined else {})


def _nested(values):
    return [_nested(v) for v in values] if isinstance(values, list) else _number(values)


def _number(value: float) -> float | None:
    return float(value) if np.isfinite(value) else None
