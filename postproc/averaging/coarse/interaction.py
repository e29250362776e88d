"""What walls do to grains, as a field."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from postproc.averaging.coarse.points import Points
from postproc.geometry import positions
from postproc.macro.contact_ends import WALL

if TYPE_CHECKING:
    from postproc.macro.contact_ends import ContactEnds


def interaction_force_density(ends: ContactEnds, points: Points) -> np.ndarray:
    """t = sum_c f^c phi(r - c) over contacts with walls, (K, dim), N/m^3 (2D per unit thickness: N/m^2), Cartesian.

    f: force of the wall on the particle, c: contact point, where the particle's segment of the stress ends. It
    carries the sign with which dj/dt + div(rho V V + sigma^k) = -div sigma + t + rho g holds at every point
    (compression positive); what grains do to the wall is -t. It vanishes farther from walls than the kernel reaches.
    Source: Weinhart, Thornton, Luding, Bokhove, Granular Matter 14, 289 (2012).
    """
    at_wall = np.flatnonzero(ends.partner == WALL)
    x = positions(points.snapshot)[ends.particle[at_wall]] + ends.l[at_wall]
    return points.density_at(x, ends.f[at_wall])
