"""A kick: one disc moved by 1e-15, so that a chaotic system takes another way with the same statistics.

The way a run takes after chaos depends on its last bits. A kick changes some, and nothing that could be called
physics: one particle, drawn at random, is moved in a direction drawn at random by `KICK` times the largest coordinate,
four to nine times what a double resolves there. The draw follows from the content of the system and from who is
kicked (an engine, a number of a replicate), so that the same kick is made again tomorrow, in the same run folder.
"""

from __future__ import annotations

import hashlib
from dataclasses import replace

import numpy as np

from harness.scene.system import System

KICK = 1e-15
"""Of the largest coordinate: above the rounding of a place (1.1e-16 of it), far below all tolerances."""


def kicked(system: System, *who: str | int) -> System:
    """Return the system with one particle moved; `who` names the kick, and another name is another kick."""
    rng = np.random.default_rng(kick_seed(system, *who))
    x = system.particles.x.copy()
    particle, direction = int(rng.integers(len(x))), rng.normal(size=x.shape[1])
    step = KICK * np.abs(x).max() * direction / np.linalg.norm(direction)
    moved = x[particle] + step
    if np.array_equal(moved, x[particle]):
        raise ValueError(f"a step of {np.abs(step).max():.2g} m is lost in a place of {np.abs(x).max():.2g} m")
    x[particle] = moved
    return system.with_(particles=replace(system.particles, x=x))


def kick_seed(system: System, *who: str | int) -> int:
    """Return a seed of 128 bits from the content of the system and the name of the kick."""
    name = "|".join([system.digest(), *map(str, who)])
    return int.from_bytes(hashlib.sha256(name.encode()).digest()[:16], "big")
