"""Volume fraction."""

from __future__ import annotations

import numpy as np

from postproc.averaging.cells import Cells
from postproc.geometry import particle_volumes


def volume_fraction(cells: Cells) -> np.ndarray:
    """nu = (1/V) sum_p w_V^p V^p, shape (K,), dimensionless: Q^p = 1 in the averaging formalism.

    2D: area fraction of the discs. Overlaps are not subtracted, as is usual for soft particles; the
    excess is of the order of overlap/diameter squared times the coordination number.
    Source: the talk, "Averaging Density" (its slide prints nu as v with a bar).
    """
    V_p = particle_volumes(cells.snapshot)
    return cells.density(V_p)
