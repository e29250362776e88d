"""Averages over the frames of a run, in the style of MDAnalysis: run, then read results; time averages with errors.

>>> from postproc.analysis import averaging_class                         # doctest: +SKIP
>>> Averaging = averaging_class()                                         # doctest: +SKIP
>>> rings = Averaging("trajectory.h5", cells="rings:60").run(start=20)    # doctest: +SKIP
>>> rings.results.stress.shape                                            # doctest: +SKIP
(41, 60, 2, 2)
>>> rings.time_average("stress").error[:, 0, 1]                           # doctest: +SKIP

MDAnalysis takes 0.7 s to import, so its class is made when it is asked for. Its `run` gives start, stop, step, frames
and verbose (a progress bar). For the same without MDAnalysis, call `postproc.average.average` on each frame.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from functools import cache, cached_property
from pathlib import Path

import numpy as np

from postproc.average import average
from postproc.results import Averages, Result, Unavailable, Value
from postproc.snapshot import MissingColumn, Snapshot
from postproc.trajectory import Trajectory, read_frame, trajectory_times
from postproc.uncertainty import Estimate, estimate

EVEN = 1e-6
"""Part of the mean step of time by which the steps between frames may differ and count as even."""


@dataclass(frozen=True, kw_only=True)
class Timestep:
    """One frame as MDAnalysis' loop sees it: its number, its time in s, and the state."""

    frame: int
    time: float
    snapshot: Snapshot


class Frames(Sequence):
    """Frames of a run, read one by one when they are asked for; what MDAnalysis calls a trajectory reader."""

    transformations = ()

    def __init__(self, times: np.ndarray, read: Callable[[int], Snapshot], numbers: np.ndarray | None = None):
        self.times, self._read = times, read
        self._numbers = np.arange(len(times)) if numbers is None else numbers

    @classmethod
    def of(cls, source: Trajectory | Path | str) -> Frames:
        """Frames of a trajectory in memory or of a ``trajectory.h5``. Raises ReadError."""
        if isinstance(source, Trajectory):
            times = np.array([snapshot.time for snapshot in source.frames])
            return cls(times, source.frames.__getitem__)
        path = Path(source)
        return cls(trajectory_times(path), lambda number: read_frame(path, number))

    def __len__(self) -> int:
        return len(self._numbers)

    def __getitem__(self, which) -> Timestep | Frames:
        if isinstance(which, (int, np.integer)):
            number = int(self._numbers[which])
            return Timestep(frame=number, time=float(self.times[number]), snapshot=self._read(number))
        return Frames(self.times, self._read, self._numbers[which])

    def __iter__(self) -> Iterator[Timestep]:
        return (self[k] for k in range(len(self)))

    def check_slice_indices(self, start: int | None, stop: int | None, step: int | None) -> tuple[int, int, int]:
        """Return start, stop and step as numbers, as Python's own slices mean them."""
        return slice(start, stop, step).indices(len(self))


@cache
def averaging_class() -> type:
    """Return the class `Averaging`, a subclass of MDAnalysis.analysis.base.AnalysisBase."""
    from MDAnalysis.analysis.base import AnalysisBase

    class Averaging(AnalysisBase):
        """Averages of every frame of a run, and their time averages.

        Parameters
        ----------
        source: Trajectory, or path of a ``trajectory.h5`` (frames are then read one by one).
        cells, fields, ...: settings of `postproc.average.average`. The reference that strains are measured from is
            the first frame of the run, unless one is given.
        verbose: show MDAnalysis' progress bar.

        After `run` `results` holds an array (frames, K, ...) for every available quantity, by name, and `frames` and
        `times` (s) say which frames they are. Quantities that some frame cannot give are in `unavailable`, with the
        reason; `units`, `components`, `coordinates` and `labels` are those of all frames.
        Raises WrongSetting, ReadError, and ValueError when the cells change their number from frame to frame.
        """

        def __init__(self, source: Trajectory | Path | str, *, verbose: bool = False, **settings):
            frames = Frames.of(source)
            super().__init__(frames, verbose=verbose)
            self._settings = settings
            if "reference" not in settings and len(frames):
                self._settings = settings | {"reference": frames[0].snapshot}

        def _prepare(self) -> None:
            self._collected: list[Averages] = []

        def _single_frame(self) -> None:
            self._collected.append(average(self._ts.snapshot, **self._settings))

        def _conclude(self) -> None:
            series = Series(tuple(self._collected))
            self.series = series
            self.results.update(series.values)
            self.unavailable, self.units = series.unavailable, series.units
            self.components, self.coordinates, self.labels = series.components, series.coordinates, series.labels

        def time_average(self, name: str) -> Estimate:
            """Mean over the frames of the run with its error: each (K, ...). See `postproc.uncertainty`.

            Raises MissingColumn with the reason when the quantity is unavailable, ValueError when the frames are not
            evenly spaced in time, which the autocorrelation needs.
            """
            return self.series.time_average(name)

    return Averaging


class Series:
    """Averages of frames as arrays over time."""

    def __init__(self, frames: tuple[Averages, ...]):
        self.frames = frames
        counts = {len(a.labels) for a in frames}
        if len(counts) > 1:
            raise ValueError(f"cells: expected as many in every frame, got {min(counts)} to {max(counts)}")

    @cached_property
    def _columns(self) -> dict[str, list[Result]]:
        if not self.frames:
            return {}
        every = [{**a.in_cells, **a.of_state} for a in self.frames]
        return {name: [frame[name] for frame in every] for name in every[0]}

    @cached_property
    def values(self) -> dict[str, np.ndarray]:
        """Quantities that every frame has, (frames, K, ...)."""
        return {
            name: np.array([result.values for result in results])
            for name, results in self._columns.items() if name not in self.unavailable
        }

    @cached_property
    def unavailable(self) -> dict[str, str]:
        """Why a quantity is missing, by name."""
        missing = {
            name: [r.reason for r in results if isinstance(r, Unavailable)]
            for name, results in self._columns.items()
        }
        return {name: self._told(found) for name, found in missing.items() if found}

    def _told(self, found: list[str]) -> str:
        some = f" (in {len(found)} of {len(self.frames)} frames)" if len(found) < len(self.frames) else ""
        return found[0] + some

    @cached_property
    def units(self) -> dict[str, str]:
        """Unit of every quantity that has values."""
        return {name: self._first(name).unit for name in self.values}

    @cached_property
    def components(self) -> dict[str, tuple[str, ...]]:
        """Names of the components of every quantity that has values, () for scalars."""
        return {name: self._first(name).components for name in self.values}

    @property
    def labels(self) -> tuple[str, ...]:
        """Names of the cells, in the first frame."""
        return self.frames[0].labels if self.frames else ()

    @property
    def coordinates(self) -> dict[str, np.ndarray]:
        """Places of the cells in every frame, (frames, K), m."""
        if not self.frames:
            return {}
        names = self.frames[0].coordinates
        return {name: np.array([a.coordinates[name].values for a in self.frames]) for name in names}

    @property
    def times(self) -> np.ndarray:
        """Of the frames, s."""
        return np.array([a.time for a in self.frames])

    def time_average(self, name: str) -> Estimate:
        """Mean and error of a quantity over the frames. Raises MissingColumn, ValueError (uneven frames)."""
        if name in self.unavailable:
            raise MissingColumn(f"{name}: {self.unavailable[name]}")
        steps = np.diff(self.times)
        if steps.size and not np.ptp(steps) <= EVEN * np.abs(steps).mean():
            got = f"{steps.min():g} to {steps.max():g} s"
            raise ValueError(f"frames: expected even steps of time for an autocorrelation, got {got}")
        return estimate(self.values[name])

    def _first(self, name: str) -> Value:
        return self._columns[name][0]


