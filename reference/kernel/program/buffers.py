"""Arrays whose rows begin on a cache line: NumPy writes them up to twice as fast as others."""

from __future__ import annotations

import math

import numpy as np

LINE = 64
"""Bytes."""


def empty(*shape: int, dtype: type = float) -> np.ndarray:
    """Return an uninitialised array; behind each of its rows there may be a gap up to the next line."""
    *rows, length = shape
    size = np.dtype(dtype).itemsize
    pitch = -(-length * size // LINE) * LINE
    memory = np.empty(math.prod(rows) * pitch + LINE, np.uint8)
    start = -memory.__array_interface__["data"][0] % LINE
    lines = memory[start : start + math.prod(rows) * pitch].view(dtype)
    return lines.reshape(*rows, pitch // size)[..., :length]


def filled(value: float, *shape: int, dtype: type = float) -> np.ndarray:
    """Return such an array full of `value`."""
    array = empty(*shape, dtype=dtype)
    array.fill(value)
    return array


def lined_up(values: np.ndarray) -> np.ndarray:
    """Return a copy that is such an array."""
    array = empty(*values.shape, dtype=values.dtype)
    array[...] = values
    return array


class Workspace:
    """Buffers by name, shape and type for up to `size` contacts: one block of contacts after the other uses them."""

    def __init__(self, size: int):
        self.size = size
        self._made: dict[tuple, np.ndarray] = {}

    def rows(self, name: str, *shape: int, dtype: type = float) -> np.ndarray:
        """Return the buffer of that name in a shape that ends with a number of contacts."""
        *rows, length = shape
        return self._buffer(name, *rows, self.size, dtype=dtype)[..., :length]

    def ends(self, name: str, length: int, dtype: type = float) -> np.ndarray:
        """Return a buffer of shape (2, length) without a gap: `take` and `add.at` go through both rows at once."""
        return self._buffer(name, 2 * self.size, dtype=dtype)[: 2 * length].reshape(2, length)

    def _buffer(self, name: str, *shape: int, dtype: type) -> np.ndarray:
        key = name, shape, dtype
        if key not in self._made:
            self._made[key] = empty(*shape, dtype=dtype)
        return self._made[key]
