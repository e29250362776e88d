"""Which particles touch each other, or a wall, before anything has moved."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import chain

import numpy as np

from harness.scene.system import Particles, System

ROUNDING = 8 * np.finfo(float).eps
"""Of the largest coordinate: bodies placed to touch just so overlap by less."""


@dataclass(frozen=True, kw_only=True)
class Overlaps:
    """One entry a contact, sorted: row numbers first < second, or second = -index of a wall.

    size > 0 and smaller, the smaller radius of the two (at a wall the particle's), in m.
    """

    first: np.ndarray
    second: np.ndarray
    size: np.ndarray
    smaller: np.ndarray


def initial_overlaps(system: System) -> Overlaps:
    """Return the overlaps R_i + R_j - r, nearest images across periodic axes, and R_i - height of walls."""
    x, radius = system.particles.x, system.particles.radius
    found = [_particle_pairs(system.particles, system.periodic)]
    for wall in system.walls:
        rows = np.arange(len(radius))
        found.append((rows, np.full_like(rows, -wall.index), radius - (x - wall.point) @ np.array(wall.normal)))
    first, second, size = (np.concatenate(columns) for columns in zip(*found, strict=True))
    order = np.lexsort((second, first))
    order = order[size[order] > ROUNDING * float(np.abs(x).max() + radius.max())]
    first, second = first[order], second[order]
    partner = np.where(second < 0, radius[first], radius[np.maximum(second, 0)])
    return Overlaps(first=first, second=second, size=size[order], smaller=np.minimum(radius[first], partner))


def _particle_pairs(particles: Particles, periodic) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return rows i < j and R_i + R_j - r of all pairs that may touch.

    The larger one of a pair (the first of equals) looks for the other within its diameter, so that one
    boulder among sand does not make every grain look that far.
    """
    from scipy.spatial import cKDTree

    x, radius = particles.x, particles.radius
    near = cKDTree(x, boxsize=periodic).query_ball_point(x, 2.0 * radius)
    i = np.repeat(np.arange(len(x)), [len(n) for n in near])
    j = np.fromiter(chain.from_iterable(near), dtype=int, count=len(i))
    mine = (radius[j] < radius[i]) | ((radius[j] == radius[i]) & (j > i))
    i, j = np.minimum(i, j)[mine], np.maximum(i, j)[mine]
    return i, j, radius[i] + radius[j] - np.linalg.norm(_nearest_image(x[j] - x[i], periodic), axis=1)


def _nearest_image(apart: np.ndarray, periodic) -> np.ndarray:
    if periodic is None:
        return apart
    lengths = np.array(periodic)
    return apart - lengths * np.round(np.divide(apart, lengths, out=np.zeros_like(apart), where=lengths > 0))
