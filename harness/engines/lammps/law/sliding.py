"""Sliding laws. Every function takes the scene's sliding and normal law and mu, and returns LAMMPS' words."""

from __future__ import annotations

import math

from harness.engines.lammps.law.normal import damping_ratio
from harness.engines.lammps.law.row import Row
from harness.engines.text import number
from harness.scene.contact import (
    HertzNormal,
    MindlinSliding,
    NormalLaw,
    SlidingLaw,
    SpringSliding,
    ViscousSliding,
)

SMOOTH = "linear_nohistory 0 0"
"""No tangential force: pair granular insists on a tangential model, this one has no history."""


def spring(law: SpringSliding, normal: NormalLaw, friction: float) -> str:
    """k_t u + gamma_t v_t, cut together at mu |f_n|."""
    ratio = damping_ratio(normal, law.shear_damping)
    return f"linear_history {number(law.shear_stiffness)} {number(ratio)} {number(friction)}"


def mindlin(_law: MindlinSliding, normal: HertzNormal, friction: float) -> str:
    """k_t = 8 G* sqrt(R* delta), which NULL takes from the normal law's material.

    c_n = sqrt(10/3) beta sqrt(S_n m*) is to become sqrt(10/3) beta sqrt(k_t m*), so x_t^2 is
    k_t/S_n = 8 G*/(2 E*) = 2 (1 - nu)/(2 - nu), whatever the overlap.
    """
    nu = normal.poisson_ratio
    return f"mindlin NULL {number(math.sqrt(2.0 * (1.0 - nu) / (2.0 - nu)))} {number(friction)}"


def viscous(law: ViscousSliding, normal: NormalLaw, friction: float) -> str:
    """min(gamma_t |v_t|, mu |f_n|) against v_t."""
    return f"linear_nohistory {number(damping_ratio(normal, law.shear_damping))} {number(friction)}"


def constant_damping(law: SlidingLaw | None) -> float:
    """Return the gamma_t that has to be a multiple of the normal damping, 0 where none is asked for."""
    return getattr(law, "shear_damping", 0.0)


_LIMIT = "Coulomb's limit mu |f_n|, f_n with damping; lever arm R - overlap/2"
SLIDING: dict[type, Row] = {
    SpringSliding: Row(
        level="equivalent", words=spring,
        note="linear_history: the spring is turned with the normal and keeps its length, cut so that spring "
        f"and dashpot together obey {_LIMIT}",
    ),
    MindlinSliding: Row(
        level="equivalent", words=mindlin,
        note="mindlin NULL with x_t = sqrt(k_t/S_n): the spring is turned with the normal and keeps its length, cut "
        f"so that spring and dashpot together obey {_LIMIT}",
    ),
    ViscousSliding: Row(level="equivalent", words=viscous, note=f"linear_nohistory: {_LIMIT}"),
}
