"""How far a state is from equilibrium."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from postproc.averaging.cells import Cells, divide
from postproc.macro.contact_ends import ContactEnds


def residual_force(ends: ContactEnds, cells: Cells, gravity: ArrayLike | None = None) -> np.ndarray:
    """|F^p| = |sum_c f^pc + m^p g|, shape (N,), N: what is left to accelerate each particle.

    Forces that a snapshot does not hold (a background drag) are not in it; gravity only if it is
    given, (dim,) or a row a particle (N, dim), m/s^2, in the components of the forces.
    """
    F = ends.sum_c(ends.f)
    if gravity is not None:
        F = F + cells.snapshot.particles["mass"][:, None] * np.asarray(gravity, dtype=np.float64)
    return np.linalg.norm(F, axis=1)


def unbalanced_force(ends: ContactEnds, cells: Cells, gravity: ArrayLike | None = None) -> np.ndarray:
    """max_p |F^p| / <|f^c|>, shape (K,): largest residual force over the state's mean contact force.

    The mean is over all contacts of the state, each counted once. NaN without contacts.
    """
    size = np.linalg.norm(ends.f, axis=1)
    mean = divide((ends.share * size).sum(), ends.share.sum())
    worst = cells.largest(residual_force(ends, cells, gravity))
    return divide(worst, np.broadcast_to(mean, worst.shape))
