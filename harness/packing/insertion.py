"""Random loose insertion: discs at random places without overlap, the large ones first."""

from __future__ import annotations

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
    while (x := _inserted(radius, side, rng)) is None:
        side *= 1.05
    return x, side


def _inserted(radius: np.ndarray, side: float, rng) -> np.ndarray | None:
    x = np.empty((2, len(radius)))
    order = np.argsort(-radius, kind="stable")
    for k, disc in enumerate(order):
        place = _free_place(radius[disc], x[:, order[:k]], radius[order[:k]], side, rng)
        if place is None:
            return None
        x[:, disc] = place
    return x


def _free_place(radius: float, others: np.ndarray, their_radius: np.ndarray, side: float, rng) -> np.ndarray | None:
    """Try places in batches until one overlaps nobody; at this density one in a few tens is free."""
    for _ in range(TRIES):
        places = radius + rng.random((32, 2)) * (side - 2.0 * radius)
        gap2 = (places[:, :1] - others[0]) ** 2 + (places[:, 1:] - others[1]) ** 2
        free = (gap2 > (radius + their_radius) ** 2).all(axis=1)
        if free.any():
            return places[int(free.argmax())]
    return None
