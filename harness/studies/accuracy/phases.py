"""Copies of a free scene, far apart in one system, each begun a little earlier: contacts begin at all phases of a step.

A copy that starts earlier by tau has its bodies at x - v tau; until they meet nothing acts on them, so that all copies
do the same, tau later. What differs between them after the last contact is the error of the step alone.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from itertools import combinations
from pathlib import Path

import numpy as np

from harness.errors import InputError
from harness.scene.system import System

MOST_BODIES = 20_000
"""Of all copies."""

SEED = 20260
"""Of the phases of a ladder; another one gives other phases."""


@dataclass(frozen=True, kw_only=True)
class Phased:
    """system: K copies of N bodies, copy after copy. delay: (K,), s."""

    system: System
    delay: np.ndarray

    @property
    def bodies(self) -> int:
        """N."""
        return len(self.system.particles) // len(self.delay)


def delays(count: int, longest: float, seed: int = SEED) -> np.ndarray:
    """Return (count,) times from 0 to `longest`, one drawn in each of as many equal parts: all phases of a step."""
    drawn = np.random.default_rng(seed).random(count)
    return (np.arange(count) + drawn) / count * longest


def with_phases(system: System, delay: np.ndarray, file: Path) -> Phased:
    """Return one copy a delay, side by side along an axis that no wall looks at.

    Raises InputError for scenes whose bodies do not fly freely at first, or have no room beside each other.
    """
    _require_flight(system, float(delay.max(initial=0.0)), file)
    p, axis = system.particles, _free_axis(system, file)
    count = len(delay)
    if count * len(p) > MOST_BODIES:
        raise InputError(
            file="--phases", expected=f"at most {MOST_BODIES} bodies in all copies", got=f"{count * len(p)}"
        )
    pitch = float(np.ptp(p.x[:, axis])) + 4.0 * float(p.radius.max()) + 2.0 * _reach(system, delay)
    x = p.x[None] - delay[:, None, None] * p.v[None]
    x[:, :, axis] += pitch * np.arange(count)[:, None]
    particles = replace(p.rows(np.tile(np.arange(len(p)), count)), x=x.reshape(-1, system.dimension))
    return Phased(system=system.with_(particles=particles), delay=delay)


def stepped(system: System, dt: float, duration: float) -> System:
    """Return the system in steps of at most dt, the number of them whole, looked at in the beginning and the end."""
    steps = max(1, int(np.ceil(duration / dt - 1e-9)))
    return system.with_(
        dt=duration / steps, steps=steps, sample_every=steps, frame_every=steps, contacts=False, rotations=False
    )


def fastest_pair(system: System) -> float:
    """Return the largest relative speed at the start, m/s; at least the largest speed itself."""
    v = system.particles.v
    between = max((float(np.linalg.norm(v[i] - v[j])) for i, j in combinations(range(len(v)), 2)), default=0.0)
    return max(between, float(np.linalg.norm(v, axis=1).max()))


def _reach(system: System, delay: np.ndarray) -> float:
    """Return how far one body can get, were all energy its own, m."""
    p = system.particles
    inertia = p.inertia_factor * p.mass * p.radius**2
    energy = 0.5 * (p.mass * (p.v**2).sum(axis=1)).sum() + 0.5 * (inertia * (p.spin**2).sum(axis=1)).sum()
    return float(np.sqrt(2.0 * energy / p.mass.min())) * (system.dt * system.steps + float(delay.max(initial=0.0)))


def _require_flight(system: System, longest: float, file: Path) -> None:
    acting = {"gravity": system.gravity, "background": system.background, "periodic": system.periodic}
    found = next((name for name, value in acting.items() if value is not None), None)
    if found or any(w.motion is not None for w in system.walls):
        raise InputError(
            file=file, place=found or "planes", got=f"{found or 'planes that move'}",
            expected="bodies on which nothing acts before they meet, so that contacts can begin at any phase of a step",
        )
    if _touches_before(system, longest):
        raise InputError(
            file=file, place="bodies", got="bodies that touch at the start, or did shortly before",
            expected=f"bodies that fly freely in the {longest:.3g} s before the start",
            fix="place them further apart, or name a ladder with smaller steps",
        )


def _touches_before(system: System, longest: float) -> bool:
    """Whether anybody touched anything between the start and `longest` before it."""
    p = system.particles
    i, j = (np.array(rows) for rows in zip(*combinations(range(len(p)), 2), strict=True)) if len(p) > 1 else ([], [])
    if len(p) > 1:
        x, v = p.x[i] - p.x[j], -(p.v[i] - p.v[j])
        square = (v**2).sum(axis=1)
        nearest = np.clip(-(x * v).sum(axis=1) / np.where(square > 0.0, square, 1.0), 0.0, longest)
        if (np.linalg.norm(x + nearest[:, None] * v, axis=1) <= p.radius[i] + p.radius[j]).any():
            return True
    places = (p.x, p.x - longest * p.v)
    return any(((x - w.point) @ np.array(w.normal) <= p.radius).any() for w in system.walls for x in places)


def _free_axis(system: System, file: Path) -> int:
    """Return the last axis along which no wall has a side, so that copies see the same walls."""
    free = [a for a in range(system.dimension) if all(abs(w.normal[a]) == 0.0 for w in system.walls)]
    if not free:
        raise InputError(
            file=file, place="planes", expected="an axis along which copies of the scene fit beside each other",
            got="planes across every axis",
        )
    return free[-1]
