"""How neighbours turn against each other: the sliding and the rolling part of eigen-rotations, 2D.

Second talk, "An-isotropy and rotations": mean rotation (slip) omega*, difference rotation (rolling) omega**.
Its transcript does not say how radii enter, nor which of two neighbours is the first; the choices below are ours.
"""

from __future__ import annotations

import numpy as np

from postproc.averaging.cells import Cells, divide
from postproc.macro.contact_ends import WALL, ContactEnds
from postproc.macro.springs import centre_distance
from postproc.snapshot import MissingColumn


def sliding_rotation(ends: ContactEnds, cells: Cells, spin: np.ndarray, rotation_rate: np.ndarray) -> np.ndarray:
    """omega* = <(l_1 omega_1 + l_2 omega_2)/(l_1 + l_2)> - W, (K,), rad/s: mean over contacts between particles.

    spin: (N,). rotation_rate: W (K,). Arms l = |l^pc|, so that (l_1 + l_2) omega* is the speed at which contacts
    slip because particles turn otherwise than their surroundings. NaN without such contacts.
    """
    _in_plane(cells)
    arm = ends.length
    turning = arm * spin[ends.particle]
    both = np.bincount(ends.contact, weights=turning)[ends.contact] if turning.size else turning
    return _mean_of_pairs(ends, cells, both / centre_distance(ends)) - rotation_rate


def rolling_rotation(ends: ContactEnds, cells: Cells, spin: np.ndarray) -> np.ndarray:
    """omega**_b = <n^pq_b (omega_p - omega_q)/2>, (K, 2), rad/s: mean over contacts between particles.

    n: from p to q, so that both ends of a contact say the same; in a smooth field -(L/2) <n_b n_c> d omega/d x_c
    with L the distance of centres. Layers that roll on each other in turns cancel. W drops out.
    """
    _in_plane(cells)
    difference = (spin[ends.particle] - spin[ends.partner]) / 2.0  # at a wall not used
    return _mean_of_pairs(ends, cells, difference[:, None] * ends.n)


def _mean_of_pairs(ends: ContactEnds, cells: Cells, q: np.ndarray) -> np.ndarray:
    pair = (ends.partner != WALL).astype(np.float64)
    weighted = q * (pair if q.ndim == 1 else pair[:, None])
    return divide(cells.contact_density(ends, weighted), cells.contact_density(ends, pair))


def _in_plane(cells: Cells) -> None:
    if cells.snapshot.dimension != 2:
        raise MissingColumn("sliding and rolling components need a 2D state")
