"""A step as data: operations in the order in which they run.

An operation is a NumPy ufunc (or `take`, `add.at`, `fill`) bound to arrays that exist already, so running the
program allocates nothing and decides nothing. What an effect needs is added when the program is composed; an
effect that is off adds no operation, which the tests can count.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import partial

import numpy as np

_OUT_BY_NAME = {np.maximum, np.minimum}
"""Where NumPy warns of an `out` without name."""


class Program:
    """Operations in order; `names` says what each is for, as "effect: operation"."""

    def __init__(self):
        self.names: list[str] = []
        self._operations: list[Callable[[], object]] = []
        self._effect = ""

    def __len__(self) -> int:
        return len(self._operations)

    def effect(self, name: str) -> None:
        """Name the effect that the operations to come belong to."""
        self._effect = name

    def __call__(self, ufunc: np.ufunc, *inputs, out: np.ndarray) -> None:
        """Add out = ufunc(*inputs). Numbers become 0-d arrays, and `out` an argument without name: both are faster."""
        arrays = [np.asarray(a) for a in inputs]
        bound = partial(ufunc, *arrays, out=out) if ufunc in _OUT_BY_NAME else partial(ufunc, *arrays, out)
        self._add(ufunc.__name__, bound)

    def take(self, array: np.ndarray, index: np.ndarray, out: np.ndarray) -> None:
        """Add out = array[index]; "clip" because it writes into `out` without a copy."""
        self._add("take", partial(array.take, index, None, out, "clip"))

    def scatter(self, add: np.ufunc, array: np.ndarray, index: np.ndarray, values: np.ndarray) -> None:
        """Add array[index] += values (or -= with np.subtract), one after the other: always the same bits."""
        self._add(f"{add.__name__}.at", partial(add.at, array, index, values))

    def fill(self, array: np.ndarray, value: float) -> None:
        """Add array[:] = value."""
        self._add("fill", partial(array.fill, value))

    def copy(self, source: np.ndarray, out: np.ndarray) -> None:
        """Add out[:] = source."""
        self._add("copy", partial(out.__setitem__, ..., source))

    def call(self, name: str, function: Callable[[], object]) -> None:
        """Add a Python function: for the few scalars of walls."""
        self._add(name, function)

    def run(self, times: int = 1) -> None:
        """Run all operations in order, `times` times."""
        operations = self._operations
        for _ in range(times):
            for operation in operations:
                operation()

    def _add(self, name: str, operation: Callable[[], object]) -> None:
        self.names.append(f"{self._effect}: {name}")
        self._operations.append(operation)
