"""Radii of a random packing, drawn from what the scene declares."""

from __future__ import annotations

import numpy as np

from harness.scene.model import RandomParticles, SteppedRadius


def draw_radii(particles: RandomParticles, rng: np.random.Generator) -> np.ndarray:
    """Return the radii (N,), m."""
    radius, count = particles.radius, particles.count
    if isinstance(radius, SteppedRadius):
        step = (radius.max - radius.min) / radius.steps
        return radius.min + step * (rng.integers(radius.steps, size=count) + 0.5)
    return rng.uniform(radius.min, radius.max, count)


def radii_key(particles: RandomParticles) -> list[float] | None:
    """Return what decides them besides seed and number, for the name of a kept packing."""
    radius = particles.radius
    if radius is None:
        return None
    steps = [radius.steps] if isinstance(radius, SteppedRadius) else []
    return [radius.min, radius.max, *steps]
