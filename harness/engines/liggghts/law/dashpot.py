"""Dashpots that LIGGGHTS wants as a restitution or as a multiple of another dashpot.

The hysteretic laws take e and make of it, for every pair, gamma = sqrt(4 m* k_1/(1 + (pi/ln e)^2)); `tan_luding`
takes gamma_t as a multiple of that. So a constant gamma needs a table of e by pairs of bodies, and a tangential or
rolling dashpot without a normal one needs some e: the largest below 1, whose gamma is lost in rounding.
"""

from __future__ import annotations

import math

from harness.engines.liggghts.law.kinds import Kind, reduced

LEAST_RESTITUTION = 0.05
"""LIGGGHTS refuses e up to this one."""

FAINT = 1.0 - 2.0**-53
"""The largest restitution below 1."""


def restitution(gamma: float, mass: float, stiffness: float) -> float:
    """Return the e that makes LIGGGHTS compute gamma (kg/s); 0 for gamma >= sqrt(4 m k), which no e makes.

    >>> restitution(0.0, 1.0, 100.0)
    1.0
    """
    square = 4.0 * mass * stiffness - gamma * gamma
    return math.exp(-math.pi * gamma / math.sqrt(square)) if square > 0.0 else 0.0


def damping(e: float, mass: float, stiffness: float) -> float:
    """Return the gamma (kg/s) that LIGGGHTS makes of e; 0 for e = 1."""
    return math.sqrt(4.0 * mass * stiffness / (1.0 + (math.pi / math.log(e)) ** 2)) if e < 1.0 else 0.0


def pair_restitution(gamma: float, a: Kind, b: Kind, stiffness: float, *, carries: bool) -> float:
    """Return e of a pair, 1 of two walls; `carries` says that other dashpots are multiples of this one."""
    if a.mass == b.mass == math.inf:
        return 1.0
    if gamma == 0.0:
        return FAINT if carries else 1.0
    return restitution(gamma, reduced(a.mass, b.mass), stiffness)


def rolling_ratio(gamma: float, stiffness: float, a: Kind, b: Kind, *, discs: bool) -> float:
    """Return the eta that makes LIGGGHTS' rolling dashpot 2 eta sqrt(I k_r a*^2) gamma_r a*^2 (gamma in kg/s).

    I = 1.5 (discs) or 1.4 times p q/(p + q), p and q the m R^2 of the bodies; that of a wall is infinite.
    """
    inertia = (1.5 if discs else 1.4) * reduced(a.mass * a.radius**2, b.mass * b.radius**2)
    return gamma * reduced(a.radius, b.radius) / (2.0 * math.sqrt(inertia * stiffness))
