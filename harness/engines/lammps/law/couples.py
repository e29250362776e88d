"""Rolling and torsion resistance: couples of a spring, a dashpot and a slider, limited by mu |f_n|.

Every function takes the scene's law and the reduced radius a* and returns LAMMPS' words.
"""

from __future__ import annotations

import numpy as np

from harness.engines.facts import is_rough
from harness.engines.lammps.law.row import Row, missing
from harness.engines.text import numbers
from harness.scene.contact import ConstantRolling, SpringRolling, SpringTorsion
from harness.scene.system import System


def rolling_spring(law: SpringRolling, _reduced_radius: float) -> str:
    """Return `sds`: it measures a* (omega_i - omega_j) x n and acts by a* n x f_r, as the scene does."""
    return "sds " + numbers((law.rolling_stiffness, law.rolling_damping, law.rolling_friction))


def torsion_spring(law: SpringTorsion, reduced_radius: float) -> str:
    """Return `sds` about the normal: it takes an angle and gives a couple, so k_o a*^2, gamma_o a*^2, mu_o a*."""
    square = reduced_radius * reduced_radius
    return "sds " + numbers(
        (law.torsion_stiffness * square, law.torsion_damping * square, law.torsion_friction * reduced_radius)
    )


def pair_radius(radius: np.ndarray) -> float:
    """Return a_i a_j/(a_i + a_j) of the first two of N particles; that of a pair of its like for N = 1."""
    a, b = radius[0], radius[min(1, len(radius) - 1)]
    return float(a * b / (a + b))


def wall_radius(radius: np.ndarray) -> float:
    """Return the reduced radius at a plane, a_i of the first particle."""
    return float(radius[0])


def one_reduced_radius(system: System) -> bool:
    """Do all contacts that can be share one a* among pairs, and one at walls with friction?"""
    radius = system.particles.radius
    same = bool(np.all(radius == radius[0]))
    return same or (len(radius) == 2 and not any(is_rough(system, w) for w in system.walls))


ROLLING: dict[type, Row] = {
    SpringRolling: Row(
        level="equivalent", words=rolling_spring,
        note="rolling sds; the limit is mu_r |f_n|, f_n with damping; the spring is turned with the normal and keeps "
        "its length; newton off and no sorting, without which its sign is lost",
    ),
    ConstantRolling: missing("Illegal model type constant: rolling has none and sds"),
}
TORSION: dict[type, Row] = {
    SpringTorsion: Row(
        level="equivalent", words=torsion_spring,
        note="twisting sds with k_o a*^2, gamma_o a*^2, mu_o a*; the limit is mu_o |f_n|, f_n with damping",
    ),
}
