"""Averages of many frames of a run, averaged over time, with errors from the autocorrelation.

The same numbers as `postproc.analysis.Averaging.time_average` gives, in the form of one state's averages, so that the
command writes both alike.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path

import numpy as np

from postproc.analysis import Frames, Series
from postproc.average import average
from postproc.averaging.words import WrongSetting
from postproc.results import Averages, Period, Result, Unavailable, Value
from postproc.uncertainty import FINE, REASONS, Estimate

FEWEST = 3
"""Frames without which there is no scatter worth the name."""


def average_over_time(path: Path, which: slice, **settings) -> Averages:
    """Average the frames `which` of a trajectory as `postproc.average.average` does each, then over time.

    Errors are one standard error of the time mean, see `postproc.uncertainty.estimate`. The reference that strains are
    measured from is the first frame of the run, unless `settings` name one. Raises WrongSetting for fewer than FEWEST
    frames and for frames at uneven times, ReadError for damaged files.
    """
    every = Frames.of(path)
    chosen = every[which]
    if len(chosen) < FEWEST:
        got = f"{len(chosen)} of {len(every)}"
        raise WrongSetting(f"frames: expected {FEWEST} or more, got {got}; widen the range START:STOP, from 0")
    settings.setdefault("reference", every[0].snapshot)
    states = tuple(average(frame.snapshot, **settings) for frame in chosen)
    series = Series(states)
    return replace(
        states[-1],
        period=Period(first=states[0].time, last=states[-1].time, frames=len(states)),
        empty=max(state.empty for state in states),
        coordinates={
            name: Value(values=places.mean(axis=0), unit="m") for name, places in series.coordinates.items()
        },
        in_cells=_means(series, states[-1].in_cells),
        of_state=_means(series, states[-1].of_state),
    )


def _means(series: Series, results: Mapping[str, Result]) -> dict[str, Result]:
    return {name: _mean(series, name) for name in results}


def _mean(series: Series, name: str) -> Result:
    if name in series.unavailable:
        return Unavailable(reason=series.unavailable[name])
    try:
        found = series.time_average(name)
    except ValueError as uneven:
        raise WrongSetting(str(uneven)) from None
    return Value(
        values=found.mean, errors=found.error, unit=series.units[name], components=series.components[name],
        undefined=_undefined(found), doubt=_doubt(found),
    )


def _undefined(found: Estimate) -> str:
    missing = int(np.isnan(found.mean).reshape(len(found.mean), -1).any(axis=1).sum())
    return f"in {missing} of {len(found.mean)} cells: without a value in any frame" if missing else ""


def _doubt(found: Estimate) -> str:
    """Say which errors are not to be trusted, and why."""
    words, counts = np.unique(found.doubt, return_counts=True)
    return "; ".join(
        f"{count} of {found.doubt.size} numbers: {REASONS[str(word)]}"
        for word, count in zip(words, counts, strict=True) if str(word) != FINE
    )
