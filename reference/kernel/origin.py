"""Far from the origin coordinates have few digits left for overlaps: the kernel then counts from the sample's middle.

A double resolves 2.2e-16 of a coordinate. A million diameters from the origin that is 2e-10 diameters, 1e-7 of a usual
overlap, lost anew in every step. Differences of the places that are given are exact (Sterbenz 1974: x - y is, if
y/2 <= x <= 2 y), so that nothing is lost but by writing places back.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from reference.kernel.model import Model, Ring, Wall

FAR = 1e3
"""Distance of the sample's middle from the origin over its half extent, radii included, beyond which it is moved."""


def near_origin(model: Model) -> Model:
    """Return a model whose places are told relative to its `origin`; as it is, if it lies near enough or is periodic.

    The origin is rounded to 26 binary digits, half of a double's, so that places that have as many behind them stay
    exact. Walls and rings move along.
    """
    low, high = model.x.min(axis=1), model.x.max(axis=1)
    middle, extent = (low + high) / 2, float((high - low).max() / 2 + model.radius.max())
    if model.periodic is not None or float(np.abs(middle).max()) <= FAR * extent:
        return model
    origin = _rounded(middle)
    walls = tuple(_wall(w, origin) for w in model.walls)
    rings = tuple(_ring(r, origin) for r in model.rings)
    return replace(model, x=model.x - origin[:, None], walls=walls, rings=rings, origin=tuple(origin.tolist()))


def placed(model: Model, places: np.ndarray) -> np.ndarray:
    """Return places (dim, n) as they are told outside."""
    return places if model.origin is None else places + np.array(model.origin)[:, None]


def _rounded(middle: np.ndarray) -> np.ndarray:
    part, power = np.frexp(middle)
    return np.ldexp(np.round(np.ldexp(part, 26)), power - 26)


def _wall(wall: Wall, origin: np.ndarray) -> Wall:
    return replace(wall, point=tuple((np.array(wall.point) - origin).tolist()))


def _ring(ring: Ring, origin: np.ndarray) -> Ring:
    return replace(ring, x=ring.x - origin[:, None], centre=tuple((np.array(ring.centre) - origin).tolist()))
