"""Random loose insertion: discs at random places without overlap, the large ones first."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

LOOSE = 0.45
"""Area fraction of the first, loose state; random sequential addition gets there quickly."""

TRIES = 1000
"""Batches of places before a box counts as too small; in a box of many discs a few are enough."""


def insert_loose(radius: np.ndarray, rng: np.random.Generator) -> tuple[np.ndarray, float]:
    """Return centres (2, N) and the side of the square box, area fraction `LOOSE`.

    Random sequential addition (Feder, J. Theor. Biol. 87, 237 (1980)), in order of falling radius.
    A few discs can block each other for good, so a box that has no place left is begun anew, larger.
    """
    side = float(np.sqrt(np.pi * (radius**2).sum() / LOOSE))
    while (x := _inserted(radius, lambda a, side=side: _in_square(a, side, rng))) is None:
        side *= 1.05
    return x, side


def insert_in_annulus(radius: np.ndarray, inner: float, outer: float, rng: np.random.Generator) -> np.ndarray | None:
    """Return centres (2, N) about the origin of discs that lie between two circles, None where they find no place.

    Random sequential addition as above. Places are drawn in a square: no sine is taken, whose last bit could
    differ between machines.
    """
    return _inserted(radius, lambda a: _in_annulus(a, inner, outer, rng))


Places = Callable[[float], np.ndarray]
"""Draws a batch of places (B, 2) for a disc of this radius."""


def _in_square(radius: float, side: float, rng) -> np.ndarray:
    return radius + rng.random((32, 2)) * (side - 2.0 * radius)


def _in_annulus(radius: float, inner: float, outer: float, rng) -> np.ndarray:
    places = (2.0 * rng.random((64, 2)) - 1.0) * outer
    distance2 = (places * places).sum(axis=1)
    return places[(distance2 > (inner + radius) ** 2) & (distance2 < (outer - radius) ** 2)]


def _inserted(radius: np.ndarray, draw: Places) -> np.ndarray | None:
    x = np.empty((2, len(radius)))
    order = np.argsort(-radius, kind="stable")
    for k, disc in enumerate(order):
        place = _free_place(radius[disc], x[:, order[:k]], radius[order[:k]], draw)
        if place is None:
            return None
        x[:, disc] = place
    return x


def _free_place(radius: float, others: np.ndarray, their_radius: np.ndarray, draw: Places) -> np.ndarray | None:
    """Try places in batches until one overlaps nobody; at these densities one in a few tens is free."""
    for _ in range(TRIES):
        places = draw(radius)
        gap2 = (places[:, :1] - others[0]) ** 2 + (places[:, 1:] - others[1]) ** 2
        free = (gap2 > (radius + their_radius) ** 2).all(axis=1)
        if free.any():
            return places[int(free.argmax())]
    return None
