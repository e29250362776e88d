"""Inertial number."""

from __future__ import annotations

import numpy as np

from postproc.averaging.cells import Cells, divide
from postproc.geometry import particle_volumes
from postproc.snapshot import MissingColumn


def inertial_number(rate: float | None, cells: Cells, pressure: np.ndarray) -> np.ndarray:
    """I, shape (K,): deformation rate times the time in which the pressure moves a grain by its size.

    3D: I = rate d sqrt(rho/p) with d the mean diameter and rho the particles' density, as defined by
        GDR MiDi, Eur. Phys. J. E 14, 341 (2004), DOI 10.1140/epje/i2003-10153-0.
    2D: I = rate sqrt(m/p) with m the mean mass and p the pressure per unit thickness, N/m: the same
        for discs up to sqrt(pi/4); da Cruz et al., Phys. Rev. E 72, 021309 (2005).
    rate: strain rate or shear rate, 1/s; its sign does not matter. pressure: (K,), as `stress` gives
    it. Quasi-static below about 1e-3. NaN where the pressure is not positive.
    """
    if rate is None:
        raise MissingColumn("no strain rate was given")
    snapshot, particles = cells.snapshot, cells.snapshot.particles
    p = np.where(pressure > 0, pressure, 0.0)
    if snapshot.dimension == 2:
        return abs(rate) * np.sqrt(divide(cells.mean(particles["mass"]), p * snapshot.thickness))
    d = cells.mean(2.0 * particles["radius"])
    rho = divide(cells.total(particles["mass"]), cells.total(particle_volumes(snapshot)))
    return abs(rate) * d * np.sqrt(divide(rho, p))
