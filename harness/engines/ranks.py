"""How a system is cut into bricks for several MPI processes; LAMMPS and LIGGGHTS cut alike."""

from __future__ import annotations

import itertools
import math

import numpy as np

from harness.engines.glued import glued
from harness.scene.system import System

Grid = tuple[int, int, int]
"""Processes along x, y, z."""


def grid(system: System, ranks: int) -> Grid:
    """Return the grid of bricks with the least surface, the particles' extents cut evenly; in 2D z is not cut.

    >>> from types import SimpleNamespace as S
    >>> x = np.array([[0.0, 0.0], [4.0, 1.0]])
    >>> grid(S(particles=S(x=x, radius=np.ones(2)), dimension=2, rings=()), 3)
    (3, 1, 1)
    """
    p = system.particles
    extents = np.ptp(p.x, axis=0) + 2.0 * float(p.radius.max())
    sides = np.append(extents, [1.0] * (3 - system.dimension))
    return min(_grids(ranks, system.dimension), key=lambda cut: _surface(sides, cut))


def processor_lines(system: System, ranks: int) -> list[str]:
    """Return the line that asks for the grid; nothing for one process."""
    return [f"processors {' '.join(map(str, grid(system, ranks)))}"] if ranks > 1 else []


def cuts(system: System, axis: int, count: int) -> np.ndarray:
    """Return count - 1 coordinates along an axis, in m, that share the particles out evenly."""
    x = np.concatenate([system.particles.x[:, axis], *([glued(system).x[:, axis]] if system.rings else [])])
    return np.quantile(x, np.arange(1, count) / count)


def _grids(ranks: int, dimension: int) -> list[Grid]:
    divisors = [k for k in range(1, ranks + 1) if ranks % k == 0]
    flat = [1] if dimension == 2 else divisors
    return [cut for cut in itertools.product(divisors, divisors, flat) if math.prod(cut) == ranks]


def _surface(sides: np.ndarray, cut: Grid) -> float:
    """Return the area of all cuts, m^2."""
    volume = float(np.prod(sides))
    return sum((n - 1) * volume / side for n, side in zip(cut, sides, strict=True))
