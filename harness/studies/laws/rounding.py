"""Places whose rounding does not change an overlap.

A place in a turned frame is rounded by half a unit in its last digit, which is 1e-13 of an overlap and more. Among the
neighbouring floating-point numbers there are places at nearly the same spot whose distance is the wanted one to a
quarter of that, and less: what is then left of the dependence on the frame is mostly the code's own arithmetic.
"""

from __future__ import annotations

from itertools import product

import numpy as np

REACH = 2
"""Largest shift of a coordinate, in units of its last digit: a millionth of a millionth of a radius."""


def distance(x: np.ndarray, y: np.ndarray) -> np.ndarray:
    """Return |x - y|, (S,), of places (S, 3), in extended precision where the machine has it."""
    apart = x.astype(np.longdouble) - y
    return np.sqrt((apart * apart).sum(axis=-1))


def settled(x: np.ndarray, normal: np.ndarray, excess: np.ndarray) -> np.ndarray:
    """Return x (S, 3), shifted by a few last digits along `normal` (S, 3) so that `excess` (S,) of distance is gone.

    Of equally good places the nearest is taken: one without an excess stays where it is.
    """
    digit = np.where(normal != 0.0, np.spacing(np.abs(x)), 0.0)
    shifts = sorted(product(range(-REACH, REACH + 1), repeat=3), key=lambda shift: sum(map(abs, shift)))
    gain = np.einsum("ca,sa->sc", np.array(shifts, float), normal * digit)
    best = np.argmin(np.abs(excess.astype(float)[:, None] + gain), axis=1)
    return x + np.array(shifts)[best] * digit
