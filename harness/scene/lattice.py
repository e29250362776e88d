"""Bodies that a rule places: on a lattice, with radii and velocities drawn from a seed."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from harness.scene.grains import inertia_factor, mass_of
from harness.scene.system import Particles

if TYPE_CHECKING:
    from harness.scene.model import Lattice

HEIGHT = math.sqrt(0.75)
"""Distance of the rows of a triangular lattice over its spacing."""


def lattice_particles(lattice: Lattice) -> Particles:
    """Return the bodies, the first axis running fastest; spins are zero.

    Places: corner + spacing (i, j[, k]); in a triangular lattice every other row is half a spacing further along x and
    rows are sqrt(3)/2 spacings apart. Radii are drawn first, from U(min, max), then, with `speed`, every component of
    velocity from N(0, speed), of which the mean over the mass is taken off: the lattice as a whole stays.
    """
    rng = np.random.default_rng(lattice.seed or 0)
    x = _places(lattice)
    radius = rng.uniform(lattice.radius.min, lattice.radius.max, len(x))
    mass = mass_of(lattice.mass, radius)
    v = np.zeros_like(x)
    if lattice.speed is not None:
        v = lattice.speed * rng.standard_normal(x.shape)
        v -= mass @ v / mass.sum()
    return Particles(
        x=x, radius=radius, mass=mass, inertia_factor=np.full(len(x), inertia_factor(lattice.inertia)), v=v,
        spin=np.zeros((len(x), 1 if x.shape[1] == 2 else 3)),
    )


def _places(lattice: Lattice) -> np.ndarray:
    """Return the centres, (N, dim), m."""
    numbers = np.meshgrid(*(np.arange(n, dtype=float) for n in lattice.counts), indexing="ij")
    steps = np.stack([n.ravel(order="F") for n in numbers], axis=1)
    if lattice.arrangement == "triangular":
        steps[:, 0] += 0.5 * (steps[:, 1] % 2)
        steps[:, 1] *= HEIGHT
    return np.array(lattice.corner) + lattice.spacing * steps
