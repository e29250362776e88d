"""Matrices of coarse graining: what each particle, place or segment contributes at each point.

Rows are points, columns what is spread; all of them sparse.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import cached_property
from itertools import chain

import numpy as np

from postproc.averaging.coarse.images import images, wrapped
from postproc.averaging.coarse.kernels.kernel import Kernel
from postproc.averaging.words import WrongSetting
from postproc.snapshot import Snapshot

BLOCK = 1 << 17
"""Pairs of a point and what reaches it that are worked on at once: their arrays stay in the cache."""

MOST_PAIRS = 50_000_000
"""Beyond this a matrix (12 bytes a pair, four times that while it is made) would take several gigabytes."""

SHORT = 1e-4
"""Part of the kernel's reach below which a segment is taken at two Gauss points: exact to 1e-12 there, where the
difference of two primitives has fewer digits."""

GAUSS_POINTS = (0.5 - np.sqrt(1.0 / 12.0), 0.5 + np.sqrt(1.0 / 12.0))
"""Of a segment from 0 to 1, with equal weights."""


@dataclass(frozen=True, kw_only=True)
class Spread:
    """A kernel at K points of a state.

    at: (K, dim) the points, m. In a periodic box all images within reach count.
    """

    kernel: Kernel
    at: np.ndarray
    snapshot: Snapshot

    @cached_property
    def _points(self) -> np.ndarray:
        return wrapped(self.at, self.snapshot)

    @cached_property
    def _tree(self):
        from scipy.spatial import cKDTree

        return cKDTree(self._points)

    def places(self, x: np.ndarray):
        """phi(r - x), 1/m^dim, (K, n), of places x (n, dim)."""
        return self._matrix(x, np.zeros_like(x), lambda d, rows: self.kernel.value(_length(d)))  # noqa: ARG005

    def slopes(self, x: np.ndarray) -> list:
        """d phi(r - x)/d r_b, 1/m^(dim+1): one matrix (K, n) an axis b. MissingColumn if the kernel has none."""
        def along(axis: int) -> Callable[[np.ndarray, np.ndarray], np.ndarray]:
            return lambda d, rows: self.kernel.slope(_length(d)) * d[:, axis]  # noqa: ARG005

        return [self._matrix(x, np.zeros_like(x), along(axis)) for axis in range(x.shape[1])]

    def segments(self, x: np.ndarray, l: np.ndarray):  # noqa: E741
        """psi = int_0^1 phi(r - x - s l) ds, 1/m^dim, (K, n), of segments from x (n, dim) to x + l; exact.

        l . grad psi = phi(r - x) - phi(r - x - l), which makes the balance of momentum exact.
        Source: Goldhirsch, Granular Matter 12, 239 (2010), equation of the contact stress.
        """
        size = _length(l)
        short = size < SHORT * self.kernel.reach
        direction = np.where(short[:, None], 0.0, l / np.where(short, 1.0, size)[:, None])
        step = np.where(short, 0.0, 1.0) / np.where(short, 1.0, size)

        def line(d: np.ndarray, rows: np.ndarray) -> np.ndarray:
            u = direction[rows]
            along = _dot(d, u)
            across = _length(d - along[:, None] * u)
            return step[rows] * self.kernel.line(-along, size[rows] - along, across)

        whole = self._matrix(x, l, line)
        if not short.any():
            return whole
        points = sum(self.places(x + g * l) for g in GAUSS_POINTS)
        return whole + points.multiply(0.5 * short).tocsr()

    def _matrix(self, x: np.ndarray, l: np.ndarray, value: Callable[[np.ndarray, np.ndarray], np.ndarray]):  # noqa: E741
        """Return value(d, rows) for all pairs in reach, d (m, dim) from x of row `rows` (or its image) to the point."""
        from scipy.sparse import csr_array

        reach, ends = self.kernel.reach, np.stack([x, x + l])
        bounds = np.stack([self._points.min(axis=0), self._points.max(axis=0)], axis=1)
        image, shift = images(ends.min(axis=0) - reach, ends.max(axis=0) + reach, bounds, self.snapshot)
        place = x[image] + shift
        parts: list[tuple[np.ndarray, ...]] = [(np.empty(0), *np.empty((2, 0), dtype=np.int32))]
        for point, row in self._in_reach(place + l[image] / 2.0, reach + _length(l[image]) / 2.0):
            weight = value(self._points[point] - place[row], image[row])
            there = weight != 0.0
            parts.append((weight[there], point[there].astype(np.int32), image[row[there]].astype(np.int32)))
        weight, point, column = (np.concatenate(part) for part in zip(*parts, strict=True))
        return csr_array((weight, (point, column)), shape=(len(self.at), len(x)))

    def _in_reach(self, middle: np.ndarray, radius: np.ndarray) -> Iterator[tuple[np.ndarray, np.ndarray]]:
        """Give pairs (point, row of `middle`) with the point inside the radius about the middle, block by block."""
        count = self._tree.query_ball_point(middle, radius, return_length=True) if len(middle) else np.empty(0, int)
        done = np.cumsum(count)
        if len(done) and done[-1] > MOST_PAIRS:
            raise WrongSetting(
                f"cells points: expected at most {MOST_PAIRS} pairs of a point and what reaches it, got {done[-1]}; "
                "take fewer points or a smaller width"
            )
        for rows in np.split(np.arange(len(middle)), np.flatnonzero(np.diff(done // BLOCK)) + 1):
            found = self._tree.query_ball_point(middle[rows], radius[rows], return_sorted=False)
            point = np.fromiter(chain.from_iterable(found), dtype=np.intp, count=int(count[rows].sum()))
            yield point, np.repeat(rows, count[rows])


def _dot(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    return np.einsum("na,na->n", a, b)


def _length(d: np.ndarray) -> np.ndarray:
    return np.sqrt(_dot(d, d))
