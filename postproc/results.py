"""What the post-processor returns: values with units, or the reason why there is none."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from postproc.snapshot import MissingColumn


def headed(name: str, unit: str) -> str:
    """Return the head of a column: its name with the unit, a pure number ("1") without.

    >>> headed("stress_xx", "N/m"), headed("ratio", "1")
    ('stress_xx (N/m)', 'ratio')
    """
    return name if unit == "1" else f"{name} ({unit})"


@dataclass(frozen=True, kw_only=True)
class Value:
    """A quantity in K cells: values (K, ...), unit ("1": a pure number), and names of components.

    components: () for a scalar, else one suffix a component in the order of the flattened array,
    such as ("xx", "xy", "yx", "yy"). undefined: where and why values are NaN; "" when none is.
    errors: one standard error of each value, for means over time. doubt: which of them not to trust, and why.
    """

    values: np.ndarray
    unit: str
    components: tuple[str, ...] = ()
    undefined: str = ""
    errors: np.ndarray | None = None
    doubt: str = ""

    def columns(self, name: str) -> dict[str, np.ndarray]:
        """Return the scalar columns (K,) of this quantity: "name (unit)", or "name_xx (unit)", ...; then errors."""
        columns = self._columns(name, "", self.values)
        return columns if self.errors is None else columns | self._columns(name, " error", self.errors)

    def _columns(self, name: str, what: str, values: np.ndarray) -> dict[str, np.ndarray]:
        if not self.components:
            return {headed(f"{name}{what}", self.unit): values}
        flat = values.reshape(len(values), -1)
        return {headed(f"{name}_{part}{what}", self.unit): flat[:, k] for k, part in enumerate(self.components)}


@dataclass(frozen=True, kw_only=True)
class Unavailable:
    """A quantity that this state cannot give; never zero, never a crash."""

    reason: str


Result = Value | Unavailable


@dataclass(frozen=True, kw_only=True)
class Period:
    """Frames that a mean over time is of: times of the first and the last, s, and their number."""

    first: float
    last: float
    frames: int


@dataclass(frozen=True, kw_only=True)
class Averages:
    """All quantities of one state.

    cells: the cells as they were asked for, labels: one name each (K). how: particles
    count in them: "weights", or "kernel" and "width (m)". frame: "cartesian" or "polar", whose
    components the quantities in cells have. coordinates: where the cells are, values (K,). in_cells: quantities per
    cell, values (K, ...). of_state: quantities of the whole box, values (1, ...), Cartesian. empty: number of cells
    without particles, where every density is 0. per_thickness: a 2D state of thickness 1, whose stresses are in N/m.
    period: of means over time (`time` is then that of the last frame, `empty` the most in any); None for one state.
    """

    time: float
    dimension: int
    per_thickness: bool
    particles: int
    cells: str
    how: Mapping[str, str | float]
    frame: str
    labels: tuple[str, ...]
    empty: int
    coordinates: Mapping[str, Value]
    in_cells: Mapping[str, Result]
    of_state: Mapping[str, Result]
    period: Period | None = None

    def __getitem__(self, name: str) -> np.ndarray:
        """Return the values of a quantity; MissingColumn with the reason if it is unavailable."""
        result = {**self.coordinates, **self.in_cells, **self.of_state}[name]
        if isinstance(result, Unavailable):
            raise MissingColumn(f"{name}: {result.reason}")
        return result.values


    @property
    def gives_something(self) -> bool:
        """Whether one quantity at least has values."""
        return any(isinstance(r, Value) for r in (*self.in_cells.values(), *self.of_state.values()))


def columns_of(results: Mapping[str, Result]) -> dict[str, np.ndarray]:
    """Return all scalar columns of the available quantities, by name with unit."""
    available = {name: r for name, r in results.items() if isinstance(r, Value)}
    return {c: v for name, value in available.items() for c, v in value.columns(name).items()}


def undefined_in(results: Mapping[str, Result]) -> dict[str, str]:
    """Return where and why values are NaN, of every quantity that has some."""
    return {name: r.undefined for name, r in results.items() if isinstance(r, Value) and r.undefined}


def doubts_of(results: Mapping[str, Result]) -> dict[str, str]:
    """Return which errors are not to be trusted and why, of every quantity that has such."""
    return {name: r.doubt for name, r in results.items() if isinstance(r, Value) and r.doubt}


def reasons_of(results: Mapping[str, Result]) -> dict[str, str]:
    """Return the reason of every unavailable quantity."""
    return {name: r.reason for name, r in results.items() if isinstance(r, Unavailable)}
