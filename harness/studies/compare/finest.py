"""The finest differences of a free scene that mean something: what is smaller is rounding.

Places are doubles, so they resolve dx = 2 eps max |x| (eps = 2^-52; twice, as overlaps are differences of places).
A contact of frequency omega_0 turns that into velocities of dv = omega_0 dx, and at the smallest radius a into
spins of dw = dv/a. A sphere at rest on a floor shows them: measured 4.9e-15 m/s where dv is 1.4e-14 m/s.
"""

from __future__ import annotations

import math
import sys
from dataclasses import dataclass

import numpy as np

from harness.scene.model import Free
from harness.scene.system import System

PLACES = 2.0 * sys.float_info.epsilon
"""Relative resolution of the difference of two places."""


@dataclass(frozen=True, kw_only=True)
class Finest:
    """A quantity's finest difference and its unit."""

    value: float
    unit: str


def finest_differences(scene: Free, system: System) -> dict[str, Finest]:
    """Return them by quantity: displacement, velocity, spin."""
    p = system.particles
    place = PLACES * float(np.abs(p.x).max())
    frequency = math.pi * scene.numerics.dt_fraction / system.dt  # dt is that fraction of half a period
    speed = frequency * place
    return {
        "displacement": Finest(value=place, unit="m"), "velocity": Finest(value=speed, unit="m/s"),
        "spin": Finest(value=speed / float(p.radius.min()), unit="rad/s"),
    }
