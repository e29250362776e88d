"""The contact laws in the words of `pair_coeff` and of the granular form of `fix wall/gran/region`.

LAMMPS (pair granular), for n from j to i, overlap delta, v_n rate of separation, v_t slip velocity:

    f_n = f_el(delta) - c_n v_n                        clipped at 0 with `limit_damping`
    f_t = -k_t u - x_t c_n v_t,  |f_t| <= mu |f_n|     u integrates v_t, is turned with n, cut by slip
    couples of rolling and twisting besides, limited by mu |f_n| too

Each law of the scene is one plain function that writes its words, and one row in the table of its
family (`NORMAL`, `SLIDING`, `ROLLING`, `TORSION`) that says how well they mean what the scene means.
"""

from harness.engines.lammps.law.compose import clone_stiffness, pair_law, springs_law, wall_law
from harness.engines.lammps.law.couples import ROLLING, TORSION, one_reduced_radius
from harness.engines.lammps.law.normal import NORMAL, constant_ratio, damping_and_ratio
from harness.engines.lammps.law.row import Row
from harness.engines.lammps.law.sliding import SLIDING, constant_damping

__all__ = [
    "NORMAL", "ROLLING", "SLIDING", "TORSION", "Row", "clone_stiffness", "constant_damping", "constant_ratio",
    "damping_and_ratio", "one_reduced_radius", "pair_law", "springs_law", "wall_law",
]
